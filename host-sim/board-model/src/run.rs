//! Input and outcome of a run: the files exchanged by the emulator and the program that starts it.

use std::path::PathBuf;

use floe::chip::{LoadCell, Schedule};
use serde::{Deserialize, Serialize};

/// Input file, in the emulator's working directory.
pub const SETUP_FILE: &str = "run.json";
/// File with the console's output, byte for byte.
pub const CONSOLE_FILE: &str = "console.out";
/// File with the log from RTT.
pub const LOGGED_FILE: &str = "logged";
/// File with the outcome.
pub const OUTCOME_FILE: &str = "outcome.json";

/// A moment of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum When {
    /// Seconds since power-up.
    Seconds(f64),
    /// End of this sample of the load cell: halfway from the tick that converts it to the next.
    Sample(u64),
}

/// An event of the script.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Incident {
    /// The user types, at the port's full speed.
    Type(String),
    /// The card is pulled out.
    PullCard,
    /// The card is inserted again.
    PutCard,
    /// The data line of the converter's bus is held low for this time, s.
    HoldBus(f64),
    /// The data line is held low by a chip that waits for this number of clocks.
    HoldBusForClocks(u32),
    /// The converter is reset: its registers are as at power-up.
    ResetConverter,
    /// The microsecond clock stops, so a program that waits by it waits for ever.
    StopClock,
    /// Every access to this peripheral fails.
    FailAccess(u32),
    /// The stack is used up except for this number of bytes, as by nested calls.
    UseUpStack(u32),
    /// The supply dips below the brown-out level; the backup domain keeps its supply.
    Dip,
    /// The supply fails for a moment: memory, calendar and card lose their state.
    CutPower,
    /// A picture of the display is taken.
    Photograph,
    /// The run is over.
    End,
}

/// A card.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardSetup {
    /// The file with the card's blocks.
    pub image: PathBuf,
    /// Whether the card is in its slot at power-up.
    pub present: bool,
    /// Busy time after a block, s.
    pub write_s: f64,
    /// Whether reading any block fails.
    pub unreadable: bool,
}

/// Input of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Codes of the load cell, one per sampling period.
    pub codes: Vec<i32>,
    /// Sampling periods per second.
    pub rate_hz: f64,
    /// Standard deviation of the converter's noise, in codes, and its seed.
    pub noise: (f64, u64),
    /// Faults of the converter.
    pub troubles: Schedule,
    /// Script of the run, in any order.
    pub script: Vec<(When, Incident)>,
    /// Time that the crystal takes to start, s; `None`: it never starts.
    pub crystal_start_s: Option<f64>,
    /// The card, if there is one.
    pub card: Option<CardSetup>,
    /// Whether a display is there.
    pub display: bool,
    /// TCP port of the console, for a run in real time.
    pub port: Option<u16>,
    /// Addresses of the stack's lower and upper end.
    pub stack: (u32, u32),
    /// Address of the RTT control block.
    pub rtt: Option<u32>,
}

impl Setup {
    /// A board at rest: no load, no events.
    #[must_use]
    pub fn quiet() -> Self {
        Self {
            codes: vec![0],
            rate_hz: 16.0,
            noise: (12.0, 1),
            troubles: Schedule::default(),
            script: Vec::new(),
            crystal_start_s: Some(2.0),
            card: None,
            display: true,
            port: None,
            stack: (0, 0),
            rtt: None,
        }
    }

    /// The load cell.
    #[must_use]
    pub fn load_cell(&self) -> LoadCell {
        let (codes, seed) = self.noise;
        LoadCell::from_codes(&self.codes, self.rate_hz).with_noise(codes, seed)
    }
}

/// Outcome of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Actions that reference manual or specification forbid.
    pub breaches: Vec<String>,
    /// Time, s, and cause of each reset.
    pub resets: Vec<(f64, String)>,
    /// Every conversion that was read: number of the load cell's sample, and code.
    pub delivered: Vec<(u64, i32)>,
    /// Largest use of the stack since the last reset, bytes.
    pub stack_used: u32,
    /// Typed characters that the firmware did not fetch in time.
    pub typed_lost: u32,
    /// Time at which each line of the console was complete, s.
    pub line_times_s: Vec<f64>,
    /// Time of the first tick after each start, s.
    pub first_ticks_s: Vec<f64>,
    /// The display at the end, one line per row of pixels.
    pub picture: Vec<String>,
    /// The display at each `Photograph`.
    pub photographs: Vec<Vec<String>>,
    /// Whole pictures sent to the display.
    pub pictures: u32,
    /// Blocks written to the card.
    pub blocks_written: u32,
    /// Emulated time, s.
    pub emulated_s: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe::chip::Trouble;

    #[test]
    fn a_setup_survives_its_file() {
        let setup = Setup {
            codes: vec![-1, 1 << 22],
            troubles: Schedule::default().with(1, 2, Trouble::Upset { register: 1, mask: 2 }),
            script: vec![(When::Sample(7), Incident::Type("stop\r\n".into()))],
            ..Setup::quiet()
        };
        let text = serde_json::to_string(&setup).unwrap();
        assert_eq!(serde_json::from_str::<Setup>(&text).unwrap(), setup);
    }
}
