//! Coefficient and uncertainty after each event, as the core computed them at that time.

use crate::replay::result::{CoefficientSummary, EventSummary};

/// Value of one event.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Number of the event.
    pub event: f64,
    /// The coefficient.
    pub value: f64,
    /// One standard deviation, the random part.
    pub std: f64,
}

/// The result after some events.
#[derive(Clone, Copy, Debug)]
pub(super) struct Running {
    /// Number of the last event in it.
    pub event: f64,
    /// Mean.
    pub mean: f64,
    /// Combined standard deviation of the mean, and its 95 % interval; `None` after one event.
    pub band: Option<(f64, [f64; 2])>,
}

/// Results drawn at most.
const MOST: usize = 240;

/// The values of the events that count.
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

/// Results after some of the events, at most [`MOST`], and the last one.
pub(super) fn course<'a>(
    means: impl ExactSizeIterator<Item = &'a CoefficientSummary>,
    events: &[EventSummary],
) -> Vec<Running> {
    let count = means.len();
    let step = count.div_ceil(MOST).max(1);
    let known = means.zip(events).enumerate().filter(|(i, _)| i % step == 0 || i + 1 == count);
    let running = |(_, (mean, event)): (usize, (&CoefficientSummary, &EventSummary))| {
        let band = mean.combined_std.zip(mean.ci95);
        Some(Running { event: event.index.into(), mean: mean.mean?, band })
    };
    known.filter_map(running).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn the_course_is_bounded_and_ends_in_the_result() {
        let result = SampleLog::dff8_13(1800.0).result;
        let course = course(result.events.means.iter().map(|m| &m[0]), &result.events);
        assert!((MOST / 2..=MOST + 1).contains(&course.len()));
        let last = course[course.len() - 1];
        assert_eq!(Some(last.mean), result.estimate.mu_s.mean);
        assert!(course[0].band.is_none() && last.band.is_some());
        assert!(course.is_sorted_by(|a, b| a.event < b.event));
    }

    #[test]
    fn no_values_give_no_course() {
        assert!(course([].iter(), &[]).is_empty());
        assert!(measured(&[], |e| (e.mu, e.mu_std)).is_empty());
    }
}
