//! Conversion of codes to newtons; flags what is not a force.
//!
//! In: a [`Reading`]. Out: a force in newtons, or the flag that says why not. No
//! delay, no memory.

use crate::config::Config;
use crate::num::math::smaller;
use crate::sample::{Reading, SampleFlag};
use crate::units::{Counts, Newtons};

/// Largest force, N: no cable carries more, and beyond it sums of fourth powers may overflow.
const LARGEST_N: f32 = 1e9;

/// Calibration with its division done beforehand.
#[derive(Clone, Copy, Debug)]
pub struct Calibrator {
    tare_counts: i32,
    n_per_count: f32,
    range_counts: (i32, i32),
    range_n: f32,
}

impl Calibrator {
    /// From a validated configuration.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let calibration = &config.calibration;
        Self {
            tare_counts: calibration.tare_counts,
            n_per_count: 1.0 / calibration.counts_per_n,
            range_counts: calibration.range_counts,
            range_n: config.range_n.map_or(LARGEST_N, |range_n| smaller(range_n, LARGEST_N)),
        }
    }

    /// The force of a reading.
    ///
    /// # Errors
    /// [`SampleFlag::Saturated`] at or beyond the end of the converter's or the
    /// cell's range, [`SampleFlag::Rejected`] for a bad or non-finite reading.
    pub fn force_n(&self, reading: Reading) -> Result<f32, SampleFlag> {
        let force_n = match reading {
            Reading::Counts(Counts(counts)) => {
                if counts <= self.range_counts.0 || counts >= self.range_counts.1 {
                    return Err(SampleFlag::Saturated);
                }
                // Exact in integers: a large tare does not reduce the precision of a small force.
                let net = counts.checked_sub(self.tare_counts).ok_or(SampleFlag::Saturated)?;
                net as f32 * self.n_per_count
            }
            Reading::Force(Newtons(force_n)) => force_n,
            Reading::Bad(_) => return Err(SampleFlag::Rejected),
        };
        if force_n.abs() < self.range_n {
            Ok(force_n)
        } else if force_n.is_finite() {
            Err(SampleFlag::Saturated)
        } else {
            Err(SampleFlag::Rejected)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Calibration;
    use crate::sample::Fault;

    fn calibrator(tare_counts: i32, counts_per_n: f32) -> Calibrator {
        let calibration = Calibration { tare_counts, counts_per_n, ..Calibration::default() };
        Calibrator::new(&Config {
            weight_n: 1.0,
            range_n: Some(5000.0),
            calibration,
            ..Config::default()
        })
    }

    #[test]
    fn tare_span_and_polarity() {
        let counts = |c| Reading::Counts(Counts(c));
        for (tare, span, code, force) in [
            (0, 1.0, 7, 7.0),
            (100, 10.0, 150, 5.0),
            (100, -10.0, 150, -5.0),
            (8_000_000, 800.0, 8_000_100, 0.125),
            (-8_000_000, 10_000.0, 8_000_000, 1600.0),
        ] {
            let got = calibrator(tare, span).force_n(counts(code)).unwrap();
            assert!((got - force).abs() < 1e-6 * force.abs(), "{got} {force}");
        }
    }

    #[test]
    fn what_is_not_a_force_is_flagged() {
        let c = calibrator(0, 1.0);
        let saturated = Err(SampleFlag::Saturated);
        let rejected = Err(SampleFlag::Rejected);
        for (reading, flag) in [
            (Reading::Counts(Counts((1 << 23) - 1)), saturated),
            (Reading::Counts(Counts(-(1 << 23))), saturated),
            (Reading::Counts(Counts(i32::MIN)), saturated),
            (Reading::Counts(Counts(6000)), saturated),
            (Reading::Force(Newtons(-5000.0)), saturated),
            (Reading::Force(Newtons(f32::NAN)), rejected),
            (Reading::Force(Newtons(f32::INFINITY)), rejected),
            (Reading::Bad(Fault::Sentinel), rejected),
        ] {
            assert_eq!(c.force_n(reading), flag, "{reading:?}");
        }
        // No cable carries more than a billion newtons, whatever the cell's range is said to be.
        let wide = Calibrator::new(&Config { range_n: Some(1e30), ..Config::default() });
        assert_eq!(wide.force_n(Reading::Force(Newtons(1e20))), saturated);
    }
}
