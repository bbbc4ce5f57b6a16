//! Scale of the noise, estimated online.
//!
//! Running quantiles of absolute values, moved by a constant factor up or down: no threshold is in
//! newtons, and neither slips nor spikes can carry them away. The estimate is good to about 10 %,
//! for the detector's limits; the reported noise comes from the residuals of the fits.
//!
//! Where the block rests long enough the innovations of the stick line give the noise. Where it
//! never does, the line does not describe the force, and two other measures bound the noise until
//! the first fits: the remainder of the second differences without an oscillation, if it is small
//! (`oscillation.rs`), and the steepness of the falls (`time_asymmetry.rs`). White noise shows
//! neither. Where the innovations are far larger than the second differences imply, the line was
//! bent before the noise was known, by a cable that was tightened, held, and pulled: then the
//! second differences give the noise.

use crate::noise::oscillation::WithoutOscillation;
use crate::noise::time_asymmetry::TimeAsymmetry;
use crate::num::math::{self, larger, smaller};
use crate::stats::quantile::Quantile;

/// Running robust standard deviation.
// Field order: first what every sample touches.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Noise {
    /// The newest sample, N; NaN before the first.
    newest_n: f32,
    /// Smallest nonzero step between successive samples, N: the resolution; infinite before.
    resolution_n: f32,
    /// Standard deviation of rounding to the resolution, N.
    hidden_n: f32,
    /// Standard deviation by the residuals of fits, N, and its weight, up to [`TRUSTED`].
    fitted_n: f32,
    fits: u8,
    /// Were two samples in a row equal?
    repeats: bool,
    /// Median of the innovations' absolute values.
    innovation: Quantile,
    /// Their upper quartile, until the first fit: with the coarse steps of a converter the median
    /// carries little information.
    upper: Quantile,
    time_asymmetry: TimeAsymmetry,
    /// Median of the second differences' absolute values.
    second_difference: Quantile,
    oscillation: WithoutOscillation,
    /// The samples before the newest, newest last; NaN before the first and in a gap.
    row: [f32; 3],
}

/// Weight of the fits from which on the samples' differences no longer count. Below it both do: one
/// event of a block that never rests may fit badly, and with too large a noise there would be no
/// other event.
const TRUSTED: u8 = 16 * BELIEVED;
/// Weight of an event that has coefficients; one without has the weight one, since events of mere
/// noise come and go.
const BELIEVED: u8 = 4;

/// Median and upper quartile of |x|, for a normal distribution.
const MEDIAN: f32 = 0.674_49;
const QUARTILE: f32 = 1.150_35;
/// Noise over the median of |second difference|, one over 0.6745 √6. A median, since slips may take
/// nearly half of the time, as in a record that begins in mid-pull.
const STD_PER_SECOND: f32 = 1.0 / 1.652;
/// Largest noise beside slips, parts of their typical fall in a sample: a first slip has to drop by
/// eight times the noise, and in more noise none could be detected.
const SLIP: f32 = 1.0 / 12.0;
/// The line is bent where [`CAUTION`] times the noise by the second differences is less than this
/// part of its innovations. Tuned: a larger part takes a slow oscillation of the force for slips.
const BENT: f32 = 0.3;
/// Factor on the noise by the second differences: about a bent line noise and a slip are hard to
/// distinguish. Tuned: with 2 an event of `tightened_low` is 4.1 standard deviations off (2.9),
/// with 4.5 the intervals of its events are a tenth wider.
const CAUTION: f32 = 3.0;
/// Factor on the noise of a fit, which follows slips and rate changes as the line does not. Tuned,
/// with little effect: with 1 or 2.2 hardly an event is gained or lost but in `many_pauses`.
const BEYOND_FITS: f32 = 1.5;
/// Standard deviation of rounding to a step, parts of the step: `1/√12`, rounded up.
const OF_STEP: f32 = 0.3;
/// Rounding error of a force in single precision, parts of the force: some units of 2⁻²⁴.
const ROUNDING: f32 = 4e-7;

impl Noise {
    /// Before the first sample.
    pub(crate) fn new() -> Self {
        Self {
            newest_n: f32::NAN,
            resolution_n: f32::INFINITY,
            hidden_n: 0.0,
            fitted_n: 0.0,
            fits: 0,
            repeats: false,
            innovation: Quantile::default(),
            upper: Quantile::default(),
            time_asymmetry: TimeAsymmetry::default(),
            second_difference: Quantile::default(),
            oscillation: WithoutOscillation::default(),
            row: [f32::NAN; 3],
        }
    }

    /// Takes an innovation, N, already divided by its standard deviation in units of a sample's.
    pub(crate) fn add_innovation(&mut self, innovation_n: f32) {
        self.innovation.add(innovation_n.abs(), 0.5);
        if self.fits == 0 {
            self.upper.add(innovation_n.abs(), 0.75);
        }
    }

    /// Takes the noise, N, estimated from the residuals of all events so far; `believed` if the
    /// newest event has coefficients.
    pub(crate) fn add_fit(&mut self, noise_n: f32, believed: bool) {
        self.fitted_n = BEYOND_FITS * noise_n;
        self.fits = (self.fits + if believed { BELIEVED } else { 1 }).min(TRUSTED);
    }

    /// Takes a sample; `in_a_row` if it follows the one before without a gap.
    pub(crate) fn add_sample(&mut self, force_n: f32, in_a_row: bool) {
        let step_n = (force_n - self.newest_n).abs();
        if in_a_row && step_n < self.resolution_n {
            self.resolve(step_n);
        }
        // The differences give the noise until the fits do.
        if self.fits < TRUSTED {
            self.difference(force_n, in_a_row);
        }
        self.newest_n = force_n;
    }

    /// Takes a step between samples that is smaller than the resolution so far, or zero.
    #[cold]
    fn resolve(&mut self, step_n: f32) {
        if step_n > 0.0 {
            (self.resolution_n, self.hidden_n) = (step_n, OF_STEP * step_n);
        } else {
            self.repeats = true;
        }
    }

    /// Takes the newest samples' differences; those before the first and across a gap are NaN.
    fn difference(&mut self, e: f32, in_a_row: bool) {
        let ([a, b, c], d) = (self.row, if in_a_row { self.newest_n } else { f32::NAN });
        self.row = [b, c, d];
        let step = e - d;
        if !step.is_nan() {
            self.time_asymmetry.add(step);
        }
        let second = (c - 2.0 * d + e).abs();
        if !second.is_nan() {
            self.second_difference.add(second, 0.5);
        }
        let outer = a - 2.0 * (b - c + d) + e;
        if !outer.is_nan() {
            self.oscillation.add(outer, b - 2.0 * c + d);
        }
    }

    /// Standard deviations, N: of the stick line's innovations, and of the samples' noise, which is
    /// less where the line does not describe the force.
    ///
    /// Neither is below that of rounding to the resolution, nor below the rounding error of a force
    /// of this size. Infinite before enough samples.
    pub(crate) fn std_n(&self, force_n: f32) -> (f32, f32) {
        let floor = larger(self.hidden_n, ROUNDING * force_n.abs());
        let innovation = self.innovation.over(MEDIAN);
        let line = larger(innovation, floor);
        if self.fits < TRUSTED {
            return (line, self.early_std_n(line, floor));
        }
        (line, larger(smaller(innovation, self.fitted_n), floor))
    }

    /// Standard deviation of the samples' noise, N, before the fits are trusted.
    fn early_std_n(&self, line_n: f32, floor_n: f32) -> f32 {
        let (upper_n, fitted_n) = match self.fits {
            0 => (self.upper.over(QUARTILE), f32::INFINITY),
            _ => (0.0, self.fitted_n),
        };
        let bound_n = larger(smaller(fitted_n, self.without_line_n(line_n)), floor_n);
        smaller(larger(line_n, upper_n), bound_n)
    }

    /// The converter's step, N, where samples repeat: then the noise may be as large as a step, though
    /// many differences are zero. Else zero.
    pub(crate) fn step_n(&self) -> f32 {
        if self.repeats && self.hidden_n > 0.0 { self.resolution_n } else { 0.0 }
    }

    /// Standard deviation of the noise of single samples, N, by the second differences, to which
    /// what changes slowly adds nothing. Infinite before enough samples.
    pub(crate) fn quick_n(&self) -> f32 {
        let by_seconds_n = |second_n| larger(second_n * STD_PER_SECOND, self.step_n());
        self.second_difference.value().map_or(f32::INFINITY, by_seconds_n)
    }

    /// Standard deviation of the samples' noise, N, by measures that need no line; the scale of the
    /// innovations is `line_n`. Infinite where none applies.
    fn without_line_n(&self, line_n: f32) -> f32 {
        let Some(oscillation_n2) = self.oscillation.noise_n2() else { return f32::INFINITY };
        let mut std_n = self.time_asymmetry.slip_n().map_or(f32::INFINITY, |slip_n| SLIP * slip_n);
        if self.oscillation.leaves_little(oscillation_n2) {
            std_n = smaller(std_n, math::rough_sqrt(oscillation_n2));
        }
        let bent_n = CAUTION * self.quick_n();
        if line_n < f32::INFINITY && bent_n < BENT * line_n {
            std_n = smaller(std_n, bent_n);
        }
        std_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    /// Mean of 500 estimates after 2000 samples.
    fn settled(mut take: impl FnMut(&mut Noise, f32)) -> f32 {
        let (mut noise, mut random) = (Noise::new(), Random(7));
        (0..2000).for_each(|_| take(&mut noise, random.normal()));
        (0..500)
            .map(|_| {
                take(&mut noise, random.normal());
                noise.std_n(0.0).1 / 500.0
            })
            .sum()
    }

    #[test]
    fn settles_on_the_standard_deviation_whatever_its_size() {
        for std in [1e-4, 2.0, 300.0] {
            let line = settled(|noise, x| noise.add_innovation(std * x));
            assert!((line / std - 1.0).abs() < 0.1, "{line} {std}");
        }
    }

    #[test]
    fn white_noise_is_neither_a_saw_nor_an_oscillation() {
        let (mut noise, mut random) = (Noise::new(), Random(5));
        for i in 0..20_000 {
            noise.add_sample(random.normal(), true);
            assert!(noise.without_line_n(f32::INFINITY).is_infinite(), "{i}");
        }
    }

    #[test]
    fn a_force_that_never_rests_still_bounds_the_noise() {
        let (mut noise, mut random) = (Noise::new(), Random(3));
        for i in 0..400 {
            let oscillation_n = 400.0 * (1.1 * i as f32).sin();
            noise.add_sample(oscillation_n + 2.0 * random.normal(), true);
            // A line through it sees the oscillation as noise.
            noise.add_innovation(oscillation_n);
        }
        assert!(noise.std_n(0.0).1 < 90.0, "{:?}", noise.std_n(0.0));
    }

    #[test]
    fn a_wild_start_and_later_outliers_do_not_stay() {
        let (mut noise, mut random) = (Noise::new(), Random(9));
        noise.add_innovation(1e4);
        (0..300)
            .for_each(|i| noise.add_innovation(if i % 20 == 0 { 500.0 } else { random.normal() }));
        let std = noise.std_n(0.0).1;
        assert!((0.6..1.6).contains(&std), "{std}");
    }

    #[test]
    fn coarse_steps_set_a_floor() {
        let mut noise = Noise::new();
        (0..50).for_each(|_| noise.add_innovation(0.0));
        noise.add_sample(0.0, false);
        noise.add_sample(5.0, true);
        assert!(noise.std_n(0.0).1 >= 1.5);
    }
}
