//! One command before the first pull: converter, wiring, noise, rate.

use crate::adc::Input;
use crate::average::{Average, MOST};
use crate::line::Mean;
use crate::sample::Sample;
use crate::settings::Settings;

/// What is measured, in order, and how often.
const STEPS: [(Input, usize); 4] =
    [(Input::Temperature, 2), (Input::Shorted, MOST), (Input::BurnOut, 2), (Input::Bridge, MOST)];

/// Codes of noise (standard deviation) with the inputs shorted that are still
/// healthy; the chip's own are 12 at these settings.
const NOISE_CODES: f32 = 200.0;
/// A zero so far below, as a part of the range, is none.
const BELOW_ZERO: f32 = 0.02;
/// Codes near full scale, where the burn-out currents drive a broken bridge.
const OPEN_CODES: f32 = 0.99 * 8_388_608.0;

/// The self test going on.
#[derive(Clone, Debug)]
pub struct SelfTest {
    step: usize,
    average: Average,
    passed: bool,
}

impl SelfTest {
    /// The first measurement.
    #[must_use]
    pub fn new() -> Self {
        Self { step: 0, average: average(STEPS[0]), passed: true }
    }

    /// What has to be measured now.
    #[must_use]
    pub fn input(&self) -> Input {
        STEPS.get(self.step).map_or(Input::Bridge, |&(input, _)| input)
    }

    /// Takes a sample; gives a result when a measurement is complete.
    pub fn add(&mut self, sample: &Sample) -> Option<Mean> {
        self.average.add(sample)
    }

    /// Goes on to the next measurement; `false` if there is none.
    pub fn advance(&mut self) -> bool {
        self.step += 1;
        let next = STEPS.get(self.step);
        if let Some(&step) = next {
            self.average = average(step);
        }
        next.is_some()
    }

    /// Remembers that something is wrong.
    pub fn fail(&mut self) {
        self.passed = false;
    }

    /// Whether nothing was wrong.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.passed
    }

    /// What is wrong with a measurement.
    #[must_use]
    pub fn judge(mean: &Mean, settings: &Settings) -> Option<&'static str> {
        if mean.count == 0 {
            return Some("the converter does not answer: check its wires");
        }
        if mean.failed > 0 {
            return Some("the converter owed readings: check its wires and supply");
        }
        let part = part_of_range(mean.mean, settings);
        match mean.input {
            Input::Temperature if !(-60.0..=85.0).contains(&(mean.mean / 256.0)) => {
                Some("the converter's temperature is impossible")
            }
            Input::Shorted if mean.deviation > NOISE_CODES => {
                Some("noisy with its inputs shorted: check the supply")
            }
            Input::BurnOut if mean.mean.abs() > OPEN_CODES => {
                Some("a wire to the load cell is broken")
            }
            Input::Bridge if mean.mean.abs() > OPEN_CODES => {
                Some("the load cell reads full scale: overloaded, or a wire is off")
            }
            Input::Bridge if mean.different < 2 => Some("the load cell's reading never changes"),
            Input::Bridge if part < -BELOW_ZERO => {
                Some("the load cell reads below zero: tare it, or it is reversed")
            }
            Input::Temperature | Input::Shorted | Input::BurnOut | Input::Bridge => None,
        }
    }
}

/// Force of a code as a part of the range: the cell's, or the converter's if the cell's is
/// not known.
#[must_use]
pub fn part_of_range(code: f32, settings: &Settings) -> f32 {
    let calibration = &settings.config.calibration;
    let force_n = (code - calibration.tare_counts as f32) / calibration.counts_per_n;
    force_n / settings.range_n()
}

impl Default for SelfTest {
    fn default() -> Self {
        Self::new()
    }
}

fn average((input, count): (Input, usize)) -> Average {
    Average::new(input, count)
}
