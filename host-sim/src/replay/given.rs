//! Numbers of the caller against those of the log: the caller's is used, and each difference
//! reported.

use clap::ValueEnum;
use floe_core::{Calibration, Config};

use crate::log::{Log, STANDARD_GRAVITY, Unit};

use super::input::Input;
use super::known::KnownOptions;

/// Relative difference up to which weights and speeds count as equal: gravity varies by as much
/// from place to place, and a speed is hardly known better.
const SAME: f64 = 0.005;
/// Relative difference up to which all other numbers count as equal: the rounding of an `f32`.
const EQUAL: f64 = 1e-6;

/// A number in use, and the number of the log for the same quantity.
struct Used {
    /// Key of the quantity in the log.
    key: &'static str,
    /// The log's number, in the unit of `used`.
    said: Option<f64>,
    /// Name of the quantity in the sentence.
    what: &'static str,
    used: Option<f32>,
    unit: &'static str,
    /// Decimals to print; `None`: all digits.
    decimals: Option<usize>,
    /// Relative difference up to which both numbers count as equal.
    same: f64,
}

impl Used {
    /// A number that is printed with all its digits, and that any difference but rounding changes.
    fn new(
        (key, what, unit): (&'static str, &'static str, &'static str),
        said: Option<f64>,
        used: Option<f32>,
    ) -> Self {
        Self { key, said, what, used, unit, decimals: None, same: EQUAL }
    }

    fn sentence(&self, log: &Log) -> Option<String> {
        let (said, used) = self.said.zip(self.used)?;
        let given = f64::from(used);
        if (given - said).abs() <= self.same * said.abs().max(given.abs()) {
            return None;
        }
        let number = match self.decimals {
            Some(decimals) => format!("{used:.decimals$}"),
            None => used.to_string(),
        };
        let Self { what, unit, key, .. } = self;
        as_given(log, key, &format!("{what} {number}{unit}"))
    }
}

/// A weight or another force in newtons.
fn weighed(
    (key, what): (&'static str, &'static str),
    said: Option<f64>,
    used: Option<f32>,
) -> Used {
    Used { decimals: Some(1), same: SAME, ..Used::new((key, what, " N"), said, used) }
}

/// One sentence for each number of the log that another one replaces.
#[must_use]
pub fn instead(log: &Log, config: &Config, known: &KnownOptions) -> Vec<String> {
    let of_test = block(log, config).into_iter().chain(pull(log, config));
    let of_test = of_test.chain(how_well(log, known)).filter_map(|it| it.sentence(log));
    let others = weighed_by(log, known).into_iter().chain(without_winch(log, config, known));
    of_test.chain(others).chain(calibration(log, &config.calibration)).collect()
}

/// A standard deviation of the winch speed that has no effect, since the speed is not known.
fn without_winch(log: &Log, config: &Config, known: &KnownOptions) -> Option<String> {
    let inputs = known.inputs(&log.metadata().known);
    let std = inputs.iter().find(|input| input.key == "winch_std_m_per_s")?;
    std.given.or(std.said).filter(|_| config.winch_m_per_s.is_none())?;
    Some(format!("{} is not used without the speed of the winch: --winch-m-per-s V", std.key))
}

/// One sentence for each number of the log's calibration that another one replaces.
#[must_use]
pub fn calibration(log: &Log, calibration: &Calibration) -> Vec<String> {
    let said = log.metadata();
    let tare = said.tare_counts.map(f64::round);
    let in_use = Some(calibration.tare_counts as f32);
    let tare = Used::new(("tare_counts", "tare", " counts"), tare, in_use);
    let tare = Used { decimals: Some(0), ..tare };
    let in_use = Some(calibration.counts_per_n);
    let span = Used::new(("counts_per_n", "span", " counts/N"), said.counts_per_n, in_use);
    let both = [tare, span].into_iter().filter(|_| log.unit() == Unit::Counts);
    both.filter_map(|it| it.sentence(log)).collect()
}

/// The force that presses the block onto the ice, and its mass or weight.
fn block(log: &Log, config: &Config) -> Vec<Used> {
    let (said, used) = (log.metadata(), Some(config.weight_n));
    let normal = weighed(("normal_n", "normal force"), said.normal_n, used);
    if config.mass_kg.is_some() {
        // Under the ice the weight is not the normal force.
        let mass = weighed(("mass_kg", "mass"), said.mass_kg, config.mass_kg);
        return vec![normal, Used { unit: " kg", ..mass }];
    }
    vec![if said.normal_n.is_some() {
        normal
    } else if said.weight_n.is_some() {
        weighed(("weight_n", "weight"), said.weight_n, used)
    } else {
        let of_mass_n = said.mass_kg.map(|mass| mass * STANDARD_GRAVITY);
        weighed(("mass_kg", "weight"), of_mass_n, used)
    }]
}

/// Slope, winch speed and range.
fn pull(log: &Log, config: &Config) -> [Used; 3] {
    let said = log.metadata();
    let slope_deg = Some(config.slope_rad.to_degrees());
    let slope = Used::new(("slope_deg", "slope", "°"), said.slope_deg, slope_deg);
    let winch = ("winch_m_per_s", "winch at", " m/s");
    let winch = Used::new(winch, said.winch_m_per_s, config.winch_m_per_s);
    let range = Used::new(("range_n", "range", " N"), said.range_n, config.range_n);
    [Used { decimals: Some(2), ..slope }, Used { same: SAME, ..winch }, range]
}

/// Uncertainties and zeros that the caller gives; the unit is part of the key.
fn how_well(log: &Log, known: &KnownOptions) -> impl Iterator<Item = Used> {
    let used =
        |Input { key, given, said }| Used::new((key, key, ""), said, given.map(|it| it as f32));
    known.inputs(&log.metadata().known).into_iter().map(used)
}

/// The source of the weight, where the caller and the log differ.
fn weighed_by(log: &Log, known: &KnownOptions) -> Option<String> {
    let (given, said) = known.weight_from.zip(log.metadata().known.weight_from)?;
    let word = given.to_possible_value()?;
    let used = format!("weight_from {}", word.get_name());
    if given == said { None } else { as_given(log, "weight_from", &used) }
}

/// The sentence: the number in use, and the line of the log that it replaces.
fn as_given(log: &Log, key: &str, used: &str) -> Option<String> {
    // A log that contradicts itself was reported with both lines.
    let there = log.metadata().first(key).filter(|_| !log.metadata().is_contradicted(key))?;
    let (value, line) = (&there.value, there.line);
    Some(format!("{used} as given, not the '# {key}: {value}' of line {line}"))
}
