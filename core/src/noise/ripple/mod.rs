//! Colored noise: how the force departs from a straight stick line beyond white noise.
//!
//! A winch that ripples or a cable that sags bends the stick line. The bend is in the force itself:
//! neighbouring samples share it, and at the onset the force counts, not the line. White noise is
//! independent from sample to sample. So the second difference of the line's innovations,
//! `e − 2 e' + e''`, shows the noise alone (6 times its variance), and the variance of the
//! innovations beyond that is of slow departures.

mod colored;
mod sums;

pub(crate) use colored::{ColoredNoise, Wander};

use crate::effect::Parameter;
use crate::num::math::{larger, smaller};
use crate::stats::in_a_row::InARow;
use sums::Sums;

/// Statistics of the innovations, with forgetting, that distinguish colored noise from white.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ripple {
    /// The last innovations, each times its weight, newest first; NaN where there is none.
    last: [f32; FAR],
    /// The newest innovation times its weight, and the weight: added once another has followed.
    held: (f32, f32),
    /// Sums over this rest, and over the rests before.
    rest: Sums,
    past: Sums,
    /// Usual mean square of a rest, a running estimate; zero before the first.
    usual: f32,
    /// Foul rests, see [`FOUL`].
    fouls: InARow,
}

/// Lag, samples, at which a slow departure shows its slope.
const FAR: usize = 4;
/// Time constant of the forgetting, samples.
const MEMORY: f32 = 2000.0;
/// Samples of a long rest that are added to the past together.
const REST: f32 = 64.0;
/// A rest whose mean square exceeds the usual one by this factor is foul and does not count: a
/// winch that paused has bent its line.
const FOUL: f32 = 6.0;
/// Largest and least factor by which a rest changes the usual mean square. They balance where three
/// rests of ten lie below, `UP^7 DOWN^3` = 1.02: more than half of the rests may be foul.
const UP: f32 = 1.35;
const DOWN: f32 = 0.5;
/// Fewest samples of a rest that update the usual mean square.
const LEAST_REST: f32 = 6.0;
impl Ripple {
    /// Takes the innovation, with its weight, of the sample that follows the last one. The last
    /// innovation of a line never counts: a block that creeps bends the force down there, and if
    /// that counted as ripple the corners would not be found.
    pub(crate) fn add(&mut self, innovation: f32, weight: f32) {
        let (innovation, weight) =
            core::mem::replace(&mut self.held, (weight * innovation, weight));
        let [last, before, earlier, far] = self.last;
        self.last = [innovation, last, before, earlier];
        let step = innovation - last;
        let second_difference = step - (last - before);
        // NaN as well before there are three in a row.
        if second_difference.is_nan() {
            return;
        }
        let rest = &mut self.rest;
        rest.count += weight;
        rest.sum += innovation;
        rest.squares += innovation * innovation;
        rest.first_differences += step * step;
        rest.second_differences += second_difference * second_difference;
        rest.products[0] += innovation * last;
        rest.products[1] += innovation * before;
        let far_step = innovation - far;
        if !far_step.is_nan() {
            rest.far_differences += far_step * far_step;
            rest.far_count += weight;
        }
        if rest.count >= REST {
            self.settle();
        }
    }

    /// The next sample has no neighbour before it.
    pub(crate) fn interrupt(&mut self) {
        self.last = [f32::NAN; FAR];
        self.held = (f32::NAN, 0.0);
    }

    /// Ends a rest, or a part of a long one: adds it to the past unless it is foul. A past that
    /// turns out to be foul is dropped.
    #[cold]
    pub(crate) fn settle(&mut self) {
        let (rest, usual) = (&self.rest, self.usual);
        let mean = rest.squares / rest.count;
        let mut is_foul = usual > 0.0 && mean > FOUL * usual;
        if rest.count >= LEAST_REST {
            let are_normal = self.fouls.take(is_foul);
            self.usual = larger(smaller(mean, UP * usual), DOWN * usual);
            if usual <= 0.0 || are_normal {
                (self.usual, is_foul, self.past.count) = (mean, false, 0.0);
            }
        }
        // A past that no longer represents the rests is dropped.
        if self.past.squares >= FOUL * self.usual * self.past.count {
            self.past = Sums::default();
        }
        if !is_foul {
            self.past.take(1.0 - rest.count / MEMORY, rest);
        }
        self.rest = Sums::default();
    }

    /// Standard deviation of the departures from the lines beyond white noise, N, if significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, std) = self.past.stray_n()?;
        Some(Parameter { name: "stray_n", value, std })
    }

    /// The colored noise that the innovations show; none unless it is significant.
    pub(crate) fn wander(&self) -> ColoredNoise {
        self.past.wander()
    }
}

impl Default for Ripple {
    fn default() -> Self {
        let (last, held) = ([f32::NAN; FAR], (f32::NAN, 0.0));
        let (rest, past, fouls) = (Sums::default(), Sums::default(), InARow::default());
        Self { last, held, rest, past, usual: 0.0, fouls }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::math;
    use crate::tests::Random;

    /// White noise of variance 1/12 and an oscillation.
    fn after(amplitude: f32, period: f32, samples: u32) -> Ripple {
        let (mut ripple, mut random) = (Ripple::default(), Random(1));
        for i in 0..samples {
            let noise = random.even() - 0.5;
            let angle = core::f32::consts::TAU * (i as f32 / period).fract();
            ripple.add(noise + amplitude * angle.sin(), 1.0);
        }
        ripple.settle();
        ripple
    }

    /// Noise each of whose values has this part of the one before.
    fn correlated(part: f32) -> Ripple {
        let (mut ripple, mut random, mut last) = (Ripple::default(), Random(1), 0.0);
        for _ in 0..4000 {
            last = part * last + random.normal();
            ripple.add(last, 1.0);
        }
        ripple.settle();
        ripple
    }

    fn seen(amplitude: f32, period: f32, samples: u32) -> ColoredNoise {
        after(amplitude, period, samples).wander()
    }

    /// Of oscillations of any number of samples, and of noise with correlated neighbours.
    #[test]
    fn how_much_the_force_strays_is_a_number() {
        let stray = |samples: f32| after(1.0, samples, 4000).parameter().unwrap();
        for samples in [2.5, 4.0, 8.0, 20.0] {
            let Parameter { value, std, .. } = stray(samples);
            assert!((value - 0.5_f32.sqrt()).abs() < 3.0 * std && std < 0.02, "{value} {std}");
        }
        let Parameter { value, std, .. } = correlated(0.5).parameter().unwrap();
        assert!((value / (4.0_f32 / 3.0).sqrt() - 1.0).abs() < 0.1 && std < 0.05, "{value} {std}");
    }

    #[test]
    fn white_noise_does_not_wander() {
        for samples in [3, 10, 100, 1000, 10_000] {
            assert_eq!(seen(0.0, 9.0, samples), ColoredNoise::NONE, "{samples}");
        }
    }

    /// A slow oscillation is followed as a bend is.
    #[test]
    fn a_slow_oscillation_is_told_from_the_noise() {
        for period in [22.0, 24.0, 30.0] {
            // Variances of the oscillation and of its slope over that of the noise.
            let step = core::f32::consts::TAU / period;
            let (level, slope) = (0.5 * 12.0, 0.5 * 12.0 * step * step);
            let wander = seen(1.0, period, 4000);
            assert!((wander.level / level - 1.0).abs() < 0.15, "{wander:?}");
            assert!((wander.slope / slope - 1.0).abs() < 0.25, "{wander:?}");
            assert!(wander.bends && !wander.is_disputed(), "{wander:?}");
            assert_eq!(wander.unsure.to_bits(), 0, "{wander:?}");
        }
    }

    /// The events decide the cause of a quick oscillation; its frequency and share are found here.
    #[test]
    fn a_quick_oscillation_is_not_followed_but_seen() {
        // Variances 1/2 and 1/12.
        let share = 6.0 / 7.0;
        for period in [2.5, 3.3, 4.0, 4.5, 5.5, 8.0, 12.0] {
            let seen = seen(1.0, period, 4000);
            assert_eq!(
                ColoredNoise { unsure: 0.0, angle: 0.0, ..seen },
                ColoredNoise::NONE,
                "{period}"
            );
            assert!((seen.unsure - share).abs() < 0.02, "{period}: {seen:?}");
            let angle = core::f32::consts::TAU / period;
            assert!((seen.angle / angle - 1.0).abs() < 0.02, "{period}: {seen:?}");
            assert!(seen.is_disputed(), "{period}: {seen:?}");
        }
    }

    #[test]
    fn a_line_hides_what_is_alike_and_not_what_alternates() {
        // `2 r / (1 − r)` times what a line hides.
        let line_excess: [f32; 3] = [0.3, 0.5, 0.7].map(|it| correlated(it).wander().line_excess);
        assert!(
            line_excess[0] < line_excess[1] && line_excess[1] > 2.0 && line_excess[2] > 4.7,
            "{line_excess:?}"
        );
        assert_eq!(correlated(-0.5).wander(), ColoredNoise::NONE);
    }

    /// A hundred rests of twenty samples that depart from their lines by noise and by this.
    fn alike(off_n: impl Fn(f32) -> f32) -> ColoredNoise {
        let (mut ripple, mut random) = (Ripple::default(), Random(1));
        for _line in 0..100 {
            (0..20_u8).for_each(|i| ripple.add(off_n(i.into()) + random.normal(), 1.0));
            ripple.interrupt();
            ripple.settle();
        }
        ripple.wander()
    }

    #[test]
    fn what_is_the_same_in_all_rests_is_the_forces_own() {
        let bent = |bend: f32| alike(|i| bend * i / 20.0);
        assert_eq!(bent(0.0), ColoredNoise::NONE);
        assert!(bent(4.0).bends && bent(4.0).level > 0.0, "{:?}", bent(4.0));
    }

    /// A cable that flops five samples a turn, in time with every slip.
    #[test]
    fn a_flop_is_no_bend() {
        let flop = alike(|i| 2.0 * math::exp(-0.1 * i) * (1.26 * i).cos() - 0.3);
        assert!(!flop.bends && !flop.creeps && flop.unsure < 0.5, "{flop:?}");
    }

    #[test]
    fn the_bend_before_an_onset_is_no_ripple() {
        let (mut ripple, mut random) = (Ripple::default(), Random(1));
        for _line in 0..40 {
            (0..10).for_each(|_| ripple.add(random.even() - 0.5, 1.0));
            ripple.add(-20.0, 1.0);
            ripple.interrupt();
            ripple.settle();
        }
        assert_eq!(ripple.wander(), ColoredNoise::NONE);
    }

    /// Rests of twenty samples of white noise; some of them on a line that a paused winch has bent.
    fn rests(is_bent: impl Fn(u32) -> bool) -> ColoredNoise {
        let (mut ripple, mut random) = (Ripple::default(), Random(5));
        for rest in 0..60 {
            let bend = if is_bent(rest) { 8.0 } else { 0.0 };
            (0..20).for_each(|_| ripple.add(random.normal() - bend, 1.0));
            ripple.interrupt();
            ripple.settle();
        }
        ripple.wander()
    }

    #[test]
    fn rests_on_bent_lines_teach_nothing() {
        assert_eq!(rests(|_| false), ColoredNoise::NONE);
        assert_eq!(rests(|rest| rest % 3 == 1), ColoredNoise::NONE);
        // Nor do the first ones, once the others are known.
        assert_eq!(rests(|rest| rest < 5), ColoredNoise::NONE);
        // Bent lines in all rests are the normal case.
        assert!(rests(|_| true).unsure > 0.9);
    }

    #[test]
    fn nothing_is_believed_of_a_few_samples_or_of_none() {
        assert_eq!(seen(1.0, 20.0, 8), ColoredNoise::NONE);
        let mut exact = Ripple::default();
        (0..100).for_each(|_| exact.add(0.0, 1.0));
        exact.settle();
        assert_eq!(exact.wander(), ColoredNoise::NONE);
        assert_eq!(Ripple::default().wander(), ColoredNoise::NONE);
    }
}
