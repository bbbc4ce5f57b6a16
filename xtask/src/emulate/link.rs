//! The model of the converter, connected to the emulator's FIFOs.

use std::fs::{File, OpenOptions};
use std::io::{BufReader, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use floe::chip::SerialChip;

/// Duration of a tick of the board's clock, ns.
const TICK_NS: u64 = 40;
/// Sampling periods in which the board must end the test.
const LAST_PERIODS: u64 = 4;

/// Console input at given times.
#[derive(Debug)]
pub struct Typist {
    console: File,
    /// Number of the load cell's sample, and text to type.
    lines: Vec<(u64, String)>,
}

impl Typist {
    /// A typist that appends to the file that the board reads.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn new(console: &Path, mut lines: Vec<(u64, String)>) -> std::io::Result<Self> {
        let console = OpenOptions::new().append(true).open(console)?;
        lines.sort_by_key(|&(sample, _)| sample);
        lines.reverse();
        Ok(Self { console, lines })
    }

    fn advance(&mut self, sample: u64) -> std::io::Result<()> {
        while self.lines.last().is_some_and(|&(at, _)| at <= sample) {
            if let Some((_, text)) = self.lines.pop() {
                self.console.write_all(text.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// The converter and the console input of a run.
#[derive(Debug)]
pub struct Link {
    /// The converter.
    pub chip: SerialChip,
    /// The console input.
    pub typist: Typist,
    /// Whether emulated time waits for real time.
    pub real_time: bool,
    /// Sample at which the power fails.
    pub cut_at: Option<u64>,
}

impl Link {
    /// Serves the converter until the end of the record, then closes the line.
    ///
    /// # Errors
    /// The emulator closed the line.
    pub fn serve(self, directory: &Path) -> std::io::Result<SerialChip> {
        let Self { mut chip, mut typist, real_time, cut_at } = self;
        // A FIFO opened for both directions does not wait for its other end.
        let open = |name| OpenOptions::new().read(true).write(true).open(directory.join(name));
        let (mut from, mut to) = (BufReader::new(open("adc.out")?), open("adc.in")?);
        let start = Instant::now();
        let end = cut_at.unwrap_or(chip.device().samples() + LAST_PERIODS);
        loop {
            let mut head = [0; 10];
            from.read_exact(&mut head)?;
            let [t @ .., count, wants_answer] = head;
            let now_ns = u64::from_le_bytes(t) * TICK_NS;
            let mut bytes = vec![0; usize::from(count)];
            from.read_exact(&mut bytes)?;
            if real_time {
                let due = Duration::from_nanos(now_ns);
                std::thread::sleep(due.saturating_sub(start.elapsed()));
            }
            bytes.iter().for_each(|&byte| chip.receive(now_ns, byte));
            let sample = chip.device().sample_at(now_ns);
            typist.advance(sample)?;
            if sample >= end {
                return Ok(chip);
            }
            if wants_answer != 0 {
                let mut answer = vec![0];
                answer.extend(chip.transmit(now_ns).iter().take(255));
                answer[0] = (answer.len() - 1) as u8;
                to.write_all(&answer)?;
            }
        }
    }
}
