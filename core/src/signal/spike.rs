//! One sample far from both its neighbours is a spike.
//!
//! A cable cannot do that: the force never rises faster than the winch stretches it, `F' ≤ k w`,
//! and falls no further than a slip's drop. A sample is therefore held back until the next one, and
//! is a spike when it lies above both its neighbours, or below both, by more than each of ten
//! standard deviations of the noise, three times the usual rise, three times the largest recent
//! rise (a cable that was held has no usual one) and a quarter of the usual drop. Delay: one good
//! sample.

use crate::num::math::{larger, smaller};
use crate::sample::ForcePoint;
use crate::stats::quantile::Quantile;

/// Standard deviations of the noise that a spike exceeds. This limit and the next two are choices:
/// with less the highest sample before a slip is taken for a spike, with more smaller spikes are
/// left in. Half as much again, or about half, changes no class of `docs/honesty.md`.
const NOISES: f32 = 10.0;
/// Part of the usual drop that a spike exceeds.
const PART_OF_DROP: f32 = 0.25;
/// Multiple of the usual and of the largest recent rise per sample that a spike exceeds.
const RISES: f32 = 3.0;
/// Factor by which each rise reduces the largest recent rise: a steeper pull counts for a few
/// samples.
const FADE: f32 = 0.5;
/// Largest distance of the neighbours, periods: those further apart are no measure of a sample.
const LONGEST_SPAN: u32 = 4;

/// Holds one sample back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SpikeFilter {
    before: ForcePoint,
    held: ForcePoint,
    /// How many of these two there are.
    count: u8,
    /// Upper quartile of the rises between neighbours, N.
    rises: Quantile,
    /// The largest recent rise, with forgetting, N.
    last_rise_n: f32,
}

/// What became of the sample held back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Judged {
    /// There was none.
    Nothing,
    /// A good one.
    Good(ForcePoint),
    /// A spike.
    Spike(ForcePoint),
}

impl SpikeFilter {
    /// Takes a sample and judges the one before it, by the standard deviation of the noise, N
    /// (infinite: nothing is a spike yet), and the usual drop of a slip, N.
    pub(crate) fn step(&mut self, sample: ForcePoint, noise_n: f32, drop_n: f32) -> Judged {
        let (before, held) = (self.before, core::mem::replace(&mut self.held, sample));
        if self.count < 2 {
            (self.before, self.count) = (held, self.count + 1);
            return if self.count == 1 { Judged::Nothing } else { Judged::Good(held) };
        }
        let (left, right) = (held.force_n - before.force_n, held.force_n - sample.force_n);
        // Above or below both its neighbours.
        if left * right > 0.0 {
            let least_n = larger(NOISES * noise_n, PART_OF_DROP * drop_n);
            if self.stands_out((left, right), sample.index - before.index, least_n) {
                return Judged::Spike(held);
            }
        }
        self.before = held;
        if left > 0.0 && held.index == before.index + 1 {
            self.rises.add(left, 0.75);
            self.last_rise_n = larger(left, FADE * self.last_rise_n);
        }
        Judged::Good(held)
    }

    /// Gives the last sample: without a next neighbour it is good.
    pub(crate) fn finish(&mut self) -> Option<ForcePoint> {
        let held = (self.count > 0).then_some(self.held);
        self.count = 0;
        held
    }

    /// Is a sample a spike that differs by these forces, N, from its neighbours, `span` periods
    /// apart? By noise and slips a good sample may differ by `least_n`.
    fn stands_out(&self, (left, right): (f32, f32), span: u32, least_n: f32) -> bool {
        if span > LONGEST_SPAN {
            return false;
        }
        let Some(rise_n) = self.rises.value() else { return false };
        let rises = RISES * larger(rise_n, self.last_rise_n) * span as f32 / 2.0;
        smaller(left.abs(), right.abs()) > larger(least_n, rises)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE_N: f32 = 2.0;
    const DROP_N: f32 = 200.0;

    /// Index of the spike after a rise of 10 N a sample to 500 N.
    fn spike_in(forces: [f32; 6], noise_n: f32) -> Option<usize> {
        let mut filter = SpikeFilter::default();
        let rise = (0..20).map(|i| 300.0 + 10.0 * i as f32);
        rise.chain(forces).enumerate().fold(None, |found, (i, force_n)| {
            match filter.step(ForcePoint { index: i as u32, force_n }, noise_n, DROP_N) {
                Judged::Spike(spike) => Some(spike.index as usize - 20),
                Judged::Nothing | Judged::Good(_) => found,
            }
        })
    }

    #[test]
    fn spikes_are_found_and_slips_are_not() {
        for (forces, spike) in [
            ([500.0, 510.0, 900.0, 530.0, 540.0, 550.0], Some(2)),
            ([500.0, 510.0, -1.0, 530.0, 540.0, 550.0], Some(2)),
            ([500.0, 510.0, 300.0, 200.0, 210.0, 220.0], None),
            ([500.0, 510.0, 200.0, 210.0, 220.0, 230.0], None),
            ([500.0, 510.0, 540.0, 530.0, 540.0, 550.0], None),
        ] {
            assert_eq!(spike_in(forces, NOISE_N), spike, "{forces:?}");
        }
    }

    #[test]
    fn the_first_slip_after_a_held_cable_has_no_spikes() {
        let mut filter = SpikeFilter::default();
        // Held, with some noise; pulled; and a slip that shows a single sample at either end.
        let held = (0..200).map(|i| 300.0 + 2.0 * (i % 3) as f32);
        let pulled = (1..4).map(|i| 300.0 + 370.0 * i as f32);
        let slip = [1500.0, 700.0, 200.0, 600.0, 970.0];
        for (i, force_n) in held.chain(pulled).chain(slip).enumerate() {
            let judged = filter.step(ForcePoint { index: i as u32, force_n }, NOISE_N, 0.0);
            assert!(!matches!(judged, Judged::Spike(_)), "{i}");
        }
    }

    #[test]
    fn nothing_is_judged_before_the_noise_is_known() {
        let forces = [500.0, 1e6, 520.0, 530.0, 540.0, 550.0];
        assert_eq!(spike_in(forces, f32::INFINITY), None);
    }

    #[test]
    fn a_steep_saw_has_no_spikes() {
        let mut filter = SpikeFilter::default();
        for i in 0..300 {
            let force_n = 200.0 + 225.0 * (i as f32 * (2.0 / 7.0)).fract() * 3.5;
            let judged = filter.step(ForcePoint { index: i, force_n }, NOISE_N, DROP_N);
            assert!(!matches!(judged, Judged::Spike(_)), "{i}");
        }
    }
}
