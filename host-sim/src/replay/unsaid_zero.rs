//! A zero of the load cell that the record itself shows and nobody stated: a small constant force before
//! the first slip or after the last one.

use super::result::ReplayResult;
use super::stretches::SteadySummary;
use crate::rounding::{decimals, own_digits};

/// Largest force without a load, parts of the force at which slips begin. A choice: a cable that lies
/// on the snow pulls with less.
const SMALL: f64 = 0.05;
/// Standard deviations of the assumed zero beyond which the force is no zero that is allowed for.
const BEYOND: f64 = 2.0;

/// What to say of it: `assumed_std_n` is the standard deviation with which the zero counts in the budget.
pub(super) fn warning(result: &ReplayResult, assumed_std_n: f64) -> Option<String> {
    let (first, last) = result.events.first().zip(result.events.last())?;
    let (first_s, last_s) = (first.onset_s, last.stop_s);
    let most = SMALL * result.estimate.mu_s.mean.or(result.estimate.mu.mean)?.abs();
    let weight_n = result.test.weight_n;
    let rests = |it: &&SteadySummary| {
        let [off, least] = [it.force_over_weight.abs(), BEYOND * assumed_std_n / weight_n];
        off < most && off > least && off > 3.0 * it.std
    };
    let mut rests = result.stretches.steady.iter().filter(rests);
    let before = rests.clone().find(|it| it.stop_s <= first_s);
    let after = rests.rfind(|it| it.start_s >= last_s);
    let (mut seen, mut options) = (Vec::new(), String::new());
    for (rest, option) in [(before, "--zero-before-n"), (after, "--zero-after-n")] {
        let Some(SteadySummary { start_s, stop_s, force_over_weight, .. }) = rest else { continue };
        let zero_n = force_over_weight * weight_n;
        let zero_n = format!("{zero_n:.*}", decimals(zero_n));
        seen.push(format!("{zero_n} N from {start_s:.0} to {stop_s:.0} s"));
        options += &format!(" {option} {zero_n}");
    }
    (!seen.is_empty()).then(|| {
        format!(
            "the force rests at {}, and the zero counts as 0 ± {} N: if nothing hung on the cell then, say{options}",
            seen.join(" and "),
            own_digits(assumed_std_n)
        )
    })
}
