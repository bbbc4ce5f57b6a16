//! `cargo xtask image`: the files to copy onto the board's USB drive.

use std::fs;
use std::path::Path;

use object::{Object, ObjectSegment};

use crate::Result;
use crate::arm::Route;
use crate::shell::target;

/// Start address of the flash.
const FLASH: u64 = 0x0800_0000;
/// Data bytes per line of the .hex file.
const LINE: usize = 16;

/// Writes `target/floe-nucleo.bin` and `.hex`, byte for byte the program that the tests run, and
/// prints its contents.
///
/// # Errors
/// The firmware does not build, or a file cannot be written.
pub fn run(forced: Option<Route>) -> Result<()> {
    const FEATURES: &str = "nucleo-l476";
    let firmware = Route::find(forced)?.build_firmware("nucleo-l476", FEATURES)?;
    let bytes = flash(&firmware)?;
    for (name, content) in [("floe-nucleo.bin", bytes.clone()), ("floe-nucleo.hex", hex(&bytes))] {
        let file = target().join(name);
        fs::write(&file, content).map_err(|e| format!("{}: {e}", file.display()))?;
        println!("{}", file.display());
    }
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&bytes);
    let version = env!("CARGO_PKG_VERSION");
    println!("floe {version}, features {FEATURES}, without defmt");
    println!("{} bytes from 0x{FLASH:08x}, CRC-32 {sum:08x}", bytes.len());
    println!("copy one of them onto the drive that the board shows on USB (NODE_L476RG)");
    Ok(())
}

/// Contents of the flash for an image, from the start of the flash, with gaps as erased bytes.
///
/// # Errors
/// The file is not an image, or has data elsewhere.
pub fn flash(firmware: &Path) -> Result<Vec<u8>> {
    let elf = fs::read(firmware).map_err(|e| format!("{}: {e}", firmware.display()))?;
    let wrong = |what: String| format!("{}: {what}", firmware.display());
    let file = object::read::elf::ElfFile32::<object::Endianness>::parse(&*elf)
        .map_err(|e| wrong(e.to_string()))?;
    let mut bytes = Vec::new();
    for segment in file.segments() {
        let data = segment.data().map_err(|e| wrong(e.to_string()))?;
        // Initial values of variables are stored at their load address.
        let place = u64::from(segment.elf_program_header().p_paddr.get(file.endian()));
        if data.is_empty() {
            continue;
        }
        let start = place.checked_sub(FLASH).ok_or(wrong(format!("a part at 0x{place:08x}")))?;
        let end = start as usize + data.len();
        bytes.resize(bytes.len().max(end), 0xFF);
        bytes[start as usize..end].copy_from_slice(data);
    }
    Ok(bytes)
}

/// Text in Intel HEX: lines of 16 bytes, an extended address every 64 KiB.
fn hex(bytes: &[u8]) -> Vec<u8> {
    let mut text = String::new();
    for (place, chunk) in (FLASH..).step_by(LINE).zip(bytes.chunks(LINE)) {
        if place % 0x1_0000 == 0 {
            text += &record(0, 4, &((place >> 16) as u16).to_be_bytes());
        }
        text += &record(place as u16, 0, chunk);
    }
    text += &record(0, 1, &[]);
    text.into_bytes()
}

fn record(place: u16, kind: u8, data: &[u8]) -> String {
    let mut line = vec![data.len() as u8];
    line.extend(place.to_be_bytes());
    line.push(kind);
    line.extend(data);
    let sum = line.iter().fold(0_u8, |sum, &byte| sum.wrapping_add(byte));
    line.push(sum.wrapping_neg());
    let digits: String = line.iter().map(|byte| format!("{byte:02X}")).collect();
    format!(":{digits}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example in Intel's description, and the usual last line.
    #[test]
    fn records_end_with_their_sum() {
        let data = [
            0x21, 0x46, 0x01, 0x36, 0x01, 0x21, 0x47, 0x01, 0x36, 0x00, 0x7E, 0xFE, 0x09, 0xD2,
            0x19, 0x01,
        ];
        let line = ":10010000214601360121470136007EFE09D2190140\n";
        assert_eq!(record(0x100, 0, &data), line);
        assert_eq!(record(0, 1, &[]), ":00000001FF\n");
    }

    #[test]
    fn addresses_beyond_64_kib_are_extended() {
        let text = String::from_utf8(hex(&[0; 0x1_0010])).unwrap();
        assert!(text.starts_with(":020000040800F2\n:10000000"));
        assert!(text.contains(":020000040801F1\n:10000000"));
        assert_eq!(text.lines().count(), 2 + 0x1001 + 1);
    }
}
