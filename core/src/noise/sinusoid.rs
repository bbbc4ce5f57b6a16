//! An oscillation about a stick line, next to a slip: least squares for its cosine and its sine
//! amplitude and for a correction of its frequency, which is nearly known.
//!
//! Ridge regression: the prior variance of the amplitudes is that of the oscillation, so without
//! samples they are as uncertain as that, and an estimate from few samples is shrunk. The first
//! pass gives the amplitudes; the second, from there, the frequency, whose derivative needs them:
//! `t (b cos ωt − a sin ωt)`. `t` counts from the middle of the samples, where the frequency is
//! least correlated with the amplitudes.

use crate::num::math;
use crate::signal::window::Window;
use crate::stats::line::Line;
use crate::stats::normal_equations::{Normal, Symmetric};

/// Most samples of a line that are used: more take time, and add no information on the force next
/// to the slip.
pub(crate) const MOST: u32 = 24;

/// Index of the frequency among the unknowns: cosine, sine, frequency.
const FREQUENCY: usize = 2;

/// A sinusoid of a nearly known frequency about a line.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sinusoid {
    /// Time of the middle of its samples, periods: its angle is zero there.
    pub(crate) middle: f32,
    /// Amplitudes of cosine and sine, N.
    cosine_n: f32,
    sine_n: f32,
    /// Variance of either amplitude, in units of the noise's.
    pub(crate) variance: f32,
    /// Correction of the angle per period, rad, to the one assumed, and the information on it,
    /// `Σ (∂F/∂ω)²`, N².
    pub(crate) faster: f32,
    pub(crate) information_n2: f32,
}

/// Samples about a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AboutLine<'a> {
    pub(crate) line: &'a Line,
    pub(crate) window: &'a Window,
    /// Index of the first sample, and their number.
    pub(crate) from: u32,
    pub(crate) length: u32,
    /// Time of the first one in the line, periods.
    pub(crate) start: f32,
}

impl Sinusoid {
    /// Fits a sinusoid that turns by `angle` per period, rad; `ridge` is the variance of the noise
    /// over that of the oscillation.
    #[inline(never)]
    pub(crate) fn new(samples: &AboutLine<'_>, angle: f32, ridge: f32) -> Self {
        let half = 0.5 * (samples.length as f32 - 1.0);
        let (sin, cos) = math::sin_cos(angle);
        let mut found =
            Self { middle: samples.start + half, variance: 1.0 / ridge, ..Self::default() };
        let Some(slope) = samples.line.slope() else { return found };
        for pass in 0..2 {
            // The frequency has no prior, but is held at zero before there are amplitudes.
            let frequency = if pass > 0 { 0.0 } else { 1.0 };
            let expected = [ridge, 0.0, ridge, 0.0, 0.0, frequency];
            let mut normal = Normal { matrix: Symmetric::of_first(&expected), ..Normal::default() };
            let (mut s, mut c) = math::sin_cos(-half * angle);
            for i in 0..samples.length {
                if let Some(force_n) = samples.window.get(samples.from + i) {
                    let t = i as f32;
                    let on_line_n = samples.line.at(samples.start + t, slope);
                    let (value_n, quarter_n) = found.turned((s, c));
                    let gradient = [c, s, (t - half) * quarter_n, 0.0, 0.0, 0.0];
                    normal.add(force_n - on_line_n - value_n, &gradient, 1.0);
                }
                (c, s) = (c * cos - s * sin, s * cos + c * sin);
            }
            let Some(factor) = normal.matrix.factor(0.0) else { return found };
            let [by_cosine, by_sine, faster, ..] = factor.solve(&normal.right);
            found.cosine_n += by_cosine;
            found.sine_n += by_sine;
            found.faster = faster;
            let matrix = &normal.matrix;
            found.variance = 2.0 / (matrix[[0, 0]] + matrix[[1, 1]]);
            found.information_n2 = matrix[[FREQUENCY, FREQUENCY]];
        }
        found
    }

    /// Its deviation from the line at a time, and a quarter of a turn later, N.
    pub(crate) fn at(&self, time: f32, angle: f32) -> (f32, f32) {
        self.turned(math::sin_cos(angle * (time - self.middle)))
    }

    /// Its deviation, and that a quarter of a turn later, N, at an angle with this sine and cosine.
    #[inline(always)]
    fn turned(&self, (s, c): (f32, f32)) -> (f32, f32) {
        let Self { cosine_n, sine_n, .. } = self;
        (cosine_n * c + sine_n * s, sine_n * c - cosine_n * s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::since;
    use crate::tests::Random;

    const LENGTH: u32 = 22;

    /// A sinusoid of 5 N about a line with noise of 1 N, whose angle is taken to be `taken`: what
    /// was found, and what is true at a time.
    fn found(angle: f32, taken: f32, random: &mut Random) -> (Sinusoid, impl Fn(f32) -> f32) {
        let phase = 6.0 * random.even();
        let truth_n =
            move |time: f32| 5.0 * math::sin_cos((angle * time + phase) % core::f32::consts::TAU).0;
        let (mut window, mut line) = (Window::new(), Line::default());
        for index in 0..LENGTH {
            let time = since(0, index);
            let force_n = 300.0 + 20.0 * time + truth_n(time) + random.normal();
            window.push(index, force_n);
            line.add(time, force_n, 1.0, 1.0);
        }
        let samples =
            AboutLine { line: &line, window: &window, from: 0, length: LENGTH, start: 0.0 };
        (Sinusoid::new(&samples, taken, 1.0 / 12.5), truth_n)
    }

    #[test]
    fn it_is_told_some_samples_further_on() {
        let mut random = Random(7);
        for angle in [0.7_f32, 1.0, 1.6, 2.2] {
            let (mut squares_n2, mut variance) = (0.0, 0.0);
            for _ in 0..200 {
                let (found, truth_n) = found(angle, angle, &mut random);
                let time = LENGTH as f32 + 4.0;
                let off_n = found.at(time, angle).0 - truth_n(time);
                squares_n2 += off_n * off_n / 200.0;
                variance = found.variance;
            }
            // The line takes part of a slow oscillation with it.
            let most = if angle < 0.9 { 6.0 } else { 2.0 };
            assert!(squares_n2 < most * variance, "{angle}: {squares_n2} {variance}");
        }
    }

    #[test]
    fn how_far_its_frequency_is_off_is_told() {
        let mut random = Random(9);
        for angle in [0.7_f32, 1.0, 1.6, 2.2] {
            for off in [-0.08, 0.0, 0.05] {
                let (mut information, mut sum) = (0.0, 0.0);
                for _ in 0..100 {
                    let (found, _) = found(angle, angle - off, &mut random);
                    information += found.information_n2;
                    sum += found.information_n2 * found.faster;
                }
                assert!(
                    (sum / information - off).abs() < 0.03,
                    "{angle} {off}: {}",
                    sum / information
                );
            }
        }
    }

    #[test]
    fn of_no_samples_all_is_open() {
        let (window, line) = (Window::new(), Line::default());
        let samples = AboutLine { line: &line, window: &window, from: 0, length: 0, start: 0.0 };
        let nothing = Sinusoid::new(&samples, 1.0, 0.25);
        assert!(nothing.at(3.0, 1.0).0.abs() < 1e-6 && (nothing.variance - 4.0).abs() < 1e-5);
    }
}
