//! The shape of a logger's loop: a converter's codes in, one line an event out. Everything
//! but `main` and the two stand-ins for hardware is as on the board: no allocation, no
//! clock, no float formatting needed.

use floe_core::{Calibration, Config, Counts, Event, Fault, Pipeline, RawSample, Reading};

/// The converter: a code, or `None` where it did not answer in time.
trait Converter {
    fn read(&mut self) -> Option<i32>;
}

/// Where results go.
trait Console {
    fn event(&mut self, event: &Event);
}

/// What a timer's interrupt does 16 times a second.
fn tick(
    pipeline: &mut Pipeline,
    index: u32,
    converter: &mut impl Converter,
    out: &mut impl Console,
) {
    let reading = match converter.read() {
        Some(code) => Reading::Counts(Counts(code)),
        None => Reading::Bad(Fault::Timeout),
    };
    if let Some(event) = pipeline.step(RawSample { index, reading }).event {
        out.event(&event);
    }
}

fn main() {
    let calibration =
        Calibration { tare_counts: 4120, counts_per_n: 800.0, ..Calibration::default() };
    let config = Config { weight_n: 630.0, calibration, ..Config::default() };
    let Ok(mut pipeline) = Pipeline::new(&config) else { return };
    let (mut converter, mut console) = (Saw { sample: 0 }, Lines);
    for index in 0..960 {
        tick(&mut pipeline, index, &mut converter, &mut console);
    }
}

/// Stands for the hardware: a saw tooth, with an answer missing now and then.
struct Saw {
    sample: i32,
}

impl Converter for Saw {
    fn read(&mut self) -> Option<i32> {
        self.sample += 1;
        let force_n = 200 + self.sample % 28 * 21;
        (self.sample % 101 > 0).then_some(4120 + 800 * force_n)
    }
}

struct Lines;

impl Console for Lines {
    fn event(&mut self, event: &Event) {
        println!("event {} at sample {}: {}", event.index, event.onset.index, event.quality);
    }
}
