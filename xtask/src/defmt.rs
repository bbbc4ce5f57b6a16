//! `cargo xtask defmt`: the firmware's log of an emulated test, decoded.

use defmt_decoder::{DecodeError, Table};

use crate::Result;
use crate::arm::Route;
use crate::emulate::machine::{Machine, Setup};
use crate::emulate::record::Record;

/// Runs a test with a converter that falls silent once, decodes every frame and
/// looks for what has to be there: start and end, each event, the silence.
///
/// # Errors
/// A frame that cannot be decoded, or one that is missing.
pub fn run(forced: Option<Route>) -> Result<()> {
    let machine = Machine::with_features(forced, "mps2-an386,defmt")?;
    let mut record = Record::stick_slip();
    if let Some(code) = record.codes.get_mut(500) {
        *code = None;
    }
    let run = machine.run(&record, Setup::default())?;
    let frames = decode(machine.firmware(), &run.logged)?;
    let count = |words: &str| frames.iter().filter(|frame| frame.contains(words)).count();
    for frame in frames.iter().take(3).chain(frames.last()) {
        println!("defmt: {frame}");
    }
    let found = (count("starts"), count("ends"), count("Event"), count("Silent"));
    println!("defmt: {} frames, {} events among them", frames.len(), found.2);
    match found {
        (1, 1, 20.., 1..) => Ok(()),
        _ => Err(format!("starts, ends, events, silences: {found:?}")),
    }
}

fn decode(firmware: &std::path::Path, logged: &[u8]) -> Result<Vec<String>> {
    let elf = std::fs::read(firmware).map_err(|e| e.to_string())?;
    let table = Table::parse(&elf).map_err(|e| e.to_string())?;
    let table = table.ok_or("the firmware has no log in it")?;
    let mut decoder = table.new_stream_decoder();
    decoder.received(logged);
    let mut frames = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => frames.push(frame.display(false).to_string()),
            Err(DecodeError::UnexpectedEof) => return Ok(frames),
            Err(DecodeError::Malformed) => return Err("a damaged frame".into()),
        }
    }
}
