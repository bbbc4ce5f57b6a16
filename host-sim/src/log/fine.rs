//! The rate of samples with individual stamps.

use super::timing::{Timing, median};

/// Number of samples and passes for the line through the first stamps.
const PHASE_SAMPLES: usize = 256;
const PASSES: usize = 3;

/// Timing with one stamp per sample: a line through stamp against index.
///
/// Neighbours may give a poor first guess (jitter, rounded stamps), and so may distant samples
/// (gaps in between): the line with the fewest gaps and duplicates and the smallest residuals is
/// chosen.
pub(super) fn fine(times: &[f64], step_s: f64, rate_hz: Option<f64>, unit_s: f64) -> Timing {
    const SPANS: [usize; 6] = [1, 2, 4, 8, 16, 32];
    let start_s = times.first().copied().unwrap_or(0.0);
    let guess = Line { start_s, period_s: step_s };
    let line = match rate_hz {
        Some(rate_hz) => {
            let mut line = Line { start_s, period_s: rate_hz.recip() };
            line.fit_phase(times.get(..PHASE_SAMPLES).unwrap_or(times));
            line
        }
        None => {
            let digit_s = digit_s(times, unit_s);
            let cost = |line: &Line| line.cost(times, digit_s);
            SPANS
                .iter()
                .filter_map(|&span| median(mean_steps(times, span)))
                .map(|period_s| guess.refined(times, period_s))
                .chain(Line::through_rows(times))
                .min_by(|a, b| cost(a).total_cmp(&cost(b)))
                .unwrap_or(guess)
        }
    };
    Timing { rate_hz: line.period_s.recip(), start_s: line.start_s, shared: None }
}

/// Mean step over every `span` steps.
fn mean_steps(times: &[f64], span: usize) -> Vec<f64> {
    let later = times.iter().skip(span);
    later.zip(times).map(|(b, a)| (b - a) / span as f64).filter(|&step| step > 0.0).collect()
}

/// Resolution of the stamps, s, from their last digit; 0 if they have many digits.
pub(super) fn digit_s(times: &[f64], unit_s: f64) -> f64 {
    /// Resolution of an `f64` for a time since 1970.
    const EXACT_S: f64 = 3e-7;
    /// Finest digit that is looked for: 10 µs, or that of days or minutes next to it.
    const FINEST_S: f64 = 5e-6;
    let start_s = times.first().copied().unwrap_or(0.0);
    let is_written = |&digit_s: &f64| {
        let off =
            |time_s: f64| (time_s - start_s) / digit_s - ((time_s - start_s) / digit_s).round();
        times.iter().all(|&time_s| off(time_s).abs() * digit_s < EXACT_S + 1e-3 * digit_s)
    };
    let digits = (0..12).map(|places| unit_s * 0.1_f64.powi(places));
    digits.take_while(|&digit_s| digit_s > FINEST_S).find(is_written).unwrap_or(0.0)
}

/// A line: stamp as a function of the index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) start_s: f64,
    pub(super) period_s: f64,
}

impl Line {
    /// The line through the stamps, with consecutive indices as if none were missing.
    fn through_rows(times: &[f64]) -> Option<Self> {
        let mut line = Self { start_s: *times.first()?, period_s: 0.0 };
        line.fit_to(times, |row, _| row as f64);
        (line.period_s > 0.0).then(|| {
            line.snap(times);
            line
        })
    }

    fn index(&self, time_s: f64) -> f64 {
        ((time_s - self.start_s) / self.period_s).round()
    }

    fn residual(&self, time_s: f64) -> f64 {
        (time_s - self.start_s) / self.period_s - self.index(time_s)
    }

    /// Cost of a line: fraction of steps that are not one, plus the residuals. Residuals uniform up
    /// to half a period cost as much as one missing sample in five. Rounding to the last digit
    /// counts little: 92 samples a second with two decimals are not 100 with losses.
    fn cost(&self, times: &[f64], digit_s: f64) -> f64 {
        const RESIDUALS: f64 = 0.75;
        const ROUNDED: f64 = 0.075;
        let n = times.len() as f64;
        let indices: Vec<f64> = times.iter().map(|&t| self.index(t)).collect();
        let is_break = |w: &&[f64]| matches!(w, [a, b] if (b - a - 1.0).abs() > 0.5);
        let breaks = indices.windows(2).filter(is_break).count() as f64;
        let square = times.iter().map(|&t| self.residual(t).powi(2)).sum::<f64>();
        let rounded = (square / n).min((digit_s / self.period_s).powi(2) / 12.0);
        breaks / n + RESIDUALS * (square / n - rounded).sqrt() + ROUNDED * rounded.sqrt()
    }

    /// Fits over growing spans, so that no index is ambiguous.
    fn refined(mut self, times: &[f64], period_s: f64) -> Self {
        self.period_s = period_s;
        let mut count = 32;
        while count < times.len() {
            self.fit(times.get(..count).unwrap_or(times));
            count *= 2;
        }
        (0..PASSES).for_each(|_| self.fit(times));
        self.snap(times);
        self
    }

    /// Least squares with the indices from the line itself.
    fn fit(&mut self, times: &[f64]) {
        self.fit_phase(times);
        let before = *self;
        self.fit_to(times, |_, time_s| before.index(time_s));
    }

    /// Least squares with an index for every row and stamp.
    pub(super) fn fit_to(&mut self, times: &[f64], index: impl Fn(usize, f64) -> f64) {
        let n = times.len() as f64;
        let indices = || times.iter().enumerate().map(|(row, &time_s)| index(row, time_s));
        let mean_index = indices().sum::<f64>() / n;
        let mean_time = times.iter().map(|&t| t - self.start_s).sum::<f64>() / n;
        let (mut square, mut product) = (0.0, 0.0);
        for (index, time) in indices().zip(times) {
            let index = index - mean_index;
            square += index * index;
            product += index * (time - self.start_s - mean_time);
        }
        if square > 0.0 && product > 0.0 {
            self.period_s = product / square;
        }
        self.start_s += mean_time - mean_index * self.period_s;
    }

    /// Moves the grid to the mean phase of the stamps, computed as an angle because half a period
    /// early and half a period late are equivalent.
    fn fit_phase(&mut self, times: &[f64]) {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for &time in times {
            let (s, c) = (self.residual(time) * std::f64::consts::TAU).sin_cos();
            sine += s;
            cosine += c;
        }
        let angle = f64::atan2(sine, cosine);
        self.start_s += angle / std::f64::consts::TAU * self.period_s;
    }

    /// Uses the nearest integer rate if every stamp hardly moves.
    fn snap(&mut self, times: &[f64]) {
        const ROUNDING: f64 = 1e-6;
        let nominal_s = self.period_s.recip().round().max(1.0).recip();
        let last = times.last().map_or(0.0, |&time| self.index(time));
        let moved = (self.period_s / nominal_s - 1.0).abs() * last;
        let widest = times.iter().map(|&t| self.residual(t).abs()).fold(ROUNDING, f64::max);
        if moved <= 2.0 * widest {
            self.start_s += (self.period_s - nominal_s) * last / 2.0;
            self.period_s = nominal_s;
        }
    }
}
