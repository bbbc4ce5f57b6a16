//! Initial values for the fit of a slip: the cycle of the first answer, or a guess from the
//! extremes.

use crate::cycle::slip_record::{PI, SlipRecord};
use crate::fit::{Data, Fitting};
use crate::model::CycleParams;
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Lengths of a slip that are tried, besides the time from its highest to its lowest sample, as
/// parts of that time: each is a quarter to a third longer than the one before.
const OTHERS: [f32; 4] = [0.6, 0.8, 1.25, 1.6];

/// Most samples by which guesses are compared: a slip with more than one of them lasts at most five
/// periods.
pub(crate) const GUESSED: usize = 10;

impl SlipRecord {
    /// Can a fit begin at the cycle of the first answer? Not on a slack cable: without the line
    /// after the slip the first answer is then hardly determined.
    pub(crate) fn begins_again(&self, after: &Line) -> bool {
        self.early.is_some() && self.slack(after).is_none()
    }

    /// Begins a fit at the cycle of the first answer, if possible.
    pub(crate) fn begin_again(&self, after: &Line) -> Option<Fitting> {
        let early = self.early.filter(|_| self.begins_again(after));
        early.map(|early| Fitting::new(&early))
    }

    /// Begins a fit at a guess that lies on the line before and goes through the point half-way
    /// down. Its swing is the prior's, or, without one, that of the best of a few lengths.
    pub(crate) fn guess(&self, data: &Data<'_>, known_swing: bool) -> Fitting {
        let middle_n = 0.5 * (self.peak.force_n + self.low.force_n);
        let slack = self.slack(data.after);
        let centre_n = slack.map_or(middle_n, |slack| slack.centre_n);
        let (swing, rate) = (data.priors.inverse_omega.mean, data.priors.rate.mean);
        if known_swing {
            let guess = self.with_swing(swing, rate, centre_n);
            return Fitting::new(&self.through_samples(guess));
        }
        let fall = self.fall() / slack.map_or(1.0, |slack| slack.part);
        let with_part = |part: f32| {
            let slide = larger(part * fall, 0.5);
            let phase = math::atan2(rate * slide, PI * (self.peak.force_n - centre_n));
            self.with_swing(slide / (PI + 2.0 * phase), rate, centre_n)
        };
        let (mut best, mut least_n2) = (with_part(1.0), None);
        // The highest and the lowest sample are each off by half a period at most.
        for part in OTHERS.into_iter().filter(|part| (part - 1.0).abs() * fall <= 1.0) {
            let least = least_n2.get_or_insert_with(|| data.squares_n2(&best.shape(), GUESSED));
            let guess = with_part(part);
            let squares_n2 = data.squares_n2(&guess.shape(), GUESSED);
            if squares_n2 < *least {
                (*least, best) = (squares_n2, guess);
            }
        }
        Fitting::new(&best)
    }

    /// A guess with the given swing, periods, rate and centre, N: it lies on the line before and is
    /// half-way down when the samples are.
    fn with_swing(&self, inverse_omega: f32, rate: f32, centre_n: f32) -> CycleParams {
        let (peak_n, low_n) = (self.peak.force_n, self.low.force_n);
        let half_drop_n = peak_n - centre_n;
        let phase = math::atan2(rate * inverse_omega, half_drop_n);
        let amplitude_n = half_drop_n / math::sin_cos(phase).1;
        let half_way = phase + math::acos((0.5 * (peak_n + low_n) - centre_n) / amplitude_n);
        let onset = self.rough.middle - half_way * inverse_omega;
        let static_n = if self.before.count >= 3 { self.before.at(onset, rate) } else { peak_n };
        let omega = 1.0 / inverse_omega;
        CycleParams { onset, rate, static_n, half_drop_n, omega, rate_change: 0.0 }
    }

    /// Shifts the onset of a guess along the stick line, and changes its drop, so that it goes
    /// through the lowest sample and the one nearest to half-way down.
    fn through_samples(&self, mut cycle: CycleParams) -> CycleParams {
        let shape = cycle.shape();
        let middle = math::floor(self.rough.middle + 0.5);
        let middle_n = self.samples().forces_n.get((middle - self.start) as usize);
        // Residual of a sample, and its derivatives by onset (along the line) and drop.
        let seen = |time: f32, force_n: f32| {
            let (guess_n, [by_onset, _, by_static, by_drop, ..]) = shape.force(time);
            (force_n - guess_n, by_onset + cycle.rate * by_static, by_drop)
        };
        let (low_n, low_by_onset, low_by_drop) = seen(self.low.time, self.low.force_n);
        let (above_n, by_onset, by_drop) = seen(middle, *middle_n.unwrap_or(&f32::NAN));
        let determinant = by_onset * low_by_drop - low_by_onset * by_drop;
        let later = (above_n * low_by_drop - low_n * by_drop) / determinant;
        let drop_n = (low_n * by_onset - above_n * low_by_onset) / determinant;
        // False for NaN as well.
        if later.abs() < 0.5 && drop_n.abs() < 0.5 * cycle.half_drop_n && self.before.count >= 3 {
            cycle.onset += later;
            cycle.static_n += cycle.rate * later;
            cycle.half_drop_n += drop_n;
        }
        cycle
    }
}
