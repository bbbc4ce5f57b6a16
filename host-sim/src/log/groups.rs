//! The rate of samples of which several share a stamp.

use crate::error::InputError;

use super::fine::Line;
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
    let mean_s = whole.step_s(step_s);
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
    let step = mean_s * rate_hz;
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

    /// The mean step where the steps are rounded (15 and 16 ms of 15.625), else `usual_s`.
    fn step_s(&self, usual_s: f64) -> f64 {
        const ROUNDED: f64 = 1e-3;
        let mean_s = self.steps_s.iter().sum::<f64>() / self.steps_s.len() as f64;
        if (mean_s / usual_s - 1.0).abs() > ROUNDED { mean_s } else { usual_s }
    }

    /// That of groups whose sizes differ evenly, or else the mean size of the groups (or the most
    /// frequent size if near) divided by the mean step; rounded to an integer within the
    /// uncertainty from the first and last step.
    fn rate_hz(self) -> Option<f64> {
        const NEAR: f64 = 0.03;
        let count = self.sizes.len() as f64;
        let (rows, span_s) = (self.sizes.iter().sum::<f64>(), self.steps_s.iter().sum::<f64>());
        let usual = median(self.sizes.clone())?;
        let mean = rows / count;
        let size = if (mean - usual).abs() < NEAR * usual { usual } else { mean };
        let (rate_hz, open) = match self.even_hz(usual) {
            Some(rate_hz) => (rate_hz, rows.recip()),
            None => (size * count / span_s, NEAR.min(2.0 / count)),
        };
        let near = (rate_hz - rate_hz.round()).abs() < open * rate_hz;
        Some(if near { rate_hz.round() } else { rate_hz })
    }

    /// The rate of samples that no stamp divides evenly: 128 a second in tenths, in groups of 12
    /// and 13. Every stamp then lies within one period of a line, as after random losses none does.
    #[allow(clippy::float_cmp)] // whole numbers
    fn even_hz(&self, usual: f64) -> Option<f64> {
        /// Fewest groups of another size; tuned, as is the limit: of 7000 records with random
        /// losses 4 pass.
        const ENOUGH: usize = 6;
        const WITHIN: f64 = 1.25;
        if self.sizes.iter().filter(|&&size| size != usual).count() < ENOUGH {
            return None;
        }
        let from_zero = |steps: &[f64]| -> Vec<f64> {
            let sums = steps.iter().scan(0.0, |sum, step| {
                *sum += step;
                Some(*sum)
            });
            std::iter::once(0.0).chain(sums).collect()
        };
        let (rows, times) = (from_zero(&self.sizes), from_zero(&self.steps_s));
        let mut line = Line { start_s: 0.0, period_s: 0.0 };
        line.fit_to(&times, |at, _| rows.get(at).copied().unwrap_or_default());
        let off = rows.iter().zip(&times).map(|(row, time_s)| time_s / line.period_s - row);
        let ends = off.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), off| {
            (off.min(low), off.max(high))
        });
        (ends.1 - ends.0 < WITHIN).then_some(line.period_s.recip())
    }
}

/// Mean of stamp minus sample time over a group, for the first groups: the mean of the middle two,
/// since halves rounded to even seconds make groups of 17 and 15 in turn.
fn centre(times: &[f64], step: f64, rate_hz: f64) -> f64 {
    const GROUPS: usize = 8;
    let start = times.first().copied().unwrap_or(0.0);
    let begins = |(i, w): (usize, &[f64])| match w {
        [a, b] if b > a => Some((b - start) * rate_hz - (i + 1) as f64),
        _ => None,
    };
    let mut offsets: Vec<f64> =
        times.windows(2).enumerate().filter_map(begins).take(GROUPS).collect();
    offsets.sort_by(f64::total_cmp);
    let middle = |less: usize| offsets.get(offsets.len().saturating_sub(less) / 2);
    let both = middle(0).zip(middle(1));
    both.map_or(0.0, |(a, b)| f64::midpoint(*a, *b)) - (step - 1.0) / 2.0
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // rounded to a whole number
mod tests {
    use super::*;

    fn rate_hz(times: impl Iterator<Item = f64>) -> f64 {
        shared(&times.collect::<Vec<f64>>(), 0.1, None, None).unwrap().rate_hz
    }

    fn tenths(rate_hz: f64, rows: u32) -> impl Iterator<Item = f64> {
        (0..rows).map(move |row| (f64::from(row) / rate_hz * 10.0 + 1e-9).floor() / 10.0)
    }

    #[test]
    fn a_rate_that_no_stamp_divides_is_found() {
        for own in [12.5, 31.25, 62.5, 98.0, 99.0, 101.0, 128.0, 197.0, 256.0] {
            let found = rate_hz(tenths(own, 4096));
            assert!((found / own - 1.0).abs() < 1.5 / 4096.0, "{own} {found}");
        }
        assert_eq!(rate_hz(tenths(128.0, 600)), 128.0);
    }

    #[test]
    fn losses_do_not_lower_the_rate() {
        let lost = |row: usize| row.wrapping_mul(2_654_435_761) % 1009 < 10;
        let left = tenths(100.0, 4096).enumerate().filter(|(row, _)| !lost(*row));
        assert_eq!(rate_hz(left.map(|(_, time_s)| time_s)), 100.0);
    }
}
