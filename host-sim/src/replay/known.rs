//! Uncertainties of the inputs of a test: from the options, else from the log.

use floe_core::signal::calibrate::Calibrator;
use floe_core::{Config, Counts, InputStd, Newtons, Reading, SampleFlag};

use crate::error::InputError;
use crate::log::{Log, Sample};

use super::input::Input;

/// What the caller says of it.
// A default in brackets, as every help has it, is no link.
#[allow(rustdoc::broken_intra_doc_links)]
#[derive(Clone, Copy, Debug, Default, PartialEq, clap::Args)]
pub struct KnownOptions {
    /// Standard deviation of the weight in newtons, 0 if exactly known
    /// [default: `# weight_std_n:` in the log, else 0.3 % of the weight]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub weight_std_n: Option<f64>,
    /// Standard deviation of the slope in degrees
    /// [default: `# slope_std_deg:` in the log, else 0.2]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub slope_std_deg: Option<f64>,
    /// Standard deviation of the load cell's zero in newtons
    /// [default: `# zero_std_n:` in the log, else what two zeros leave between them (their difference
    /// over the root of 12), else 0.1 % of the largest force of the events that count]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub zero_std_n: Option<f64>,
    /// Standard deviation of the load cell's span in percent
    /// [default: `# span_std_percent:` in the log, else 0.1]
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true)]
    pub span_std: Option<f64>,
    /// Standard deviation of the cable's damping, a part of the critical one, up to 0.3
    /// [default: `# damping_std:` in the log, else 0.005]
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    pub damping_std: Option<f64>,
    /// Standard deviation of the winch speed in m/s
    /// [default: `# winch_std_m_per_s:` in the log, else 1 % of it]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub winch_std_m_per_s: Option<f64>,
    /// What weighed the block: a wrong span of the same cell cancels
    /// [default: `# weight_from:` in the log, else other]
    #[arg(long)]
    pub weight_from: Option<WeightFrom>,
    /// Force without a load before the test in newtons, taken off
    /// [default: `# zero_before_n:` in the log]
    #[arg(long, value_name = "Z0", allow_negative_numbers = true)]
    pub zero_before_n: Option<f64>,
    /// Force without a load after the test in newtons: the zero goes linearly from the one before
    /// to it; given alone, all samples are less by it
    /// [default: `# zero_after_n:` in the log]
    #[arg(long, value_name = "Z1", allow_negative_numbers = true)]
    pub zero_after_n: Option<f64>,
}

/// What weighed the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum WeightFrom {
    /// The load cell that pulls it.
    SameCell,
    /// A balance of its own.
    Other,
}

impl WeightFrom {
    /// Parses the value of `# weight_from:`.
    ///
    /// # Errors
    /// An unknown word.
    pub fn from_word(word: &str) -> Result<Self, InputError> {
        <Self as clap::ValueEnum>::from_str(word, false).map_err(|_| {
            InputError::new(format!("'# weight_from:' has '{word}': same_cell or other"))
        })
    }
}

/// Uncertainties in the metadata of a log: `# key: value` lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnownMetadata {
    /// Numbers by their keys, in the order of [`KEYS`].
    values: [Option<f64>; KEYS.len()],
    /// `weight_from`.
    pub weight_from: Option<WeightFrom>,
}

/// Keys of the metadata.
const KEYS: [&str; 8] = [
    "weight_std_n",
    "slope_std_deg",
    "zero_std_n",
    "span_std_percent",
    "damping_std",
    "winch_std_m_per_s",
    "zero_before_n",
    "zero_after_n",
];

impl KnownMetadata {
    /// The number of a key; `None` for a key that is not one of `KEYS`.
    pub fn field(&mut self, key: &str) -> Option<&mut Option<f64>> {
        let place = KEYS.iter().position(|known| *known == key)?;
        self.values.get_mut(place)
    }
}

impl KnownOptions {
    /// The numbers of the options and of the log, in the order of `KEYS`.
    #[must_use]
    pub fn inputs(&self, said: &KnownMetadata) -> [Input; KEYS.len()] {
        let given = [
            self.weight_std_n,
            self.slope_std_deg,
            self.zero_std_n,
            self.span_std,
            self.damping_std,
            self.winch_std_m_per_s,
            self.zero_before_n,
            self.zero_after_n,
        ];
        let mut inputs = KEYS.map(|key| Input { key, given: None, said: None });
        for ((input, given), said) in inputs.iter_mut().zip(given).zip(said.values) {
            (input.given, input.said) = (given, said);
        }
        inputs
    }

    /// The number of each option, else that of the log.
    fn or(&self, said: &KnownMetadata) -> [Option<f64>; KEYS.len()] {
        self.inputs(said).map(|input| input.given.or(input.said))
    }

    /// Standard deviations for the core, given the weight and the winch speed.
    #[must_use]
    pub fn std(&self, said: &KnownMetadata, weight_n: f64, winch_m_per_s: Option<f64>) -> InputStd {
        let [weight, slope, zero, span, damping, winch, ..] = self.or(said);
        let usual = InputStd::default();
        let from = self.weight_from.or(said.weight_from);
        let or = |value: Option<f64>, usual: f32| value.map_or(usual, |value| value as f32);
        let remainder = self.both_zeros(said).map(Zero::remainder_std_n);
        // The caller's takes precedence; else the scatter of both zeros combined with the
        // remainder.
        let measured = match (zero, remainder) {
            (Some(scatter), Some(remainder)) if self.zero_std_n.is_none() => {
                Some(scatter.hypot(remainder))
            }
            (scatter, remainder) => scatter.or(remainder),
        };
        let winch = winch.zip(winch_m_per_s).map(|(std, speed)| std / speed);
        InputStd {
            weight: or(weight.map(|std| std / weight_n), usual.weight),
            slope_rad: or(slope.map(f64::to_radians), usual.slope_rad),
            zero_n: measured.map(|std| std as f32),
            span: match from {
                Some(WeightFrom::SameCell) => 0.0,
                _ => or(span.map(|percent| 0.01 * percent), usual.span),
            },
            damping: or(damping, usual.damping),
            winch: or(winch, usual.winch),
        }
    }

    /// The zeros before and after the test, if both are known; then the core need not estimate the
    /// drift.
    #[must_use]
    pub fn both_zeros(&self, said: &KnownMetadata) -> Option<Zero> {
        let [.., before, after] = self.or(said);
        before.zip(after).map(|(before_n, after_n)| Zero { before_n, after_n })
    }

    /// Whether a zero was stated, before or after the test.
    #[must_use]
    pub fn says_zero(&self, said: &KnownMetadata) -> bool {
        let [.., before, after] = self.or(said);
        before.or(after).is_some()
    }

    /// The zero to subtract from the forces.
    #[must_use]
    pub fn zero(&self, log: &Log) -> Zero {
        let [.., before, after] = self.or(&log.metadata().known);
        Zero { before_n: before.or(after).unwrap_or(0.0), after_n: after.or(before).unwrap_or(0.0) }
    }
}

/// The force without a load, measured before and after the test, N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Zero {
    /// Before the test.
    pub before_n: f64,
    /// After the test.
    pub after_n: f64,
}

impl Zero {
    /// Whether there is nothing to subtract.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.before_n == 0.0 && self.after_n == 0.0
    }

    /// The zero, N, interpolated linearly; `part` is the elapsed share of the test, 0 to 1.
    #[must_use]
    pub fn at(self, part: f64) -> f64 {
        self.before_n + part * (self.after_n - self.before_n)
    }

    /// Standard deviation, N, of the mean error that the interpolation leaves: a random walk from
    /// one zero to the other deviates from the straight line in its mean by |difference|/√12.
    #[must_use]
    pub fn remainder_std_n(self) -> f64 {
        (self.after_n - self.before_n).abs() / 12_f64.sqrt()
    }

    /// Subtracts the zero from all samples of a test, linearly from the first to the last. A
    /// saturated sample stays saturated, since the range is not applied again later.
    pub fn take_off(&self, samples: &mut [Sample], config: &Config) {
        // A code beyond the range of every converter.
        const SATURATED: Reading = Reading::Counts(Counts(i32::MAX));
        let calibrator = Calibrator::new(config);
        let ends = (samples.first().map(|s| s.time_s), samples.last().map(|s| s.time_s));
        let (Some(from_s), Some(to_s)) = ends else { return };
        for sample in samples {
            let part = (sample.time_s - from_s) / (to_s - from_s).max(f64::MIN_POSITIVE);
            sample.raw.reading = match calibrator.force_n(sample.raw.reading) {
                Ok(force_n) => Reading::Force(Newtons((f64::from(force_n) - self.at(part)) as f32)),
                Err(SampleFlag::Saturated) => SATURATED,
                Err(_) => continue,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::{Calibration, RawSample};

    #[test]
    fn the_zero_goes_evenly_from_one_to_the_other() {
        let sample = |index: u32| {
            let reading = Reading::Force(Newtons(100.0));
            Sample { raw: RawSample { index, reading }, time_s: index.into() }
        };
        let mut samples: Vec<Sample> = (0..5).map(sample).collect();
        Zero { before_n: 1.0, after_n: 9.0 }.take_off(&mut samples, &Config::default());
        let force = |s: &Sample| match s.raw.reading {
            Reading::Force(Newtons(force_n)) => force_n,
            Reading::Counts(_) | Reading::Bad(_) => f32::NAN,
        };
        assert_eq!(samples.iter().map(force).collect::<Vec<_>>(), [99.0, 97.0, 95.0, 93.0, 91.0]);
    }

    /// The range belongs to the cell: subtracting a zero moves no sample into it or out of it.
    #[test]
    fn what_is_saturated_is_told_before_the_zero_is_taken_off() {
        let calibration = Calibration { counts_per_n: 0.2, ..Calibration::default() };
        let config = Config { range_n: Some(700.0), calibration, ..Config::default() };
        for zero_n in [2.4, -2.4] {
            let raw = [
                Reading::Force(Newtons(700.0)),
                Reading::Force(Newtons(-699.0)),
                Reading::Force(Newtons(699.0)),
                Reading::Counts(Counts(config.calibration.range_counts.1)),
                Reading::Counts(Counts(100)),
            ];
            let sample = |reading| Sample { raw: RawSample { index: 0, reading }, time_s: 0.0 };
            let mut samples = raw.map(sample);
            let zero = Zero { before_n: zero_n, after_n: zero_n };
            zero.take_off(&mut samples, &config);
            let calibrator = Calibrator::new(&Config { range_n: None, ..config });
            let forces = samples.map(|sample| calibrator.force_n(sample.raw.reading));
            let saturated = Err(SampleFlag::Saturated);
            let less = |force_n: f64| Ok((force_n - zero_n) as f32);
            assert_eq!(forces, [saturated, less(-699.0), less(699.0), saturated, less(500.0)]);
        }
    }

    #[test]
    fn options_come_before_the_log_and_the_log_before_the_usual() {
        let mut said = KnownMetadata::default();
        *said.field("weight_std_n").unwrap() = Some(6.3);
        *said.field("damping_std").unwrap() = Some(0.0);
        *said.field("zero_before_n").unwrap() = Some(0.0);
        *said.field("zero_after_n").unwrap() = Some(12.0);
        let options = KnownOptions { weight_std_n: Some(0.63), ..KnownOptions::default() };
        let std = options.std(&said, 630.0, None);
        assert!((std.weight - 0.001).abs() < 1e-7 && std.damping.abs() < 1e-9);
        assert!((std.zero_n.unwrap() - 3.4641).abs() < 1e-3);
        assert_eq!((std.span, std.slope_rad), (0.001, InputStd::default().slope_rad));
        // The scatter of the zero is combined with its drift.
        *said.field("zero_std_n").unwrap() = Some(0.001);
        assert!((options.std(&said, 630.0, None).zero_n.unwrap() - 3.4641).abs() < 1e-3);
        said.weight_from = Some(WeightFrom::SameCell);
        assert!(options.std(&said, 630.0, None).span.abs() < 1e-9);
        assert!(said.field("weight_n").is_none());
    }
}
