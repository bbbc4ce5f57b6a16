//! The error budget of a test, line by line.

use floe_core::{Config, Entry, Input, Report, Share, budget};
use serde::Serialize;

use super::result::{known, short_or_null};
use crate::rounding::own_digits;

/// An input of a test, its uncertainty, and the effect of that uncertainty on both means.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetLine {
    /// Name of the input: `weight_n`, `slope_rad`, `zero_n`, `span`, `damping`, `winch_m_per_s`,
    /// `zero_drift_n`, `weight_ratio` or `shared`.
    pub input: &'static str,
    /// Value of the input; `None` where it has none or is not known.
    #[serde(with = "short_or_null")]
    pub value: Option<f64>,
    /// Standard deviation in the unit of the input; `None` where the input is not known.
    #[serde(with = "short_or_null")]
    pub std: Option<f64>,
    /// The stated standard deviation, where the slips show that the true one, `std`, is larger.
    #[serde(skip)]
    pub stated_std: Option<f64>,
    /// Whether nothing has measured the input, so that its zeros mean only that nothing was seen.
    #[serde(skip)]
    pub is_unmeasured: bool,
    /// Effect on `mu_s`.
    pub mu_s: BudgetShare,
    /// Effect on `mu`.
    pub mu: BudgetShare,
}

/// Effect of one input on one mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BudgetShare {
    /// Derivative of the coefficient with respect to the input.
    #[serde(with = "short_or_null")]
    pub sensitivity: Option<f64>,
    /// Standard deviation of the coefficient due to this input.
    #[serde(with = "short_or_null")]
    pub contribution: Option<f64>,
}

/// The lines of a test; none before its first event.
#[must_use]
pub fn lines(config: &Config, report: &Report) -> Vec<BudgetLine> {
    budget(config, report).into_iter().flatten().map(|entry| line(entry, config)).collect()
}

impl BudgetLine {
    /// The line as it is printed: what was not measured has no numbers, which would read as none.
    #[must_use]
    pub fn printed(&self) -> Self {
        let hide = |share: BudgetShare| BudgetShare {
            contribution: share.contribution.filter(|_| !self.is_unmeasured),
            ..share
        };
        let std = self.std.filter(|_| !self.is_unmeasured);
        Self { std, mu_s: hide(self.mu_s), mu: hide(self.mu), ..self.clone() }
    }

    /// The remark for a reader: a stated value that was widened, or what was not measured.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        if self.is_unmeasured {
            return Some("not measured, and none is seen: take the zero before and after".into());
        }
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
        // A difference below 1 % would not show.
        stated_std: known(stated.filter(|&stated| entry.std > Some(1.01 * stated))),
        // Where both zeros are given, the replay corrects this.
        is_unmeasured: entry.input == Input::ZeroDrift && entry.std == Some(0.0),
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
