//! The error budget of a test, line by line.

use floe_core::{Config, Entry, Input, Report, Share, budget};
use serde::Serialize;

use super::result::{known, short_or_null};
use crate::rounding::own_digits;

/// An input, how well it is known, and what that does to the means.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetLine {
    /// `weight_n`, `slope_rad`, `zero_n`, `span`, `damping`, `winch_m_per_s`, `zero_drift_n`,
    /// `weight_ratio` or `shared`.
    pub input: &'static str,
    /// Its value; `None` where it has none or is not known.
    #[serde(with = "short_or_null")]
    pub value: Option<f64>,
    /// Its standard deviation, in its own unit; `None` where the input is not known.
    #[serde(with = "short_or_null")]
    pub std: Option<f64>,
    /// What was stated, where the slips show that `std` is more.
    #[serde(skip)]
    pub stated_std: Option<f64>,
    /// What it does to `mu_s`.
    pub mu_s: BudgetShare,
    /// What it does to `mu`.
    pub mu: BudgetShare,
}

/// What an input does to one mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BudgetShare {
    /// Change of the coefficient with the input.
    #[serde(with = "short_or_null")]
    pub sensitivity: Option<f64>,
    /// One standard deviation of the coefficient because of it.
    #[serde(with = "short_or_null")]
    pub contribution: Option<f64>,
}

/// The lines of a test; none before its first event.
#[must_use]
pub fn lines(config: &Config, report: &Report) -> Vec<BudgetLine> {
    budget(config, report).into_iter().flatten().map(|entry| line(entry, config)).collect()
}

impl BudgetLine {
    /// What a person should know of it.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        let stated = self.stated_std.map(own_digits)?;
        Some(format!("stated {stated}, widened by what the slips show"))
    }
}

fn line(entry: Entry, config: &Config) -> BudgetLine {
    let stated = Some(config.std.damping).filter(|_| entry.input == Input::Damping);
    let is_unknown = entry.input == Input::Winch && entry.value.is_none();
    let share = |share: Share| BudgetShare {
        sensitivity: known(share.sensitivity),
        contribution: known(Some(share.contribution)),
    };
    let [mu_s, mu] = entry.shares.map(share);
    BudgetLine {
        input: name(entry.input),
        value: known(entry.value),
        std: known(entry.std).filter(|_| !is_unknown),
        // A hundredth more would not be seen.
        stated_std: known(stated.filter(|&stated| entry.std > Some(1.01 * stated))),
        mu_s,
        mu,
    }
}

fn name(input: Input) -> &'static str {
    match input {
        Input::Weight => "weight_n",
        Input::Slope => "slope_rad",
        Input::Zero => "zero_n",
        Input::Span => "span",
        Input::Damping => "damping",
        Input::Winch => "winch_m_per_s",
        Input::ZeroDrift => "zero_drift_n",
        Input::WeightChange => "weight_ratio",
        Input::Shared => "shared",
    }
}
