//! Tests of the whole firmware with an SD card, including power cuts.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

use floe::card;

use super::machine::{Machine, Run, Setup};
use super::record::Record;
use crate::arm::Route;
use crate::shell::{output, target};
use crate::{Result, apt};

/// Size of a card's image, bytes: FAT32 needs at least 65 525 clusters of 512 bytes.
const IMAGE_BYTES: u64 = 64 << 20;
/// Size of an image with room for the NUCLEO's log of 96 MiB in clusters of 4 KiB, bytes.
const LARGE_BYTES: u64 = 512 << 20;
/// Options of mkfs: FAT32 with clusters for an image of that size.
const LARGE: [&str; 4] = ["-F", "32", "-s", "8"];
/// First sector of the partition.
const START: u32 = 2048;
/// Samples after which the power fails: in the first second, in the middle of a sector, at its end,
/// late in the test.
const CUTS: [u64; 6] = [5, 100, 201, 207, 208, 900];
/// Largest number of cuts on one card, limited by the room of the emulated board's log.
const CUTS_OF_A_CARD: usize = 50;

/// Cuts the power repeatedly with one card. Each time the file system must be clean, everything
/// except the last second must be there, and earlier tests must be unchanged. `FLOE_POWER_CUTS=200`
/// makes 200 cuts, spread over a test.
///
/// # Errors
/// The loss.
pub fn check_card(route: Route) -> Result<()> {
    let machine = Machine::prepare(Some(route))?;
    let image = target().join(format!("card-{}.img", std::process::id()));
    let done = pull_battery(&machine, &image);
    let _ = fs::remove_file(&image);
    let _ = fs::remove_file(partition(&image));
    done
}

/// Samples after which the power fails.
fn cuts() -> Vec<u64> {
    let wanted = match floe_tests::number("FLOE_POWER_CUTS", 0.0) as u64 {
        0 => None,
        wanted => Some(wanted),
    };
    let samples = Record::stick_slip().codes.len() as u64;
    // Multiples of the golden ratio: spread over the test, and different for a long time.
    let anywhere = |n: u64| n.wrapping_mul(0x9E37_79B9_7F4A_7C15) % samples;
    wanted.map_or(CUTS.into(), |wanted: u64| (1..=wanted).map(anywhere).collect())
}

fn pull_battery(machine: &Machine, image: &Path) -> Result<()> {
    let cuts = cuts();
    let mut lengths: Vec<u64> = Vec::new();
    let mut worst = 0;
    for (number, &cut) in cuts.iter().enumerate() {
        if number % CUTS_OF_A_CARD == 0 {
            format(image)?;
            lengths.clear();
        }
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
        worst = worst.max(cut.saturating_sub(length));
    }
    let count = cuts.len();
    println!("card: {count} power cuts: at most {worst} samples lost, every file system clean");
    Ok(())
}

/// Formats an image with a partition table and an empty FAT32 file system.
fn format(image: &Path) -> Result<()> {
    make(image, IMAGE_BYTES)?;
    with_partition(image, ["-F", "32", "-s", "1"])
}

/// Default card of live runs: created once, then kept as the previous run left it.
pub fn of_live_runs() -> Result<PathBuf> {
    let image = target().join("live-card.img");
    if !image.exists() {
        // Created under another name until it is complete.
        let part = image.with_extension("part");
        make(&part, LARGE_BYTES)?;
        with_partition(&part, LARGE)?;
        fs::rename(&part, &image).map_err(|e| format!("{}: {e}", image.display()))?;
    }
    Ok(image)
}

/// Creates a file of zeros that takes no room on the disk.
fn make(image: &Path, bytes: u64) -> Result<()> {
    let made = File::create(image).and_then(|file| file.set_len(bytes));
    made.map_err(|e| format!("{}: {e}", image.display()))
}

/// Makes one partition with a file system.
fn with_partition(image: &Path, options: [&str; 4]) -> Result<()> {
    mkfs(image, options, START)?;
    partition_table(image)
}

/// Makes a file system from a sector to the end.
fn mkfs(image: &Path, options: [&str; 4], start: u32) -> Result<()> {
    let bytes = fs::metadata(image).map_err(|e| e.to_string())?.len();
    let sectors = (bytes / 512) as u32 - start;
    let mut command = Command::new(tool("mkfs.fat")?);
    command.args(options).args(["--offset", &start.to_string()]).arg(image);
    command.arg((sectors / 2).to_string());
    output(&mut command).map(drop).ok_or_else(|| "mkfs.fat failed".to_string())
}

/// Writes a table with one partition of type 0x0C (FAT32 with LBA), and the signature at the end.
fn partition_table(image: &Path) -> Result<()> {
    let bytes = fs::metadata(image).map_err(|e| e.to_string())?.len();
    let mut entry = [0_u8; 16];
    entry[4] = 0x0C;
    entry[8..12].copy_from_slice(&START.to_le_bytes());
    entry[12..16].copy_from_slice(&((bytes / 512) as u32 - START).to_le_bytes());
    put(image, 446, &entry)?;
    put(image, 510, &[0x55, 0xAA])
}

fn put(image: &Path, place: u64, bytes: &[u8]) -> Result<()> {
    let file = File::options().write(true).open(image);
    let done = file
        .and_then(|mut file| file.seek(SeekFrom::Start(place)).and_then(|_| file.write_all(bytes)));
    done.map_err(|e| format!("{}: {e}", image.display()))
}

/// Image of a card, deleted when dropped.
#[derive(Debug)]
pub struct Image(PathBuf);

impl Image {
    fn new(name: &str, bytes: u64) -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("card-{name}-{}-{number}.img", std::process::id());
        let image = Self(target().join(name));
        make(&image.0, bytes)?;
        Ok(image)
    }

    /// A FAT32 card with room for the board's whole log.
    pub fn large(name: &str) -> Result<Self> {
        let image = Self::new(name, LARGE_BYTES)?;
        with_partition(&image.0, LARGE)?;
        Ok(image)
    }

    /// A FAT32 card without a partition table, with room for the board's whole log.
    pub fn without_table(name: &str) -> Result<Self> {
        let image = Self::new(name, LARGE_BYTES)?;
        mkfs(&image.0, LARGE, 0)?;
        Ok(image)
    }

    /// A FAT12 card, the format of small cards as sold.
    pub fn fat12(name: &str) -> Result<Self> {
        let image = Self::new(name, 8 << 20)?;
        with_partition(&image.0, ["-F", "12", "-s", "8"])?;
        Ok(image)
    }

    /// An exFAT card, the format of large cards as sold; only the bytes that identify it.
    pub fn exfat(name: &str) -> Result<Self> {
        let image = Self::empty(name)?;
        partition_table(&image.0)?;
        let start = u64::from(START) * 512;
        put(&image.0, start, b"\xEB\x76\x90EXFAT   ")?;
        put(&image.0, start + 510, &[0x55, 0xAA])?;
        Ok(image)
    }

    /// A card of zeros.
    pub fn empty(name: &str) -> Result<Self> {
        Self::new(name, 8 << 20)
    }

    /// The image file.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The tests on the card.
    pub fn tests(&self) -> Result<Vec<card::Test>> {
        tests(&self.0)
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn tests(image: &Path) -> Result<Vec<card::Test>> {
    let file = File::open(image).map_err(|e| format!("{}: {e}", image.display()))?;
    card::tests(file).map(|(tests, _)| tests).map_err(|e| e.to_string())
}

/// The last test on the card, checked to contain every code that the converter delivered.
///
/// # Errors
/// The first difference.
pub fn codes_as_given(image: &Path, run: &Run) -> Result<card::Test> {
    let test = tests(image)?.pop().ok_or("the card has no test")?;
    let given: BTreeMap<u64, i32> = run.delivered.iter().copied().collect();
    for sample in &test.samples {
        let index = u64::from(sample.index.wrapping_sub(test.part.first_index));
        if sample.reading.ok().map(|code| code.0) != given.get(&index).copied() {
            return Err(format!("the card has {sample:?}, the converter gave another"));
        }
    }
    match test.missing() {
        0 => Ok(test),
        missing => Err(format!("{missing} samples are missing on the card")),
    }
}

/// Checks that the card has every code that the converter delivered in the test, and every line
/// except those for a display only. Returns a summary sentence.
///
/// # Errors
/// The first difference.
pub fn compare(image: &Path, run: &Run) -> Result<String> {
    let test = codes_as_given(image, run)?;
    let of_the_test = |line: &&str| line.starts_with(['E', 'C', 'R', 'Z']);
    let said: Vec<&str> = run.shown.lines().filter(of_the_test).collect();
    let kept: Vec<&str> = test.lines.lines().filter(of_the_test).collect();
    if said != kept {
        return Err(format!("{} lines said, {} on the card", said.len(), kept.len()));
    }
    Ok(format!("{} codes and {} lines as said", test.samples.len(), kept.len()))
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

/// Path of a program of dosfstools, which may be outside PATH; installed if it is missing.
pub fn tool(name: &str) -> Result<PathBuf> {
    let places = ["/usr/sbin", "/sbin", "/usr/bin"];
    let find = || places.iter().map(|p| Path::new(p).join(name)).find(|path| path.exists());
    if find().is_none() {
        apt::install(&["dosfstools"])?;
    }
    find().ok_or(format!("{name} is not to be had"))
}
