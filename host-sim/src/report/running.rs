//! The coefficient and its standard error after the first event, after the
//! second, ...

use floe_core::Coefficient;
use floe_core::estimator::Estimator;

use crate::replay::result::{CoefficientSummary, EventSummary};

/// One event's value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Number of the event.
    pub event: f64,
    /// The coefficient.
    pub value: f64,
    /// One standard deviation.
    pub std: f64,
}

/// The result after some events.
#[derive(Clone, Copy, Debug)]
pub(super) struct Running {
    /// Number of the last event in it.
    pub event: f64,
    /// Mean.
    pub mean: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// Results drawn at most.
const MOST: usize = 240;

/// The values that count.
pub(super) fn measured(
    events: &[EventSummary],
    pick: impl Fn(&EventSummary) -> (Option<f64>, Option<f64>),
) -> Vec<Measured> {
    let value = |event: &EventSummary| match pick(event) {
        (Some(value), std) => {
            Some(Measured { event: event.index.into(), value, std: std.unwrap_or(0.0) })
        }
        (None, _) => None,
    };
    events.iter().filter_map(value).collect()
}

/// Results on the way, by the core's own estimator: at most [`MOST`], and the
/// replay's at the end.
pub(super) fn course(values: &[Measured], end: &CoefficientSummary) -> Vec<Running> {
    let step = values.len().div_ceil(MOST).max(1);
    let mut estimator = Estimator::default();
    let mut course = Vec::new();
    for (i, value) in values.iter().enumerate() {
        estimator.add(Coefficient { value: value.value as f32, std: value.std as f32 });
        if i % step == 0 || i + 1 == values.len() {
            course.extend(estimator.estimate().map(|estimate| Running {
                event: value.event,
                mean: estimate.mean.into(),
                std_error: estimate.std_error.into(),
            }));
        }
    }
    if let (Some(last), Some(mean), Some(std_error)) = (course.last_mut(), end.mean, end.std_error)
    {
        *last = Running { event: last.event, mean, std_error };
    }
    course
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(count: u32) -> Vec<Measured> {
        let value =
            |i: u32| Measured { event: i.into(), value: 1.0 + f64::from(i % 7) / 100.0, std: 0.01 };
        (0..count).map(value).collect()
    }

    #[test]
    fn the_course_is_bounded_and_ends_in_the_result() {
        let end = CoefficientSummary { mean: Some(1.5), std_error: Some(0.2), spread: None };
        let course = course(&values(5000), &end);
        assert!((MOST / 2..=MOST + 1).contains(&course.len()));
        let last = course[course.len() - 1];
        assert_eq!((last.event, last.mean, last.std_error), (4999.0, 1.5, 0.2));
        assert!((course[0].mean - 1.0).abs() < 1e-6 && (course[0].std_error - 0.01).abs() < 1e-6);
        assert!(course.is_sorted_by(|a, b| a.event < b.event));
    }

    #[test]
    fn no_values_give_no_course() {
        assert!(course(&[], &CoefficientSummary::default()).is_empty());
        assert!(measured(&[], |e| (e.mu, e.mu_std)).is_empty());
    }
}
