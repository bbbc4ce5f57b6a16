//! Events that contradict the expectations: a winch that stood, misfits and other rates in a row.

use crate::cycle::expectations::Expectations;
use crate::cycle::refusal::{FAST, is_no_chance};
use crate::effect::Kept;
use crate::effects::mass_change::Mass;
use crate::model::CycleParams;
use crate::stats::fading_trend::FadingTrend;
use crate::stats::in_a_row::InARow;

/// Ratio of a swing to that by winch and weight, above which the winch may have stood while the
/// cable hung slack: other troubles lower omega by up to an eighth.
const SLOWER: f32 = 1.15;

impl Expectations {
    /// Did the winch stand while the cable hung slack? The fit takes the longer time without force
    /// for that of a slower block: its swing, with this variance, is far above that by winch and
    /// weight. Asked until the swing is known, for then [`Slackness`] knows the usual time. A cell
    /// that lags has the same effect, but on every event: the third in a row is believed. Slips
    /// that look slow and follow each other fast, the next at the time `next`, may be aliases.
    ///
    /// [`Slackness`]: crate::cycle::refusal::Slackness
    pub(crate) fn stood_slack(&mut self, cycle: &CycleParams, variance: f32, next: f32) -> bool {
        if self.knows_omega() || cycle.is_taut() || next - cycle.onset < FAST {
            return false;
        }
        let usual = SLOWER * self.swing_by_winch(cycle.rate);
        let stood = is_no_chance((cycle.inverse_omega() - usual, variance));
        !self.stood.take(stood) && stood
    }

    /// Counts the events in a row that contradict the expectations: misfits, and events whose rate
    /// is another, as after a winch that took long to come up to speed. With the third of them the
    /// expectations no longer hold and are reset.
    pub(crate) fn contradict(&mut self, contradicts: bool) {
        if self.contradictions.take(contradicts) {
            self.contradictions = InARow::default();
            [self.rate, self.rate_change, self.inverse_omega] = [FadingTrend::default(); 3];
            self.mass.update(Mass::forget);
            self.corner = Kept::default();
            self.sag = Kept::default();
        }
    }
}
