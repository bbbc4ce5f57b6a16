//! Least-squares fit of a line and one sine of unknown frequency to a window of means.
//!
//! Time is zero at the middle of the window. The even functions (mean and cosine) are then
//! orthogonal to the odd ones (slope and sine), so the fit is two systems of two equations.

use floe_core::num::math::{hypotenuse, larger, sin_cos, smaller, sqrt};

use super::window::Window;

/// Lowest and highest frequency of the force, Hz. A block swings at half of it: a period of 1.25 to
/// 6.7 s, on 0.4 to 11 m of cable.
const FREQUENCIES_HZ: (f32, f32) = (0.3, 1.6);
/// Smallest number of periods in the window.
const FEWEST_PERIODS: f32 = 2.5;
/// Highest frequency, as a fraction of the sampling frequency of the means.
const RESOLVED: f32 = 0.4;
/// Ratio of a sine's power to the mean power of the residuals from which it is detected. One window
/// in 3000 of white noise exceeds it: the chance at each of some 200 frequencies tried is
/// exp(-13.4), as the strongest one is missing from the residuals.
const SEEN: f32 = 15.0;
/// Number of bisections of the frequency step around the strongest frequency, from half a line
/// width.
const REFINEMENTS: u32 = 8;
/// Largest correlation of neighbours taken into account. A step in the residuals correlates more,
/// and must still be detected as drift.
const LARGEST_CORRELATION: f32 = 0.8;
const TURN_RAD: f32 = core::f32::consts::TAU;

/// An oscillation of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Oscillation {
    /// Period of the force, s: half the period of the swing.
    pub period_s: f32,
    /// Amplitude, in the unit of the readings; its mean over the window if it decays.
    pub amplitude: f32,
    /// One standard deviation of the amplitude.
    pub amplitude_std: f32,
    /// Whether it is detected above the noise.
    pub is_seen: bool,
}

/// The fit to a window. Times are in units of the interval of the means.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Mean, relative to the window's origin.
    pub(super) mean: f32,
    pub(super) mean_std: f32,
    /// Slope per interval.
    pub(super) slope: f32,
    pub(super) slope_std: f32,
    /// Variance of a mean about the fit.
    pub(super) variance: f32,
    /// Correlation of neighbours about the fit.
    pub(super) correlation: f32,
    pub(super) oscillation: Oscillation,
}

/// Fit of the line alone.
struct Line {
    len: f32,
    mean: f32,
    slope: f32,
    /// Sum of the squared times.
    tt: f32,
    /// Sum of squared residuals.
    squares: f32,
}

/// Fit of a sine in addition to the line: amplitudes of cosine and sine, and their effects.
#[derive(Clone, Copy, Default)]
struct Sine {
    cos: f32,
    sin: f32,
    /// Changes of the line's parameters.
    mean: f32,
    slope: f32,
    /// Decrease of the sum of squared residuals.
    gain: f32,
    /// Weights of cosine and sine after the line's fit.
    cos_weight: f32,
    sin_weight: f32,
}

impl Fit {
    pub(super) fn new(window: &Window) -> Self {
        let line = Line::new(window);
        let (step_rad, sine) = strongest(window, &line);
        let freedom = larger(line.len - 5.0, 1.0);
        let variance = larger(line.squares - sine.gain, 0.0) / freedom;
        let correlation = correlation(window, &line, step_rad, sine, variance * freedom);
        // Ratio of the variance of a mean of correlated values to that of independent ones.
        let believed = correlation.clamp(0.0, LARGEST_CORRELATION);
        let excess = (1.0 + believed) / (1.0 - believed);
        let is_seen = sine.gain > 2.0 * SEEN * variance * excess;
        let attenuation = mean_of_a_sine(step_rad, window.readings());
        let weight = smaller(sine.cos_weight, sine.sin_weight);
        let oscillation = Oscillation {
            period_s: TURN_RAD / larger(step_rad, f32::MIN_POSITIVE) * window.block_s(),
            amplitude: hypotenuse(sine.cos, sine.sin) / attenuation,
            amplitude_std: sqrt(variance * excess / larger(weight, 1.0)) / attenuation,
            is_seen,
        };
        let sine = if is_seen { sine } else { Sine::default() };
        Self {
            mean: line.mean + sine.mean,
            mean_std: sqrt(variance * excess / line.len),
            slope: line.slope + sine.slope,
            slope_std: sqrt(variance * excess / line.tt),
            variance,
            correlation,
            oscillation,
        }
    }
}

impl Line {
    fn new(window: &Window) -> Self {
        let len = window.len() as f32;
        let mean = window.means().sum::<f32>() / len;
        let (mut tt, mut ty) = (0.0, 0.0);
        for ((later, earlier), time) in window.pairs().zip(0_u16..) {
            let time = f32::from(time) + 0.5;
            tt += 2.0 * time * time;
            ty += time * (later - earlier);
        }
        let slope = ty / tt;
        let line = Self { len, mean, slope, tt, squares: 0.0 };
        let squares = window.means().zip(0_u16..).map(|(y, i)| y - line.at(i)).map(|r| r * r).sum();
        Self { squares, ..line }
    }

    /// Time of a mean, from the middle of the window.
    fn time(&self, index: u16) -> f32 {
        f32::from(index) - 0.5 * (self.len - 1.0)
    }

    fn at(&self, index: u16) -> f32 {
        self.mean + self.slope * self.time(index)
    }
}

/// Frequency with the largest decrease of the residuals, as angle per interval, and its sine.
fn strongest(window: &Window, line: &Line) -> (f32, Sine) {
    let step_hz = 1.0 / window.block_s();
    let length_s = line.len * window.block_s();
    let lowest = larger(FREQUENCIES_HZ.0, FEWEST_PERIODS / length_s) / step_hz;
    let highest = smaller(FREQUENCIES_HZ.1 / step_hz, RESOLVED);
    let width = 0.5 / line.len;
    let mut best = (0.0, Sine::default());
    let mut try_at = |cycles: f32| {
        let rad = TURN_RAD * cycles;
        let sine = sine_at(window, line, rad);
        if sine.gain > best.1.gain {
            best = (rad, sine);
        }
        best.0 / TURN_RAD
    };
    let count = larger((highest - lowest) / width, -1.0) as i32;
    let mut centre = 0.0;
    for place in 0..=count {
        centre = try_at(lowest + place as f32 * width);
    }
    let mut step = width;
    for _ in 0..REFINEMENTS {
        step *= 0.5;
        try_at(centre - step);
        centre = try_at(centre + step);
    }
    best
}

/// Least-squares fit of a sine in addition to the line.
#[inline(never)]
fn sine_at(window: &Window, line: &Line, step_rad: f32) -> Sine {
    let (turn_sin, turn_cos) = sin_cos(step_rad);
    let (mut s, mut c) = sin_cos(0.5 * step_rad);
    let [mut yc, mut ys, mut sum_c, mut cc, mut ts, mut ss] = [0.0; 6];
    let mut time = 0.5;
    for (later, earlier) in window.pairs() {
        yc += (later + earlier - 2.0 * line.mean) * c;
        ys += (later - earlier - 2.0 * line.slope * time) * s;
        sum_c += 2.0 * c;
        cc += 2.0 * c * c;
        ts += 2.0 * time * s;
        ss += 2.0 * s * s;
        time += 1.0;
        (s, c) = (s * turn_cos + c * turn_sin, c * turn_cos - s * turn_sin);
    }
    let cos_weight = larger(cc - sum_c * sum_c / line.len, 1e-3);
    let sin_weight = larger(ss - ts * ts / line.tt, 1e-3);
    let (cos, sin) = (yc / cos_weight, ys / sin_weight);
    let (mean, slope) = (-cos * sum_c / line.len, -sin * ts / line.tt);
    Sine { cos, sin, mean, slope, gain: cos * yc + sin * ys, cos_weight, sin_weight }
}

/// Correlation of neighbouring residuals of the fit with the sine, detected or not.
fn correlation(window: &Window, line: &Line, step_rad: f32, sine: Sine, squares: f32) -> f32 {
    let residual = |(y, index): (f32, u16)| {
        let time = line.time(index);
        let (s, c) = sin_cos(step_rad * time);
        y - line.at(index) - sine.mean - sine.slope * time - sine.cos * c - sine.sin * s
    };
    let mut residuals = window.means().zip(0_u16..).map(residual);
    let mut before = residuals.next().unwrap_or(0.0);
    let mut products = 0.0;
    for now in residuals {
        products += before * now;
        before = now;
    }
    if squares > 0.0 { products / squares } else { 0.0 }
}

/// Amplitude of a unit sine after averaging over the readings of a mean.
fn mean_of_a_sine(step_rad: f32, readings: u32) -> f32 {
    let (whole, _) = sin_cos(0.5 * step_rad);
    let (part, _) = sin_cos(0.5 * step_rad / readings as f32);
    if part > 0.0 { whole / (readings as f32 * part) } else { 1.0 }
}
