//! Reasons to doubt that the log and the given numbers belong together.

use floe_core::detector::FIRST_DROP;
use floe_core::{Config, Counters, Reason, Report};

use super::events::Events;
use super::given;
use super::known::KnownOptions;
use super::quantities::Quantities;
use super::result::ReplayResult;
use super::unsaid_zero;
use crate::log::{Format, Log, Unit};
use crate::rounding::{own_digits, plus_minus};

/// Plausible static coefficients on ice; a value outside them suggests a wrong unit or weight.
const FRICTION: std::ops::RangeInclusive<f32> = 0.004..=20.0;
/// Recurrence in samples below which a slip may be an alias of several faster ones.
const FAST: f64 = 16.0;

/// The doubts, one sentence each.
#[must_use]
pub fn doubts(
    log: &Log,
    (config, known): (&Config, &KnownOptions),
    report: &Report,
    result: &ReplayResult,
) -> Vec<String> {
    let doubts = [
        no_friction(log, config, report),
        choice(report, &result.events),
        alias(log, config, report),
        // A cable that sags has two stiffnesses.
        other_stiffness(&result.quantities).filter(|_| !result.sags()),
        unsaid_zero::warning(result, report.zero_std_n.into())
            .filter(|_| !known.says_zero(&log.metadata().known)),
    ];
    let doubts = doubts.into_iter().flatten();
    let instead = given::instead(log, config, known);
    let none = no_force(log, config, report).or_else(|| cut_off(log, config, report));
    none.into_iter().chain(instead).chain(doubts).collect()
}

/// Why there are no events: no usable force, or no slip that the noise would not hide.
pub(super) fn why_no_event(result: &ReplayResult) -> String {
    let log = &result.log;
    if has_no_force(log.samples, log.rejected, log.saturated) {
        return "no sample of this log can be used".to_string();
    }
    let least_n = result.noise_n.map(|noise_n| f64::from(FIRST_DROP) * noise_n);
    let hidden = least_n.map_or_else(String::new, |least_n| {
        format!(
            "; one that falls by less than {} N, {FIRST_DROP} times the noise, hides in it",
            own_digits(least_n)
        )
    });
    format!("no slip was found in this log{hidden}")
}

/// Whether a record has samples and none of them is a force.
pub(super) fn has_no_force(samples: u64, rejected: u64, saturated: u64) -> bool {
    samples > 0 && rejected + saturated == samples
}

/// No sample can be used.
fn no_force(log: &Log, config: &Config, report: &Report) -> Option<String> {
    let Counters { samples, rejected, saturated, .. } = report.counters;
    has_no_force(samples.into(), rejected.into(), saturated.into()).then(|| {
        format!(
            "no sample is a force: {rejected} of {samples} are no number, {saturated} lie at the end \
             of the cell's range{}",
            range(log, config)
        )
    })
}

fn range(log: &Log, config: &Config) -> String {
    const MIDDLE: i32 = 1 << 23;
    let (low, high) = config.calibration.range_counts;
    match config.range_n {
        Some(range_n) => format!(" of {range_n} N, its 'range_n'"),
        None if log.unit() == Unit::Counts && log.format() != Format::Floe && high < MIDDLE => {
            format!(
                " or the converter's ({low} to {high}; subtract {MIDDLE} from codes that have their zero near it)"
            )
        }
        None => String::new(),
    }
}

/// No slip gives a coefficient, and many samples are saturated.
fn cut_off(log: &Log, config: &Config, report: &Report) -> Option<String> {
    /// Share of saturated samples that is reported: one in 100.
    const MANY: u32 = 100;
    let Counters { samples, saturated, .. } = report.counters;
    let many = saturated > 0 && saturated >= samples / MANY;
    (many && report.mu_s.is_none() && report.mu.is_none()).then(|| {
        format!(
            "{saturated} of {samples} samples lie at the end of the cell's range{}: the tops of the \
             slips may hide there, and no such slip gives a coefficient",
            range(log, config)
        )
    })
}

/// The static coefficient is implausible: force and weight differ by orders of magnitude.
fn no_friction(log: &Log, config: &Config, report: &Report) -> Option<String> {
    let mu_s = report.mu_s?.mean;
    if FRICTION.contains(&mu_s.abs()) {
        return None;
    }
    Some(format!(
        "mu_s {mu_s:.2e} is hardly friction: is the force in {}, and the weight {:.1} N?",
        log.unit().name(),
        config.weight_n
    ))
}

/// The stiffnesses from the winch speed and from the weight contradict each other.
fn other_stiffness(quantities: &Quantities) -> Option<String> {
    let (ratio, std) = quantities.stiffness_ratio.zip(quantities.stiffness_ratio_std)?;
    let suspects = quantities.check()?.suspects()?;
    let ratio = plus_minus(ratio, std);
    Some(format!(
        "the stiffness from the winch speed is {ratio} of that from omega and the weight: {suspects}"
    ))
}

/// Which events have no coefficients may depend on their friction: most have none, or tops beyond the
/// range are hidden.
fn choice(report: &Report, events: &Events) -> Option<String> {
    let (all, read) = (report.events, report.mu_s.or(report.mu)?.events);
    let cut_off = report.counters.saturated > 0 && events.counts.refused_for(Reason::Hidden) > 0;
    let others = match cut_off {
        true => {
            "the tops of others may lie beyond the range: then mu_s is that of the slips below the limit, \
             a lower bound"
        }
        false => "the friction of the others may be another",
    };
    (cut_off || 2 * read < all).then(|| {
        format!(
            "{read} of {all} events have coefficients: the means are those of a choice, and {others}"
        )
    })
}

/// Slips that may be aliases of faster ones, where the speed of the winch is not known.
fn alias(log: &Log, config: &Config, report: &Report) -> Option<String> {
    let samples = f64::from(report.recurrence_s?) * log.rate_hz();
    (config.winch_m_per_s.is_none() && report.mu_s.is_some() && samples < FAST).then(|| {
        format!(
            "a slip every {samples:.1} samples may be the alias of faster ones: only the speed of the \
             winch would tell, --winch-m-per-s V"
        )
    })
}
