//! Stretches of a record that are no events: a constant force, and what was not understood.
//!
//! A cable that is tightened and held and a block that slides evenly give the same constant force:
//! only knowledge of the winch distinguishes them.

mod steady_force;

use crate::detector::LONGEST_GAP;
use crate::event::{Event, Reason};
use crate::num::math;
use crate::sample::{ForcePoint, SampleTime};
use steady_force::{Steady, SteadyForce};

/// Largest scatter of a constant force's samples, parts of the weight: more of it hides slips.
const LARGEST_SCATTER: f32 = 0.06;
/// Largest scatter of a constant force that has to rise before a slip: more may be slips.
const QUIET_SCATTER: f32 = 0.01;

/// A stretch of samples that belongs to no event.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stretch {
    /// Its first moment.
    pub start: SampleTime,
    /// Its last moment.
    pub stop: SampleTime,
    /// What the stretch was.
    pub kind: StretchKind,
}

/// What a [`Stretch`] was.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum StretchKind {
    /// A constant force.
    Steady {
        /// Mean force over the weight.
        force_over_weight: f32,
        /// One standard deviation of that mean, from the scatter of the means of blocks.
        std: f32,
        /// Whether the block moved, as the winch turned or was held. `None` if that is unknown: the
        /// force alone cannot distinguish a held block from a sliding one.
        moving: Option<bool>,
    },
    /// Falls of the force that are no slips, or samples that scatter too much.
    NotUnderstood(Reason),
}

/// Finds stretches and gives them in order, one a step.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct Stretches {
    steady: SteadyForce,
    weight_n: f32,
    moving: Option<bool>,
    /// The newest stretch that was not understood, while it may grow.
    open: Option<Stretch>,
    /// The first index after the newest gap.
    resumed: u32,
    /// First and last moment of the newest complete stretch.
    handed_out: (SampleTime, SampleTime),
    /// Complete stretches, oldest first.
    ready: [Option<Stretch>; 3],
}

impl Stretches {
    /// For a rate in hertz and a weight, N; `winch` if it is known to turn.
    pub(crate) fn new(rate_hz: f32, weight_n: f32, winch: bool) -> Self {
        let steady = SteadyForce::new(rate_hz);
        Self {
            steady,
            weight_n,
            moving: winch.then_some(true),
            open: None,
            resumed: 0,
            handed_out: Default::default(),
            ready: [None; 3],
        }
    }

    /// Takes a sample; does it end a block?
    #[inline(always)]
    pub(crate) fn take(&mut self, now: ForcePoint) -> bool {
        if now.index.wrapping_sub(self.steady.last.index) > LONGEST_GAP {
            let steady = self.steady.end(now.index);
            self.end_steady(steady);
            self.resumed = now.index;
        }
        let ends = self.steady.take(now);
        if ends {
            let steady = self.steady.end_block(LARGEST_SCATTER * self.weight_n);
            self.end_steady(steady);
        }
        ends
    }

    /// Force, N, that a slip after a constant force has to begin above; `None` without such a
    /// force.
    pub(crate) fn ceiling_n(&self) -> Option<f32> {
        self.steady.ceiling_n(QUIET_SCATTER * self.weight_n)
    }

    /// A slip or a gap ends a constant force, at the index `last` at the latest. `None`: the slip
    /// was found late, in samples taken for a constant force, so there was none.
    pub(crate) fn interrupt(&mut self, last: Option<u32>) {
        let next = self.steady.last.index + 1;
        let steady = self.steady.end(next);
        // A slip begins a little before it is detected.
        if let Some((start, stop, means, scatters)) = steady
            && let Some(last) = last.filter(|&last| last > start)
        {
            self.end_steady(Some((start, stop.min(last), means, scatters)));
        }
    }

    /// The winch turns, or is held, from now on. A constant force ends here and keeps the state
    /// before.
    pub(crate) fn mark_winch(&mut self, turns: bool) {
        self.interrupt(Some(u32::MAX));
        self.moving = Some(turns);
    }

    /// Takes a fall that is no slip.
    pub(crate) fn refuse(&mut self, start: SampleTime, stop: SampleTime, reason: Reason) {
        let kind = StretchKind::NotUnderstood(reason);
        let resumed = self.resumed;
        // A gap belongs to no stretch.
        let goes_on = |open: &Stretch| open.stop.index >= resumed || start.index < resumed;
        match &mut self.open {
            Some(open) if open.kind == kind && goes_on(open) => open.stop = stop,
            _ => {
                self.end_before(start);
                self.open = Some(Stretch { start, stop, kind });
            }
        }
    }

    /// Ends the stretch that was not understood at an onset; drops it if it begins no earlier.
    pub(crate) fn end_before(&mut self, onset: SampleTime) {
        self.open = self.open.filter(|open| open.start.precedes(onset));
        if let Some(open) = self.open.as_mut().filter(|open| onset.precedes(open.stop)) {
            open.stop = onset;
        }
        self.close();
    }

    /// Onset and stop of an event without what overlaps the newest stretch; `None` if all does.
    pub(crate) fn outside(&self, event: &Event) -> Option<(SampleTime, SampleTime)> {
        let Event { onset, stop, .. } = *event;
        let (from, to) = self.handed_out;
        if !(from.precedes(stop) && onset.precedes(to)) {
            Some((onset, stop))
        } else if to.precedes(stop) {
            Some((to, stop))
        } else {
            onset.precedes(from).then_some((onset, from))
        }
    }

    /// First and last moment of the newest complete stretch; both are zero before the first.
    pub(crate) fn newest(&self) -> (SampleTime, SampleTime) {
        self.handed_out
    }

    /// Completes the stretch that was not understood.
    pub(crate) fn close(&mut self) {
        if let Some(open) = self.open.take() {
            self.push(open);
        }
    }

    /// The oldest complete stretch.
    pub(crate) fn next(&mut self) -> Option<Stretch> {
        // For most samples there is none, and nothing is moved.
        self.ready[0]?;
        let [first, second, last] = self.ready;
        self.ready = [second, last, None];
        first
    }

    fn end_steady(&mut self, steady: Option<Steady>) {
        let Some((start, stop, means, scatters)) = steady else { return };
        let [start, stop] = [start, stop].map(|index| SampleTime { index, fraction: 0.0 });
        if scatters {
            let goes_on = |open: &mut Stretch| open.stop.index + 1 >= start.index;
            if !self.open.as_mut().is_some_and(goes_on) {
                self.close();
            }
            return self.refuse(start, stop, Reason::Scatters);
        }
        self.close();
        let count = means.count as f32;
        let squares_n2 = means.residual_n2 + means.slope * means.slope * means.slope_weight;
        let std = math::sqrt(squares_n2 / (count * (count - 1.0))) / self.weight_n;
        let force_over_weight = means.level_n / self.weight_n;
        let kind = StretchKind::Steady { force_over_weight, std, moving: self.moving };
        self.push(Stretch { start, stop, kind });
    }

    /// Adds a complete stretch. There is room: a step completes at most a constant force, the
    /// stretch that was open before it and one of an event, and gives one.
    fn push(&mut self, mut stretch: Stretch) {
        if stretch.start.precedes(self.handed_out.1) {
            stretch.start = self.handed_out.1;
        }
        if !stretch.start.precedes(stretch.stop) {
            return;
        }
        self.handed_out = (stretch.start, stretch.stop);
        if let Some(place) = self.ready.iter_mut().find(|place| place.is_none()) {
            *place = Some(stretch);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_begins_with_its_first_sample() {
        for first in [0, 1, 5, LONGEST_GAP, 1000] {
            let mut stretches = Stretches::new(16.0, 630.0, false);
            for index in first..first + 160 {
                let force_n = 300.0 + (index % 3) as f32;
                stretches.take(ForcePoint { index, force_n });
            }
            stretches.interrupt(Some(u32::MAX));
            assert_eq!(stretches.next().map(|it| it.start.index), Some(first));
        }
    }

    #[test]
    fn falls_of_one_reason_are_one_stretch_except_across_a_gap() {
        let mut stretches = Stretches::new(16.0, 630.0, false);
        let moment = |index| SampleTime { index, fraction: 0.0 };
        for start in [20, 60, 1_000_020, 1_000_060] {
            stretches.take(ForcePoint { index: start, force_n: start as f32 });
            stretches.refuse(moment(start), moment(start + 9), Reason::WoundBack);
            (start + 1..start + 40).step_by(8).for_each(|index| {
                stretches.take(ForcePoint { index, force_n: 0.0 });
            });
        }
        stretches.close();
        let seen: [_; 3] = core::array::from_fn(|_| stretches.next());
        let seen = seen.map(|it| it.map(|it| (it.start.index, it.stop.index)));
        assert_eq!(seen, [Some((20, 69)), Some((1_000_020, 1_000_069)), None]);
    }
}
