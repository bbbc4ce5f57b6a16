//! `floe-defmt FIRMWARE LOGGED` prints every frame that the firmware logged, one per line.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use defmt_decoder::{DecodeError, Table};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [firmware, logged] = arguments.as_slice() else {
        eprintln!("floe-defmt: two files are needed: the firmware and what it logged");
        return ExitCode::from(2);
    };
    match decode(firmware, logged) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("floe-defmt: {message}");
            ExitCode::from(2)
        }
    }
}

fn decode(firmware: &str, logged: &str) -> Result<(), String> {
    let elf = std::fs::read(firmware).map_err(|e| format!("{firmware}: {e}"))?;
    let bytes = std::fs::read(logged).map_err(|e| format!("{logged}: {e}"))?;
    let table = Table::parse(&elf).map_err(|e| format!("{firmware}: {e}"))?;
    let table = table.ok_or_else(|| format!("{firmware}: the firmware has no log in it"))?;
    let mut decoder = table.new_stream_decoder();
    decoder.received(&bytes);
    loop {
        match decoder.decode() {
            Ok(frame) => println!("{}", frame.display(false)),
            Err(DecodeError::UnexpectedEof) => return Ok(()),
            Err(DecodeError::Malformed) => return Err(format!("{logged}: a damaged frame")),
        }
    }
}
