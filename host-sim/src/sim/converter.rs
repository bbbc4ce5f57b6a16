//! From the force at the cell to the reading in the log: zero, noise, range, quantization.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use super::coloured;
use super::measurement::Measurement;
use super::random::{self, Stream};

/// Octaves of the 1/f noise below half the sampling rate.
const OCTAVES: i32 = 20;

/// Noise with a spectrum of 1/f: one first-order process for each octave, the
/// slowest a million samples long. Flat to about 3 % in between.
#[derive(Clone, Debug)]
struct Flicker {
    processes: Vec<(f64, f64)>,
    octave_n: f64,
    random: ChaCha8Rng,
}

impl Flicker {
    fn new(per_decade_n: f64, mut random: ChaCha8Rng) -> Self {
        let octave_n = per_decade_n * 2.0_f64.log10().sqrt();
        let start = |j: i32| {
            let z: f64 = StandardNormal.sample(&mut random);
            // Correlation over one sample of a process with its corner at
            // half the sampling rate over 2^j.
            ((-std::f64::consts::PI / 2.0_f64.powi(j)).exp(), octave_n * z)
        };
        let processes = (0..OCTAVES).map(start).collect();
        Self { processes, octave_n, random }
    }

    fn next_n(&mut self) -> f64 {
        let mut sum_n = 0.0;
        for (correlation, value_n) in &mut self.processes {
            let z: f64 = StandardNormal.sample(&mut self.random);
            let fresh = (1.0 - *correlation * *correlation).sqrt() * self.octave_n;
            *value_n = *correlation * *value_n + fresh * z;
            sum_n += *value_n;
        }
        sum_n
    }
}

/// Turns forces into readings, one sample after the other.
#[derive(Clone, Debug)]
pub(super) struct Converter {
    settings: Measurement,
    white: ChaCha8Rng,
    coloured: Option<coloured::Process>,
    flicker: Option<Flicker>,
    jitter: ChaCha8Rng,
    faults: ChaCha8Rng,
}

/// How many times a sample appears in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delivery {
    Once,
    Twice,
    Never,
}

impl Converter {
    pub(super) fn new(settings: &Measurement, seed: u64) -> Self {
        let flicker = (settings.flicker_n > 0.0)
            .then(|| Flicker::new(settings.flicker_n, random::stream(seed, Stream::Flicker)));
        Self {
            settings: settings.clone(),
            white: random::stream(seed, Stream::White),
            coloured: settings
                .coloured
                .map(|law| coloured::Process::new(law, random::stream(seed, Stream::Coloured))),
            flicker,
            jitter: random::stream(seed, Stream::Jitter),
            faults: random::stream(seed, Stream::Faults),
        }
    }

    /// Time, s, by which the next sample is taken late; negative: early.
    pub(super) fn delay_s(&mut self) -> f64 {
        let jitter_s = self.jitter_s();
        let Some(late) = self.settings.late else { return jitter_s };
        if self.happens(late.probability) { jitter_s + late.delay_s } else { jitter_s }
    }

    fn jitter_s(&mut self) -> f64 {
        let Some(jitter) = self.settings.jitter else { return 0.0 };
        let z: f64 = StandardNormal.sample(&mut self.jitter);
        jitter.std_s * z.clamp(-4.0, 4.0)
    }

    /// The reading, N, of a force at a time.
    pub(super) fn read_n(&mut self, force_n: f64, time_s: f64) -> f64 {
        let ramp = self.settings.ramp.unwrap_or_default();
        let scaled_n = force_n * (1.0 + ramp.span_per_s * time_s);
        let analogue_n = scaled_n + self.zero_n(time_s) + self.noise_n() + self.settings.tare_n;
        let mut code_n = self.digitise(analogue_n);
        if let Some(spikes) = self.settings.spikes
            && self.happens(spikes.probability)
        {
            let largest = self.happens(0.5);
            code_n = if largest { self.settings.range_n } else { -self.settings.step_n };
        }
        code_n - self.settings.tare_n
    }

    /// Whether a sample is dropped or repeated.
    pub(super) fn delivery(&mut self) -> Delivery {
        let (dropped, repeated) = (self.settings.dropped, self.settings.repeated);
        if dropped.is_some_and(|d| self.happens(d.probability)) {
            Delivery::Never
        } else if repeated.is_some_and(|r| self.happens(r.probability)) {
            Delivery::Twice
        } else {
            Delivery::Once
        }
    }

    fn zero_n(&self, time_s: f64) -> f64 {
        let drift_n = self
            .settings
            .drift
            .map_or(0.0, |d| d.amplitude_n * (std::f64::consts::TAU * time_s / d.period_s).sin());
        let step = self.settings.zero_step.filter(|s| time_s >= s.at_s);
        let ramp_n = self.settings.ramp.map_or(0.0, |r| r.zero_n_per_s * time_s);
        drift_n + ramp_n + step.map_or(0.0, |s| s.height_n)
    }

    fn noise_n(&mut self) -> f64 {
        let mut noise_n = 0.0;
        if self.settings.white_n > 0.0 {
            let z: f64 = StandardNormal.sample(&mut self.white);
            noise_n += self.settings.white_n * z;
        }
        noise_n += self.coloured.as_mut().map_or(0.0, coloured::Process::next_n);
        noise_n + self.flicker.as_mut().map_or(0.0, Flicker::next_n)
    }

    fn digitise(&self, analogue_n: f64) -> f64 {
        let (range_n, step_n) = (self.settings.range_n, self.settings.step_n);
        let rounded =
            if step_n > 0.0 { (analogue_n / step_n).round() * step_n } else { analogue_n };
        if range_n > 0.0 { rounded.clamp(-range_n, range_n) } else { rounded }
    }

    fn happens(&mut self, probability: f64) -> bool {
        let u: f64 = StandardUniform.sample(&mut self.faults);
        u < probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flicker_has_the_same_power_in_each_decade() {
        // Variance of block means falls by the stated variance per decade.
        let mut flicker = Flicker::new(1.0, random::stream(5, Stream::Flicker));
        let values: Vec<f64> = (0..1 << 20).map(|_| flicker.next_n()).collect();
        let spread = |block: usize| {
            let means: Vec<f64> =
                values.chunks(block).map(|c| c.iter().sum::<f64>() / block as f64).collect();
            // Allan variance, in which the slowest parts cancel.
            means.windows(2).map(|w| 0.5 * (w[1] - w[0]).powi(2)).sum::<f64>()
                / (means.len() - 1) as f64
        };
        // 2 ln 2 h for a spectrum h/f, and h = 1/ln 10 here.
        let expected = 2.0 * 2.0_f64.ln() / 10.0_f64.ln();
        for block in [16, 128, 1024] {
            assert!((spread(block) / expected - 1.0).abs() < 0.15, "{block}: {}", spread(block));
        }
    }
}
