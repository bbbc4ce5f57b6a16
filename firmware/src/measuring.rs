//! Measurements without a pull: zero, span and weight.
//!
//! Each is the mean of a load at rest ([`crate::weighing`]), whose error shrinks until the user
//! types `accept` or `abort`. The settings change with `accept` only.

use crate::weighing::{Load, Rest, Unrest, Weighing};
use floe_core::num::math::{hypotenuse, larger, sqrt};
use floe_core::signal::calibrate::Calibrator;
use floe_core::{Counts, Reading};
use heapless::Vec;

use crate::adc::Input;
use crate::line::{Text, Weighed};
use crate::notebook::WeightFrom;
use crate::sample::{RATE_HZ, Sample};
use crate::settings::Settings;
use crate::text::text;

mod news;

/// Largest number of weights in one calibration.
const MOST_WEIGHTS: usize = 4;
/// Smallest force accepted as a load, in standard deviations; a weight below zero by more is an
/// error.
const SURE: f32 = 5.0;

/// Standard deviation of rounding to an integer code, codes: `1/sqrt(12)`.
const WHOLE_CODE: f32 = 0.289;

/// Quantity to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// The zero: the hook is empty.
    Tare,
    /// The span: a known force, N, is on the hook.
    Calibrate(f32),
    /// The weight of the block on the hook.
    Weigh,
}

/// A measurement in progress.
#[derive(Clone, Debug)]
pub struct Measuring {
    task: Task,
    /// Readings in codes, or in newtons for the block.
    weighing: Weighing,
    calibrator: Calibrator,
    range_counts: (i32, i32),
    /// Earlier weights of the calibration: force in N, codes above zero.
    weights: Vec<(f32, Load), MOST_WEIGHTS>,
    /// Whether the newest reading is outside the range.
    saturated: bool,
    /// Samples since the measurement began, including unusable ones.
    samples: u32,
    /// The block's weight at the last full second.
    weighed: Weighed,
    /// Code of the zero.
    tare: f32,
    /// Best measurement of the known weight so far, codes. It is kept, because later readings are
    /// of the hook without it.
    rested: Option<Load>,
}

/// Span in codes per newton, with its uncertainty.
#[derive(Clone, Copy, Debug)]
struct Span {
    counts_per_n: f32,
    std: f32,
    /// Largest deviation of a weight from the line through zero, N.
    residual_n: f32,
    /// Largest weight, N.
    largest_n: f32,
}

impl Measuring {
    /// Starts a measurement.
    #[must_use]
    pub fn new(task: Task, settings: &Settings) -> Self {
        let range_counts = settings.config.calibration.range_counts;
        let calibrator = Calibrator::new(&settings.config);
        let (weighing, weights) = (Weighing::new(RATE_HZ), Vec::new());
        let weighed = Weighed { duration_s: 0.0, load: Err(Hindrance::Short) };
        Self {
            task,
            weighing,
            calibrator,
            range_counts,
            weights,
            saturated: false,
            samples: 0,
            weighed,
            tare: settings.config.calibration.tare_counts as f32,
            rested: None,
        }
    }

    /// Continues with another known weight, which may already be on the hook; keeps the best
    /// measurement of the previous one.
    ///
    /// # Errors
    /// The previous weight was not at rest, or there is no room for another.
    pub fn another(&mut self, force_n: f32, settings: &Settings) -> Result<(), &'static str> {
        if let Task::Calibrate(before_n) = self.task {
            let load = self.rested.ok_or(Hindrance::Short.words())?;
            self.weights.push((before_n, load)).map_err(|_| "four weights are enough: accept")?;
        }
        let weights = core::mem::take(&mut self.weights);
        *self = Self { weights, ..Self::new(Task::Calibrate(force_n), settings) };
        Ok(())
    }

    /// Whether the span is measured.
    #[must_use]
    pub fn is_calibration(&self) -> bool {
        matches!(self.task, Task::Calibrate(_))
    }

    /// Whether the zero is measured.
    #[must_use]
    pub fn is_tare(&self) -> bool {
        self.task == Task::Tare
    }

    /// Takes a sample; returns `true` once a second.
    pub fn add(&mut self, sample: &Sample) -> bool {
        if sample.input != Input::Bridge {
            return false;
        }
        let value = sample.reading.ok().and_then(|code| self.value(code));
        self.saturated = sample.reading.is_ok() && value.is_none();
        self.weighing.add(value);
        self.samples = self.samples.wrapping_add(1);
        let second = self.samples.is_multiple_of(RATE_HZ as u32);
        if second {
            self.look();
        }
        second
    }

    /// Value of a code within the range: the code, or the force of the block, N.
    fn value(&self, code: Counts) -> Option<f32> {
        let (lowest, highest) = self.range_counts;
        match self.task {
            Task::Weigh => self.calibrator.force_n(Reading::Counts(code)).ok(),
            Task::Tare | Task::Calibrate(_) => {
                (lowest < code.0 && code.0 < highest).then_some(code.0 as f32)
            }
        }
    }

    /// Updates the result, once a second.
    fn look(&mut self) {
        match self.task {
            Task::Tare => {}
            Task::Calibrate(_) => {
                let sharper = |load: &Load| self.rested.is_none_or(|kept| load.std < kept.std);
                self.rested = self.load().ok().filter(sharper).or(self.rested);
            }
            Task::Weigh => {
                let duration_s = self.weighing.duration_s();
                self.weighed = Weighed { duration_s, load: self.load_above(0.0) };
            }
        }
    }

    /// The block's weight so far, updated once a second.
    #[must_use]
    pub fn weighed(&self) -> Option<Weighed> {
        (self.task == Task::Weigh).then_some(self.weighed)
    }

    /// Message on the progress, if one is due.
    #[must_use]
    pub fn news(&self, settings: &Settings) -> Option<Text> {
        // A message is due each time the duration doubles (to 64 s), then every minute.
        let seconds = self.samples / RATE_HZ as u32;
        let due = [8, 16, 32].contains(&seconds) || seconds.is_multiple_of(64);
        let news = match self.task {
            Task::Tare if due => self.zero().map(|rest| news::tare(&rest, settings)),
            Task::Calibrate(_) if due => {
                self.span().map(|(span, load)| news::span(span, &load, settings))
            }
            Task::Tare | Task::Calibrate(_) | Task::Weigh => return None,
        };
        Some(news.unwrap_or_else(text))
    }

    /// The settings updated with the result.
    ///
    /// # Errors
    /// Why the result cannot be used, or not yet.
    pub fn accept(&self, settings: &Settings) -> Result<Settings, &'static str> {
        let mut settings = settings.clone();
        match self.task {
            Task::Tare => {
                let rest = self.zero()?;
                let span = settings.config.calibration.counts_per_n;
                settings.config.calibration.tare_counts = rounded(rest.mean);
                settings.stds.zero_n = Some(hypotenuse(rest.std, WHOLE_CODE) / span.abs());
            }
            Task::Calibrate(_) => {
                settings.set_span(self.span()?.0.counts_per_n);
            }
            Task::Weigh => {
                let load = self.hanging()?;
                settings.config.weight_n = load.value;
                settings.stds.weight_n = Some(load.std);
                settings.weight_from = Some(WeightFrom::SameCell);
            }
        }
        Ok(settings)
    }

    fn rest(&self) -> Result<Rest, Hindrance> {
        if self.saturated {
            return Err(Hindrance::OutOfRange);
        }
        self.weighing.rest().map_err(Hindrance::from)
    }

    fn load_above(&self, zero: f32) -> Result<Load, Hindrance> {
        self.rest()?.load(zero).map_err(Hindrance::from)
    }

    /// Mean with an empty hook, codes.
    fn zero(&self) -> Result<Rest, &'static str> {
        let rest = self.rest().map_err(Hindrance::words)?;
        if rest.oscillation.is_seen {
            return Err("it swings: nothing may hang there");
        }
        Ok(rest)
    }

    /// Load of a known weight, codes.
    fn load(&self) -> Result<Load, &'static str> {
        let load = self.load_above(self.tare).map_err(Hindrance::words)?;
        let hangs = load.value.abs() > SURE * load.std;
        hangs.then_some(load).ok_or("nothing hangs there: tare first, then hang a known weight")
    }

    /// Load of the block, N.
    fn hanging(&self) -> Result<Load, &'static str> {
        let load = self.load_above(0.0).map_err(Hindrance::words)?;
        if load.value < -SURE * load.std {
            return Err("the force is below zero: tare the empty hook, or the cell is reversed");
        }
        let hangs = load.value > SURE * load.std;
        hangs.then_some(load).ok_or("nothing hangs there")
    }

    /// Line through zero fitted to all weights, and the newest weight.
    fn span(&self) -> Result<(Span, Load), &'static str> {
        let Task::Calibrate(force_n) = self.task else { return Err("no calibration") };
        let newest = self.load()?;
        let last = (force_n, newest);
        let all = || self.weights.iter().chain([&last]);
        let (mut squares, mut products, mut variance, mut largest_n) = (0.0, 0.0, 0.0, 0.0_f32);
        for (force_n, load) in all() {
            squares += force_n * force_n;
            products += force_n * load.value;
            variance += force_n * force_n * load.std * load.std;
            largest_n = larger(largest_n, *force_n);
        }
        let counts_per_n = products / squares;
        let mut residual_n = 0.0;
        for (force_n, load) in all() {
            residual_n = larger(residual_n, (load.value / counts_per_n - force_n).abs());
        }
        let std = sqrt(variance) / squares;
        let good = counts_per_n.is_finite() && counts_per_n != 0.0;
        let span = Span { counts_per_n, std, residual_n, largest_n };
        if good { Ok((span, newest)) } else { Err("the weights do not make a span") }
    }
}

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// The record is too short, or readings were missing.
    Short,
    /// The force rises or falls.
    Drifts,
    /// The force moves in another way than that of a swinging load.
    Moves,
    /// The force is beyond the range of the cell or the converter.
    OutOfRange,
}

impl Hindrance {
    /// The reason, and advice, as text for the user.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Short => "8 s of rest needed",
            Self::Drifts => "it drifts: let it hang still",
            Self::Moves => "it moves, or swings beyond 15 degrees: calm it",
            Self::OutOfRange => "OUT OF RANGE: overloaded, or a wire is off",
        }
    }
}

impl From<Unrest> for Hindrance {
    fn from(unrest: Unrest) -> Self {
        match unrest {
            Unrest::Short => Self::Short,
            Unrest::Drifts(_) => Self::Drifts,
            Unrest::Moves => Self::Moves,
        }
    }
}

fn rounded(value: f32) -> i32 {
    (value + 0.5_f32.copysign(value)) as i32
}
