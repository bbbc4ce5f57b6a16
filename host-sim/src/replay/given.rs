//! What the caller gives against what the log says of the same: the caller's counts, and that is said.

use clap::ValueEnum;
use floe_core::{Calibration, Config};

use crate::log::{Log, STANDARD_GRAVITY, Unit};

use super::input::Input;
use super::known::KnownOptions;

/// Weights and speeds within this share of each other are the same: gravity is, from place to
/// place, and a speed is hardly known better.
const SAME: f64 = 0.005;
/// All else within what single precision rounds.
const EQUAL: f64 = 1e-6;

/// A number that is used, and what the log says of it.
struct Used {
    /// The log's word for it.
    key: &'static str,
    /// The log's number, in the unit of the one used.
    said: Option<f64>,
    /// What it is, the number and its unit.
    what: &'static str,
    used: Option<f32>,
    unit: &'static str,
    /// Decimals to show; none: all there are.
    decimals: Option<usize>,
    /// The share of each other within which both are the same.
    same: f64,
}

/// A weight in newtons.
const WEIGHT: Used = Used {
    key: "weight_n",
    said: None,
    what: "weight",
    used: None,
    unit: " N",
    decimals: Some(1),
    same: SAME,
};

/// One sentence for each number of the log in whose place another one is used.
#[must_use]
pub fn instead(log: &Log, config: &Config, known: &KnownOptions) -> Vec<String> {
    let of_test = block(log, config).into_iter().chain(pull(log, config));
    let of_test = of_test.chain(how_well(log, known)).filter_map(|it| it.sentence(log));
    let others = weighed_by(log, known).into_iter().chain(without_winch(log, config, known));
    of_test.chain(others).chain(calibration(log, &config.calibration)).collect()
}

/// How well a speed is known that nobody says.
fn without_winch(log: &Log, config: &Config, known: &KnownOptions) -> Option<String> {
    let inputs = known.inputs(&log.metadata().known);
    let std = inputs.iter().find(|input| input.key == "winch_std_m_per_s")?;
    std.given.or(std.said).filter(|_| config.winch_m_per_s.is_none())?;
    Some(format!("{} is not used without the speed of the winch: --winch-m-per-s V", std.key))
}

/// The same of a calibration.
#[must_use]
pub fn calibration(log: &Log, calibration: &Calibration) -> Vec<String> {
    let said = log.metadata();
    let tare = Used {
        key: "tare_counts",
        said: said.tare_counts.map(f64::round),
        what: "tare",
        used: Some(calibration.tare_counts as f32),
        unit: " counts",
        decimals: Some(0),
        same: EQUAL,
    };
    let span = Used {
        key: "counts_per_n",
        said: said.counts_per_n,
        what: "span",
        used: Some(calibration.counts_per_n),
        unit: " counts/N",
        decimals: None,
        same: EQUAL,
    };
    let both = [tare, span].into_iter().filter(|_| log.unit() == Unit::Counts);
    both.filter_map(|it| it.sentence(log)).collect()
}

/// What presses the block, and what it weighs.
fn block(log: &Log, config: &Config) -> Vec<Used> {
    let said = log.metadata();
    let used = Some(config.weight_n);
    let normal =
        Used { key: "normal_n", said: said.normal_n, what: "normal force", used, ..WEIGHT };
    if config.mass_kg.is_some() {
        // Under the ice the weight presses nothing.
        let mass = Used { what: "mass", used: config.mass_kg, unit: " kg", ..of_mass(1.0, log) };
        return vec![normal, mass];
    }
    vec![if said.normal_n.is_some() {
        normal
    } else if said.weight_n.is_some() {
        Used { said: said.weight_n, used, ..WEIGHT }
    } else {
        Used { used, ..of_mass(STANDARD_GRAVITY, log) }
    }]
}

/// A mass that the log says, times `factor`.
fn of_mass(factor: f64, log: &Log) -> Used {
    Used { key: "mass_kg", said: log.metadata().mass_kg.map(|mass| mass * factor), ..WEIGHT }
}

/// How it is pulled and measured.
fn pull(log: &Log, config: &Config) -> [Used; 3] {
    let said = log.metadata();
    let slope = Used {
        key: "slope_deg",
        said: said.slope_deg,
        what: "slope",
        used: Some(config.slope_rad.to_degrees()),
        unit: "°",
        decimals: Some(2),
        same: EQUAL,
    };
    let winch = Used {
        key: "winch_m_per_s",
        said: said.winch_m_per_s,
        what: "winch at",
        used: config.winch_m_per_s,
        unit: " m/s",
        decimals: None,
        same: SAME,
    };
    let range = Used {
        key: "range_n",
        said: said.range_n,
        what: "range",
        used: config.range_n,
        decimals: None,
        same: EQUAL,
        ..WEIGHT
    };
    [slope, winch, range]
}

/// How well all this is known, and the zero: numbers that the caller gives, their unit in the key.
fn how_well(log: &Log, known: &KnownOptions) -> impl Iterator<Item = Used> {
    known.inputs(&log.metadata().known).into_iter().map(|Input { key, given, said }| Used {
        key,
        said,
        what: key,
        used: given.map(|given| given as f32),
        unit: "",
        decimals: None,
        same: EQUAL,
    })
}

/// What weighed the block.
fn weighed_by(log: &Log, known: &KnownOptions) -> Option<String> {
    let (given, said) = known.weight_from.zip(log.metadata().known.weight_from)?;
    let word = given.to_possible_value()?;
    let used = format!("weight_from {}", word.get_name());
    if given == said { None } else { as_given(log, "weight_from", &used) }
}

/// What is used, and the line of the log that says another.
fn as_given(log: &Log, key: &str, used: &str) -> Option<String> {
    let there = log.metadata().first(key)?;
    let (value, line) = (&there.value, there.line);
    Some(format!("{used} as given, not the '# {key}: {value}' of line {line}"))
}

impl Used {
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
