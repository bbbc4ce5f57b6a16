//! The rate of samples of which several share a stamp.

use crate::error::InputError;

use super::timing::{DEFAULT_RATE_HZ, Shared, Timing, median};

/// Timing with several samples per stamp: samples per group divided by the step of the stamps.
///
/// # Errors
/// No stamp has all its samples within the rows.
pub(super) fn shared(
    times: &[f64],
    step_s: f64,
    rate_hz: Option<f64>,
    resolution_s: Option<f64>,
) -> Result<Timing, InputError> {
    let whole = Groups::whole(times, step_s);
    let rate_hz = match (rate_hz, whole.rate_hz()) {
        (Some(rate_hz), _) | (None, Some(rate_hz)) => rate_hz,
        (None, None) if resolution_s.is_some_and(|step_s| may_be_default(times, step_s)) => {
            DEFAULT_RATE_HZ
        }
        (None, None) => {
            return Err(InputError::new(format!(
                "stamps that stand still for up to {step_s} s do not tell the rate: give --rate-hz R"
            )));
        }
    };
    let step = step_s * rate_hz;
    Ok(Timing {
        rate_hz,
        start_s: times.first().copied().unwrap_or(0.0),
        shared: Some(Shared { step, centre: centre(times, step, rate_hz) }),
    })
}

/// Whether no stamp has more samples than at the default rate.
#[allow(clippy::float_cmp)] // a stamp that is repeated is repeated exactly
fn may_be_default(times: &[f64], step_s: f64) -> bool {
    times.chunk_by(|a, b| a == b).all(|group| group.len() as f64 <= step_s * DEFAULT_RATE_HZ)
}

/// Rows per stamp and steps of the stamps, without the first and last stamp and those next to a
/// gap.
#[derive(Default)]
struct Groups {
    sizes: Vec<f64>,
    steps_s: Vec<f64>,
}

impl Groups {
    fn whole(times: &[f64], step_s: f64) -> Self {
        let mut groups = Self::default();
        let mut begun: Option<usize> = None;
        for (at, w) in times.windows(2).enumerate() {
            let [a, b] = w else { continue };
            let step = b - a;
            if step > 0.0 {
                let whole = step < 1.5 * step_s;
                if let (Some(first), true) = (begun, whole) {
                    groups.sizes.push((at + 1 - first) as f64);
                    groups.steps_s.push(step);
                }
                begun = whole.then_some(at + 1);
            }
        }
        groups
    }

    /// Mean size of the groups (or the most frequent size if near) divided by the mean step;
    /// rounded to an integer within the uncertainty from the first and last step.
    fn rate_hz(self) -> Option<f64> {
        const NEAR: f64 = 0.03;
        let count = self.sizes.len() as f64;
        let (mean, span_s) =
            (self.sizes.iter().sum::<f64>() / count, self.steps_s.iter().sum::<f64>());
        let median = median(self.sizes)?;
        let size = if (mean - median).abs() < NEAR * median { median } else { mean };
        let rate_hz = size * count / span_s;
        let open = NEAR.min(2.0 / count);
        let near = (rate_hz - rate_hz.round()).abs() < open * rate_hz;
        Some(if near { rate_hz.round() } else { rate_hz })
    }
}

/// Mean of stamp minus sample time over a group, for the first groups.
fn centre(times: &[f64], step: f64, rate_hz: f64) -> f64 {
    const GROUPS: usize = 9;
    let start = times.first().copied().unwrap_or(0.0);
    let begins = |(i, w): (usize, &[f64])| match w {
        [a, b] if b > a => Some((b - start) * rate_hz - (i + 1) as f64),
        _ => None,
    };
    let offsets = times.windows(2).enumerate().filter_map(begins).take(GROUPS).collect();
    median(offsets).unwrap_or(0.0) - (step - 1.0) / 2.0
}
