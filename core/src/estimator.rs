//! From events to a coefficient: a mean with an honest error.
//!
//! The events differ by their own noise, which each states, and by real variation
//! of the friction, which has to be found out: random effects. All sums are kept in
//! double precision (one update an event, not a sample), relative to the running
//! mean, so a million events lose nothing, and two estimators can be merged.
//!
//! With `s_i` an event's standard deviation, `τ²` the variance between events:
//!
//! - `τ² = max(0, S² − mean s_i²)`, `S²` the sample variance (method of moments);
//! - mean `m = λ m_w + (1 − λ) m_1`: `m_w` weighted by `1/s_i²`, `m_1` plain,
//!   `λ = s̄²/(s̄² + τ²)` with `s̄²` the harmonic mean of `s_i²`; either is the best
//!   mean at its end of the scale;
//! - errors that are common to the events, as that of a weight which was measured
//!   after a change, stay in the mean: their mean size is added squared;
//! - variance of `m` from the same weights, times `1 + 2 Σ ρ_k` with the correlations
//!   `ρ_k` of the events in order: two neighbours share the stick line between them,
//!   and real friction wanders.

use crate::correlation::Correlation;
use crate::event::Coefficient;
use crate::math;
use crate::report::Estimate;

/// Running mean of one coefficient over events.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimator {
    count: u32,
    /// Plain mean and Σ (x − mean)².
    mean: f64,
    squares: f64,
    /// Mean of the events' variances.
    variance: f64,
    /// Weighted mean, Σ w, Σ w².
    weighted_mean: f64,
    weight: f64,
    weight_squares: f64,
    correlation: Correlation,
    /// Mean of the parts of the events' standard deviations that are common to them.
    common: f64,
}

impl Estimator {
    /// Takes an event's coefficient. One without a finite value and a standard
    /// deviation above zero is left out.
    pub fn add(&mut self, event: Coefficient) {
        self.add_with_common(event, 0.0);
    }

    /// The same, for an event that shares a part of its standard deviation with
    /// others: however many there are, the mean keeps that part.
    pub fn add_with_common(&mut self, event: Coefficient, common_std: f32) {
        let (value, std) = (f64::from(event.value), f64::from(event.std));
        if !(value.is_finite() && std.is_finite() && std > 0.0) {
            return;
        }
        self.correlation.add(value);
        let common = f64::from(common_std);
        self.pool(&Self { common, ..Self::single(value, std * std) });
    }

    fn single(value: f64, variance: f64) -> Self {
        let weight = 1.0 / variance;
        Self {
            count: 1,
            mean: value,
            variance,
            weighted_mean: value,
            weight,
            weight_squares: weight * weight,
            ..Self::default()
        }
    }

    /// Takes the events of another estimator, which came after its own.
    pub fn merge(&mut self, later: &Self) {
        self.correlation.merge(&later.correlation);
        self.pool(later);
    }

    /// Pools all but the order of the events.
    fn pool(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let (n, m) = (f64::from(self.count), f64::from(other.count));
        let share = m / (n + m);
        let step = other.mean - self.mean;
        self.squares += other.squares + n * share * step * step;
        self.mean += share * step;
        self.variance += share * (other.variance - self.variance);
        self.common += share * (other.common - self.common);
        let weight = self.weight + other.weight;
        self.weighted_mean += other.weight / weight * (other.weighted_mean - self.weighted_mean);
        self.weight = weight;
        self.weight_squares += other.weight_squares;
        self.count = self.count.saturating_add(other.count);
    }

    /// Number of events that count.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean, standard error and spread; `None` without events.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        if self.count == 0 {
            return None;
        }
        let n = f64::from(self.count);
        let between = self.between().unwrap_or(0.0);
        let typical = n / self.weight;
        let lambda = typical / (typical + between);
        let mean = lambda * self.weighted_mean + (1.0 - lambda) * self.mean;
        let weighted =
            1.0 / self.weight + between * self.weight_squares / (self.weight * self.weight);
        let plain = (self.variance + between) / n;
        let mixed = 1.0 / self.weight + between / n;
        let variance = lambda * lambda * weighted
            + (1.0 - lambda) * (1.0 - lambda) * plain
            + 2.0 * lambda * (1.0 - lambda) * mixed;
        let common = self.common * self.common;
        let error = math::sqrt((variance * self.inflation(lambda) + common) as f32);
        Some(Estimate {
            mean: mean as f32,
            std_error: error,
            spread: self.between().map(|variance| math::sqrt(variance as f32)),
            events: self.count,
        })
    }

    /// Variance between events, noise removed; needs two events.
    fn between(&self) -> Option<f64> {
        let free = f64::from(self.count) - 1.0;
        (free > 0.0).then(|| (self.squares / free - self.variance).max(0.0))
    }

    /// Factor on the variance of the mean because the events are correlated: what is
    /// seen, once there are enough, and at least neighbours by half the share of the
    /// noise, as from a shared stick line.
    fn inflation(&self, noise_share: f64) -> f64 {
        const ENOUGH: u32 = 30;
        let shared_line = if self.count > 1 { 1.0 + noise_share } else { 1.0 };
        if self.count < ENOUGH || self.squares <= 0.0 {
            return shared_line;
        }
        let variance = self.squares / f64::from(self.count);
        self.correlation.inflation(self.mean, variance).max(shared_line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coefficient(value: f32, std: f32) -> Coefficient {
        Coefficient { value, std }
    }

    fn all(values: &[(f32, f32)]) -> Estimator {
        let mut e = Estimator::default();
        values.iter().for_each(|&(v, s)| e.add(coefficient(v, s)));
        e
    }

    const VALUES: [(f32, f32); 7] = [
        (1.24, 0.01),
        (1.21, 0.02),
        (1.29, 0.01),
        (1.18, 0.05),
        (1.25, 0.01),
        (1.22, 0.03),
        (1.27, 0.02),
    ];

    #[test]
    fn nothing_in_nothing_out() {
        let mut e = all(&[(f32::NAN, 1.0), (1.0, 0.0), (1.0, f32::INFINITY)]);
        assert_eq!(e.estimate(), None);
        e.add(coefficient(0.5, 0.1));
        let one = e.estimate().unwrap();
        assert!((one.mean - 0.5).abs() < 1e-6 && (one.std_error - 0.1).abs() < 1e-6);
        assert_eq!((one.spread, one.events), (None, 1));
    }

    #[test]
    fn merging_at_any_split_equals_the_whole() {
        let whole = all(&VALUES).estimate().unwrap();
        for split in 0..=VALUES.len() {
            let mut a = all(&VALUES[..split]);
            a.merge(&all(&VALUES[split..]));
            let merged = a.estimate().unwrap();
            assert!((merged.mean - whole.mean).abs() < 1e-6);
            assert!((merged.std_error - whole.std_error).abs() < 1e-6);
            assert!((merged.spread.unwrap() - whole.spread.unwrap()).abs() < 1e-6);
        }
    }

    #[test]
    fn equals_the_batch_formulas() {
        let x = VALUES.map(|v| f64::from(v.0));
        let n = x.len() as f64;
        let mean = x.iter().sum::<f64>() / n;
        let e = all(&VALUES);
        let noise = VALUES.iter().map(|v| f64::from(v.1).powi(2)).sum::<f64>() / n;
        let spread = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) - noise).sqrt();
        assert!((f64::from(e.estimate().unwrap().spread.unwrap()) - spread).abs() < 1e-6);
    }

    #[test]
    fn pure_noise_is_weighted_and_real_variation_is_not() {
        // No variation beyond the noise: a precise event dominates.
        let noise = all(&[(1.0, 0.001), (1.05, 0.1), (0.95, 0.1), (1.0, 0.1)]).estimate().unwrap();
        assert!((noise.mean - 1.0).abs() < 1e-3 && noise.spread == Some(0.0));
        // Much more variation than noise: all events count alike.
        let real = all(&[(1.0, 0.001), (1.5, 0.01), (0.5, 0.01), (1.4, 0.01)]).estimate().unwrap();
        assert!((real.mean - 1.1).abs() < 1e-3, "{}", real.mean);
        assert!(real.std_error > 0.2);
    }

    #[test]
    fn a_million_events_do_not_stagnate() {
        let mut e = Estimator::default();
        for i in 0..1_000_000_u32 {
            // The second half is higher by a thousandth.
            let value = 0.78 + if i < 500_000 { 0.0 } else { 0.001 };
            e.add(coefficient(value, 0.0005));
        }
        let mean = e.estimate().unwrap().mean;
        assert!((mean - 0.7805).abs() < 1e-6, "{mean}");
    }
}
