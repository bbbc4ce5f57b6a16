//! One sample far from both its neighbours is a spike.
//!
//! A cable cannot do that: the force never rises faster than the winch stretches
//! it, `F' ≤ k w`, and falls no further than a slip's drop. A sample is therefore
//! held back by one period and left out when it stands out against the one before
//! and the one after, both on the same side, by more than the noise, the usual rise
//! and a part of the usual drop. Delay: one good sample.

use crate::detector::Extreme;

/// Standard deviations of the noise that a spike exceeds.
const NOISES: f32 = 10.0;
/// Part of the usual drop that a spike exceeds.
const PART_OF_DROP: f32 = 0.25;
/// Usual rises per sample that a spike exceeds.
const RISES: f32 = 3.0;

/// What the filter needs to know of the force.
#[derive(Clone, Copy, Debug)]
pub struct Usual {
    /// Standard deviation of the noise, N; `None`: nothing is a spike yet.
    pub noise_n: Option<f32>,
    /// Usual drop of a slip, N.
    pub drop_n: f32,
    /// Usual rise in one period, N.
    pub rise_n: f32,
}

/// Holds one sample back.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpikeFilter {
    before: Option<Extreme>,
    held: Option<Extreme>,
}

/// What became of the sample held back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judged {
    /// There was none.
    Nothing,
    /// A good one.
    Good(Extreme),
    /// A spike.
    Spike(Extreme),
}

impl SpikeFilter {
    /// Takes a sample and gives the one before it.
    pub fn step(&mut self, sample: Extreme, usual: &Usual) -> Judged {
        let Some(held) = self.held.replace(sample) else { return Judged::Nothing };
        if self.before.is_some_and(|before| stands_out(before, held, sample, usual)) {
            return Judged::Spike(held);
        }
        self.before = Some(held);
        Judged::Good(held)
    }

    /// Gives the last sample: without a neighbour it is good.
    pub fn finish(&mut self) -> Option<Extreme> {
        self.held.take()
    }
}

fn stands_out(before: Extreme, held: Extreme, after: Extreme, usual: &Usual) -> bool {
    let Some(noise_n) = usual.noise_n else { return false };
    // Neighbours further away say less: only within a few periods.
    let span = after.index - before.index;
    if span > 4 {
        return false;
    }
    let (left, right) = (held.force_n - before.force_n, held.force_n - after.force_n);
    let least = (NOISES * noise_n)
        .max(PART_OF_DROP * usual.drop_n)
        .max(RISES * usual.rise_n * span as f32 / 2.0);
    left * right > 0.0 && left.abs().min(right.abs()) > least
}

#[cfg(test)]
mod tests {
    use super::*;

    const USUAL: Usual = Usual { noise_n: Some(2.0), drop_n: 200.0, rise_n: 10.0 };

    fn judged<const N: usize>(forces: [f32; N], usual: &Usual) -> [bool; N] {
        let mut filter = SpikeFilter::default();
        let mut spikes = [false; N];
        for (i, force_n) in forces.into_iter().enumerate() {
            if let Judged::Spike(s) = filter.step(Extreme { index: i as u64, force_n }, usual) {
                spikes[s.index as usize] = true;
            }
        }
        spikes
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
            let found = judged(forces, &USUAL);
            for (i, is_spike) in found.into_iter().enumerate() {
                assert_eq!(is_spike, spike == Some(i), "{forces:?}");
            }
        }
    }

    #[test]
    fn nothing_is_judged_before_the_noise_is_known() {
        let usual = Usual { noise_n: None, ..USUAL };
        assert_eq!(judged([0.0, 0.0, 1e6, 0.0, 0.0], &usual), [false; 5]);
    }
}
