//! `cargo xtask size`: memory use of the firmware on the board.

use std::collections::BTreeMap;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind};

use crate::Result;
use crate::arm::Route;
use crate::emulate::machine::Machine;
use crate::emulate::nucleo::Nucleo;
use crate::panics;

/// Limits for the board, bytes.
const FLASH_LIMIT: u64 = 128 * 1024;
const RAM_LIMIT: u64 = 32 * 1024;
/// Reserve of stack beyond the use on the emulated boards, bytes, for paths that the emulated tests
/// do not take.
const STACK_SPARE: u64 = 4 * 1024;

/// Prints the sizes, and fails if one exceeds its limit.
///
/// # Errors
/// The firmware does not build or is too big.
pub fn run(forced: Option<Route>) -> Result<()> {
    let route = Route::find(forced)?;
    let path = route.build_firmware("nucleo-l476", "nucleo-l476")?;
    let image = Image::read(&path)?;
    let own = Nucleo::prepare(forced)?.stack_used()?;
    let other = Machine::prepare(forced)?.stack_used()?;
    let stack = own.max(other);
    let ram = image.statics + image.stack;
    println!("nucleo-l476, release image");
    println!("flash       {:6} of {FLASH_LIMIT} bytes", image.flash);
    println!("RAM         {ram:6} of {RAM_LIMIT} bytes:");
    println!("  statics   {:6}", image.statics);
    println!("  stack     {:6} reserved; {own} used at most by this image, emulated", image.stack);
    println!("                   ({other} by the one for mps2-an386)");
    println!("flash by crate (symbols with a name):");
    let mut crates: Vec<_> = image.crates.iter().collect();
    crates.sort_by_key(|&(_, size)| std::cmp::Reverse(*size));
    for (name, size) in crates.iter().take(12) {
        println!("  {name:18} {size:6}");
    }
    println!("{}", panics::check(&path)?);
    match (image.flash <= FLASH_LIMIT, ram <= RAM_LIMIT, stack + STACK_SPARE <= image.stack) {
        (true, true, true) => Ok(()),
        (false, ..) => Err(format!("the image is over its {FLASH_LIMIT} bytes of flash")),
        (_, false, _) => Err(format!("the image is over its {RAM_LIMIT} bytes of RAM")),
        (.., false) => Err(format!("the stack has less than {STACK_SPARE} bytes to spare")),
    }
}

/// Sizes from an ELF file.
pub(crate) struct Image {
    pub(crate) flash: u64,
    statics: u64,
    stack: u64,
    /// Bytes of flash by crate.
    pub(crate) crates: BTreeMap<String, u64>,
}

impl Image {
    #[allow(clippy::wildcard_enum_match_arm)] // most kinds of section are not on the board
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let elf = object::File::parse(&*bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        let (mut flash, mut statics) = (0, 0);
        for section in elf.sections() {
            let in_ram = section.address() >> 28 == 2;
            match section.kind() {
                SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => {
                    flash += section.size();
                }
                // Initial values are stored in flash too.
                SectionKind::Data => {
                    (flash, statics) = (flash + section.size(), statics + section.size())
                }
                _ => statics += if in_ram { section.size() } else { 0 },
            }
        }
        let address =
            |name: &str| elf.symbols().find(|s| s.name() == Ok(name)).map(|s| s.address());
        let stack = match (address("_stack_start"), address("_stack_end")) {
            (Some(start), Some(end)) => start - end,
            _ => return Err("the image does not name its stack".into()),
        };
        let mut crates = BTreeMap::new();
        for symbol in elf.symbols().filter(|s| s.address() >> 28 == 0 && s.size() > 0) {
            let name = crate_of(symbol.name().unwrap_or(""));
            *crates.entry(name).or_insert(0) += symbol.size();
        }
        Ok(Self { flash, statics, stack, crates })
    }
}

/// Crate of a symbol.
fn crate_of(symbol: &str) -> String {
    let name = format!("{:#}", rustc_demangle::demangle(symbol));
    let name = name.trim_start_matches(['<', '&', '[', '(', '*']);
    let end = name.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let first = &name[..end.unwrap_or(name.len())];
    if first.is_empty() || first == "Lanon" { "constants".into() } else { first.to_string() }
}
