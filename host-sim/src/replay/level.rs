//! The change of friction: both coefficients after the newest change that is not of the block
//! alone, over those before it, as means of the events that are kept.

use std::ops::Range;

use floe_core::Coefficient;
use floe_core::estimator::Estimator;

use super::result::{ChangeSummary, EventSummary, ParameterSummary};

/// Getter for a coefficient of an event and its random standard deviation.
type Known = fn(&EventSummary) -> (Option<f64>, Option<f64>);

/// Ratios of `mu_s` and `mu`, each only where both sides of the change have at least two events.
pub fn parameters(changes: &[ChangeSummary], events: &[EventSummary]) -> Vec<ParameterSummary> {
    let Some(place) = changes.iter().rposition(|it| it.cause != "mass") else {
        return Vec::new();
    };
    let start = |place: usize| changes.get(place).map(|it| it.event);
    let before = place.checked_sub(1).and_then(start).unwrap_or(0);
    let (now, after) = (start(place).unwrap_or(0), start(place + 1).unwrap_or(u32::MAX));
    let mean = |known: Known, range: Range<u32>| {
        let mut estimator = Estimator::default();
        for event in events.iter().filter(|it| range.contains(&it.index)) {
            if let (Some(value), Some(std)) = known(event) {
                estimator.add(Coefficient::random(value as f32, std as f32));
            }
        }
        let mean = estimator.estimate()?;
        Some((f64::from(mean.mean), f64::from(mean.std_error?)))
    };
    let ratio = |name, known: Known| {
        let (from, to) = (mean(known, before..now)?, mean(known, now..after)?);
        let value = to.0 / from.0;
        let std = value.abs() * (to.1 / to.0).hypot(from.1 / from.0);
        std.is_finite().then_some(ParameterSummary { name, value, std })
    };
    let ratios = [
        ratio("mu_s_ratio", |it| (it.mu_s, it.mu_s_std)),
        ratio("mu_ratio", |it| (it.mu, it.mu_std)),
    ];
    ratios.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(event: u32, cause: &'static str) -> ChangeSummary {
        let (weight_ratio, weight_ratio_std) = (1.0, 0.0);
        ChangeSummary { event, onset_s: 0.0, cause, weight_ratio, weight_ratio_std }
    }

    fn events(count: u32, mu_s: impl Fn(u32) -> f64) -> Vec<EventSummary> {
        let event = |index| EventSummary {
            index,
            mu_s: Some(mu_s(index) * (1.0 + 0.01 * f64::from(index % 3))),
            mu_s_std: Some(0.001),
            ..EventSummary::default()
        };
        (0..count).map(event).collect()
    }

    /// The ratio compares the levels next to the change, not that before an earlier change.
    #[test]
    fn the_ratio_is_that_of_the_levels_on_either_side() {
        let level = |index| match index {
            0..12 => 3.0,
            12..42 => 1.2,
            42..72 => 1.02,
            _ => 0.5,
        };
        let changes = [change(12, "unknown"), change(42, "friction"), change(72, "mass")];
        let [ratio] = parameters(&changes, &events(84, level)).try_into().unwrap();
        assert_eq!(ratio.name, "mu_s_ratio");
        assert!((ratio.value - 0.85).abs() < 3.0 * ratio.std, "{ratio:?}");
        assert!((0.001..0.006).contains(&ratio.std), "{ratio:?}");
    }

    #[test]
    fn one_event_tells_no_level() {
        let changes = [change(9, "friction")];
        assert!(parameters(&changes, &events(10, |_| 1.0)).is_empty());
        assert!(parameters(&[change(5, "mass")], &events(10, |_| 1.0)).is_empty());
        assert!(parameters(&[], &events(10, |_| 1.0)).is_empty());
    }
}
