//! What a run is to be, and what it was: the files between the emulator and whoever
//! starts it.

use std::path::PathBuf;

use floe::chip::{LoadCell, Schedule};
use serde::{Deserialize, Serialize};

/// In the emulator's working directory.
pub const SETUP_FILE: &str = "run.json";
/// What the board said, byte for byte.
pub const CONSOLE_FILE: &str = "console.out";
/// What it logged by way of RTT.
pub const LOGGED_FILE: &str = "logged";
/// What came of it.
pub const OUTCOME_FILE: &str = "outcome.json";

/// A moment of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum When {
    /// Seconds since the power came.
    Seconds(f64),
    /// When this sample of the load cell is over: halfway from the tick that converts it to
    /// the next.
    Sample(u64),
}

/// Something that happens to the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Incident {
    /// Somebody types, at the port's full speed.
    Type(String),
    /// The card is pulled out.
    PullCard,
    /// It is put in again.
    PutCard,
    /// The data line of the converter's bus is held down for so long, s.
    HoldBus(f64),
    /// It is held down by a chip that waits for so many clocks.
    HoldBusForClocks(u32),
    /// The converter goes away or comes back: registers as at power-up.
    ResetConverter,
    /// The microsecond clock stands still: whoever waits, waits for ever.
    StopClock,
    /// Every access to this peripheral fails.
    FailAccess(u32),
    /// The stack is used up but for so many bytes, as by functions that call each other.
    UseUpStack(u32),
    /// It dips below the level of the brown-out reset, and the backup domain lives on.
    Dip,
    /// The supply goes for a moment: memory, calendar and card forget.
    CutPower,
    /// Somebody takes a picture of the display.
    Photograph,
    /// The run is over.
    End,
}

/// A card.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CardSetup {
    /// The file with its blocks.
    pub image: PathBuf,
    /// Whether it is in its slot when the power comes.
    pub present: bool,
    /// Busy after a block, s.
    pub write_s: f64,
    /// No block can be read.
    pub unreadable: bool,
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// Codes of the load cell, one a sampling period.
    pub codes: Vec<i32>,
    /// Sampling periods a second.
    pub rate_hz: f64,
    /// Standard deviation of the converter's noise, in codes, and its seed.
    pub noise: (f64, u64),
    /// What is wrong with the converter.
    pub troubles: Schedule,
    /// What happens, in any order.
    pub script: Vec<(When, Incident)>,
    /// Time that the crystal takes to start, s; `None`: it never does.
    pub crystal_start_s: Option<f64>,
    /// The card, if there is one.
    pub card: Option<CardSetup>,
    /// Whether a display is there.
    pub display: bool,
    /// In real time, with the console on this TCP port.
    pub port: Option<u16>,
    /// Addresses of the stack's two ends: lower, upper.
    pub stack: (u32, u32),
    /// Address of the RTT control block.
    pub rtt: Option<u32>,
}

impl Setup {
    /// A board at rest: nothing hangs there, nothing happens.
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

/// What came of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// What was done that reference manual or specification forbid.
    pub breaches: Vec<String>,
    /// When and why the board started again.
    pub resets: Vec<(f64, String)>,
    /// Every conversion that was read: number of the load cell's sample and code.
    pub delivered: Vec<(u64, i32)>,
    /// Bytes of stack used at most since the last reset.
    pub stack_used: u32,
    /// Characters typed that nobody fetched in time.
    pub typed_lost: u32,
    /// When each line of the console was complete, s.
    pub line_times_s: Vec<f64>,
    /// When the first tick of each start came, s.
    pub first_ticks_s: Vec<f64>,
    /// What the display shows at the end: a row of points a line.
    pub picture: Vec<String>,
    /// What it showed whenever a picture was taken.
    pub photographs: Vec<Vec<String>>,
    /// Whole pictures that it got.
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
