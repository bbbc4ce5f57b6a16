//! The SD card under the whole firmware, and the battery pulled.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use floe::card;

use super::machine::{Machine, Setup};
use super::record::Record;
use crate::arm::Route;
use crate::shell::{output, root};
use crate::{Result, apt};

/// FAT32 needs 65 525 clusters of 512 bytes at least.
const IMAGE_BYTES: u64 = 64 << 20;
/// Where the partition begins, in sectors.
const START: u32 = 2048;
/// Samples after which the power fails: in the first second, in the middle of a
/// sector, at its end, late.
const CUTS: [u64; 6] = [5, 100, 201, 207, 208, 900];

/// Pulls the battery again and again on one card: each time the file system is
/// clean, everything but the last second is there, and nothing of the tests before
/// has changed.
///
/// # Errors
/// What was lost.
pub fn check_card(route: Route) -> Result<()> {
    let machine = Machine::prepare(Some(route))?;
    let image = root().join("target").join(format!("card-{}.img", std::process::id()));
    format(&image)?;
    let done = cuts(&machine, &image);
    let _ = fs::remove_file(&image);
    let _ = fs::remove_file(partition(&image));
    done
}

fn cuts(machine: &Machine, image: &Path) -> Result<()> {
    let mut lengths: Vec<u64> = Vec::new();
    for cut in CUTS {
        let setup = Setup { card: Some(image), cut_at: Some(cut), ..Setup::default() };
        machine.run(&Record::stick_slip(), setup)?;
        check_file_system(image)?;
        let file = File::open(image).map_err(|e| e.to_string())?;
        let (tests, found) = card::tests(file).map_err(|e| e.to_string())?;
        if found.damaged + found.lost > 0 {
            return Err(format!("cut at {cut}: {} damaged, {} lost", found.damaged, found.lost));
        }
        let now: Vec<u64> = tests.iter().map(|test| test.samples.len() as u64).collect();
        let length = now.get(lengths.len()).copied().unwrap_or(0);
        if !now.starts_with(&lengths) || length + 10 < cut {
            return Err(format!("cut at sample {cut}: tests of {lengths:?} became {now:?}"));
        }
        lengths = now;
        println!("card: power cut at sample {cut}: {length} on the card, file system clean");
    }
    Ok(())
}

/// An image with a partition table and an empty FAT32 file system.
fn format(image: &Path) -> Result<()> {
    let mkfs = tool("mkfs.fat")?;
    let failed = |e: std::io::Error| format!("{}: {e}", image.display());
    let mut file = File::create(image).map_err(failed)?;
    file.set_len(IMAGE_BYTES).map_err(failed)?;
    let sectors = (IMAGE_BYTES / 512) as u32 - START;
    let mut command = Command::new(mkfs);
    command.args(["-F", "32", "-s", "1", "--offset", &START.to_string()]).arg(image);
    command.arg((sectors / 2).to_string());
    output(&mut command).ok_or("mkfs.fat failed")?;
    // One partition of type 0x0C (FAT32 with LBA), and the mark at the end.
    let mut entry = [0_u8; 16];
    entry[4] = 0x0C;
    entry[8..12].copy_from_slice(&START.to_le_bytes());
    entry[12..16].copy_from_slice(&sectors.to_le_bytes());
    file.seek(SeekFrom::Start(446)).and_then(|_| file.write_all(&entry)).map_err(failed)?;
    file.seek(SeekFrom::Start(510)).and_then(|_| file.write_all(&[0x55, 0xAA])).map_err(failed)
}

fn check_file_system(image: &Path) -> Result<()> {
    let fsck = tool("fsck.fat")?;
    let bytes = fs::read(image).map_err(|e| e.to_string())?;
    let start = START as usize * 512;
    fs::write(partition(image), bytes.get(start..).unwrap_or_default())
        .map_err(|e| e.to_string())?;
    let checked = Command::new(fsck).arg("-n").arg(partition(image)).stdin(Stdio::null()).output();
    let checked = checked.map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&checked.stdout).trim().replace('\n', "; ");
    if checked.status.success() { Ok(()) } else { Err(format!("fsck.fat: {said}")) }
}

fn partition(image: &Path) -> PathBuf {
    image.with_extension("part")
}

/// A program of dosfstools, which is not in everybody's path.
fn tool(name: &str) -> Result<PathBuf> {
    let places = ["/usr/sbin", "/sbin", "/usr/bin"];
    let find = || places.iter().map(|p| Path::new(p).join(name)).find(|path| path.exists());
    if find().is_none() {
        apt::install(&["dosfstools"])?;
    }
    find().ok_or(format!("{name} is not to be had"))
}
