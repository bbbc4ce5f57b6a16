//! Self test before the first pull: converter, wiring and noise.

use crate::adc::Input;
use crate::average::{Average, MOST};
use crate::line::Mean;
use crate::sample::Sample;
use crate::settings::Settings;

/// Inputs measured, in order, and the number of readings of each.
const STEPS: [(Input, usize); 4] =
    [(Input::Temperature, 2), (Input::Shorted, MOST), (Input::BurnOut, 2), (Input::Bridge, MOST)];

/// Largest healthy standard deviation with the inputs shorted, codes; that of the chip is 12 at
/// these settings.
const NOISE_CODES: f32 = 200.0;
/// Fraction of the range below zero from which a reading is an error.
const BELOW_ZERO: f32 = 0.02;
/// Code near full scale, to which the burn-out currents drive a broken bridge.
const OPEN_CODES: f32 = 0.99 * 8_388_608.0;

/// A self test in progress.
#[derive(Clone, Debug)]
pub struct SelfTest {
    step: usize,
    average: Average,
    passed: bool,
}

impl SelfTest {
    /// A self test at its first measurement.
    #[must_use]
    pub fn new() -> Self {
        Self { step: 0, average: average(STEPS[0]), passed: true }
    }

    /// Input to be measured now.
    #[must_use]
    pub fn input(&self) -> Input {
        STEPS.get(self.step).map_or(Input::Bridge, |&(input, _)| input)
    }

    /// Takes a sample; returns the result when a measurement is complete.
    pub fn add(&mut self, sample: &Sample) -> Option<Mean> {
        self.average.add(sample)
    }

    /// Proceeds to the next measurement; `false` after the last.
    pub fn advance(&mut self) -> bool {
        self.step += 1;
        let next = STEPS.get(self.step);
        if let Some(&step) = next {
            self.average = average(step);
        }
        next.is_some()
    }

    /// Records a failure.
    pub fn fail(&mut self) {
        self.passed = false;
    }

    /// Whether no measurement has failed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.passed
    }

    /// The defect that a measurement shows, as text.
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

/// Force of a code as a fraction of the range: that of the cell, or of the converter if the cell's
/// is unknown.
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
