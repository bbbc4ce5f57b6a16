//! The coefficient and its standard error after the first event, after the
//! second, ...

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

/// The mean of DerSimonian and Laird (Controlled Clinical Trials 7 (1986) 177):
/// weights from each event's variance plus the variance between events.
pub(super) fn mean_of(values: &[Measured]) -> Option<Running> {
    let (first, last) = (values.first()?, values.last()?);
    let between = between_variance(values, first.value);
    let sums = weighted(values, first.value, between);
    Some(Running {
        event: last.event,
        mean: first.value + sums.x / sums.w,
        std_error: (1.0 / sums.w).sqrt(),
    })
}

/// Sums over the events: weights, their squares, weighted values and squares.
struct Sums {
    w: f64,
    ww: f64,
    x: f64,
    xx: f64,
}

fn weighted(values: &[Measured], shift: f64, between: f64) -> Sums {
    let mut sums = Sums { w: 0.0, ww: 0.0, x: 0.0, xx: 0.0 };
    for value in values {
        let weight = 1.0 / (value.std.powi(2) + between).max(f64::MIN_POSITIVE.sqrt());
        let x = value.value - shift;
        sums.w += weight;
        sums.ww += weight * weight;
        sums.x += weight * x;
        sums.xx += weight * x * x;
    }
    sums
}

fn between_variance(values: &[Measured], shift: f64) -> f64 {
    let sums = weighted(values, shift, 0.0);
    let excess = sums.xx - sums.x * sums.x / sums.w - (values.len() as f64 - 1.0);
    let scale = sums.w - sums.ww / sums.w;
    if scale > 0.0 { (excess / scale).max(0.0) } else { 0.0 }
}

/// At most [`MOST`] results on the way, and the replay's own at the end.
pub(super) fn course(values: &[Measured], end: &CoefficientSummary) -> Vec<Running> {
    let step = values.len().div_ceil(MOST).max(1);
    let counts = (1..values.len()).step_by(step).chain([values.len()]);
    let mut course: Vec<Running> = counts.filter_map(|n| mean_of(values.get(..n)?)).collect();
    if let (Some(last), Some(mean), Some(std_error)) = (course.last_mut(), end.mean, end.std_error)
    {
        *last = Running { event: last.event, mean, std_error };
    }
    course
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(list: &[(f64, f64)]) -> Vec<Measured> {
        let measured =
            |(i, &(value, std)): (usize, &(f64, f64))| Measured { event: i as f64, value, std };
        list.iter().enumerate().map(measured).collect()
    }

    #[test]
    fn equal_errors_without_spread_give_the_plain_mean() {
        let result = mean_of(&values(&[(1.0, 0.1), (1.02, 0.1), (0.98, 0.1)])).unwrap();
        assert!((result.mean - 1.0).abs() < 1e-12);
        assert!((result.std_error - 0.1 / 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn spread_beyond_the_errors_widens_the_result() {
        // Errors far below the spread: the classic standard error of the mean.
        let result = mean_of(&values(&[(1.0, 1e-6), (2.0, 1e-6), (3.0, 1e-6)])).unwrap();
        assert!((result.mean - 2.0).abs() < 1e-9);
        assert!((result.std_error - 1.0 / 3f64.sqrt()).abs() < 1e-6, "{result:?}");
    }

    #[test]
    fn odd_inputs_stay_finite() {
        assert!(mean_of(&[]).is_none());
        for list in [&[(1.0, 0.0)][..], &[(1.0, 0.0), (1.0, 0.0)], &[(1.0, 0.0), (2.0, 0.1)]] {
            let result = mean_of(&values(list)).unwrap();
            assert!(result.mean.is_finite() && result.std_error.is_finite(), "{result:?}");
        }
    }

    #[test]
    fn the_course_is_bounded_and_ends_in_the_result() {
        let many: Vec<_> = (0..5000).map(|i| (1.0 + f64::from(i % 7) / 100.0, 0.01)).collect();
        let end = CoefficientSummary { mean: Some(1.5), std_error: Some(0.2), spread: None };
        let course = course(&values(&many), &end);
        assert!(course.len() <= MOST + 1);
        let last = course[course.len() - 1];
        assert_eq!((last.event, last.mean, last.std_error), (4999.0, 1.5, 0.2));
    }
}
