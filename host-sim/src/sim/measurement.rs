//! Measurement terms, between the force in the cable and the log; each is off unless given.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, above_zero, between, not_negative, positive, require};
pub use super::coloured::Coloured;
pub use super::lag::Lag;

/// Measurement terms, each off unless given.
///
/// In the order in which they act: flop of the cable adds to the force; the cell lags;
/// hum of the mains adds; the converter averages over its aperture; scale and zero errors
/// and noise add; the range cuts off; the step rounds; faults strike single samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Measurement {
    /// The cable swings up and down after it fell slack-ish on the ice.
    pub flop: Option<Flop>,
    /// Hum of the mains on the cell's leads.
    pub hum: Option<Hum>,
    /// Time over which the converter averages, from the sample's time on, s.
    pub aperture_s: f64,
    /// The cell lags behind the force; not together with an aperture or jitter.
    pub lag: Option<Lag>,
    /// Zero and scale move evenly.
    pub ramp: Option<Ramp>,
    /// Drift of the zero with temperature.
    pub drift: Option<Drift>,
    /// One step of the zero.
    pub zero_step: Option<ZeroStep>,
    /// Standard deviation of white noise on each sample, N.
    pub white_n: f64,
    /// Noise whose neighbours are correlated.
    pub coloured: Option<Coloured>,
    /// Noise with a spectrum of 1/f: standard deviation within each decade of
    /// frequency, N.
    pub flicker_n: f64,
    /// Dead load on the cell, N: uses up range, and is taken off again.
    pub tare_n: f64,
    /// Largest force of the converter, N; off when zero.
    pub range_n: f64,
    /// Step of the converter, N; off when zero.
    pub step_n: f64,
    /// Misread codes; require `range_n`.
    pub spikes: Option<Chance>,
    /// Samples that are missing.
    pub dropped: Option<Chance>,
    /// Samples that come twice.
    pub repeated: Option<Chance>,
    /// Samples taken later than their stamps say.
    pub late: Option<Late>,
    /// Samples taken a little before or after their stamps.
    pub jitter: Option<Jitter>,
    /// Relative error by which the logger's clock is slow, 1e-6.
    pub clock_ppm: f64,
}

/// `amplitude_n exp(-decay t) sin(2 pi hz t)`, `t` from the moment of rest, while
/// the block rests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flop {
    /// Amplitude, N.
    pub amplitude_n: f64,
    /// Frequency, Hz.
    pub hz: f64,
    /// Decay, 1/s.
    pub decay_per_s: f64,
}

/// A sine of constant amplitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hum {
    /// Amplitude, N.
    pub amplitude_n: f64,
    /// Frequency, Hz.
    pub hz: f64,
}

/// Zero and scale that move evenly from the start of the record on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Ramp {
    /// Rate of change of the zero, N/s.
    pub zero_n_per_s: f64,
    /// Relative rate of change of the scale, 1/s.
    pub span_per_s: f64,
}

/// Samples taken a normally distributed time off their stamps, by at most four standard
/// deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jitter {
    /// Standard deviation, s, at most a fifth of the sampling period.
    pub std_s: f64,
}

/// The zero follows the temperature: `amplitude_n sin(2 pi t / period_s)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drift {
    /// Amplitude, N.
    pub amplitude_n: f64,
    /// Period, s.
    pub period_s: f64,
}

/// One step of the zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ZeroStep {
    /// When, s.
    pub at_s: f64,
    /// How much, N.
    pub height_n: f64,
}

/// Something that strikes each sample with a probability. A spike is the
/// converter's largest code, `2^n - 1`, or its code -1, one as often as the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chance {
    /// Probability, 0 to 1.
    pub probability: f64,
}

/// Samples taken late.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Late {
    /// Probability, 0 to 1.
    pub probability: f64,
    /// Delay, s, at most one sampling period.
    pub delay_s: f64,
}

impl Measurement {
    pub(super) fn validate(&self, rate_hz: f64) -> Result<(), SceneError> {
        between("measurement.aperture_s", self.aperture_s, 0.0, 1.0 / rate_hz)?;
        not_negative("measurement.white_n", self.white_n)?;
        not_negative("measurement.flicker_n", self.flicker_n)?;
        not_negative("measurement.range_n", self.range_n)?;
        not_negative("measurement.step_n", self.step_n)?;
        between("measurement.tare_n", self.tare_n, -1e9, 1e9)?;
        between("measurement.clock_ppm", self.clock_ppm, -1e5, 1e5)?;
        self.validate_waves()?;
        self.validate_cell(rate_hz)?;
        self.validate_faults(rate_hz)
    }

    fn validate_waves(&self) -> Result<(), SceneError> {
        if let Some(flop) = &self.flop {
            not_negative("measurement.flop.amplitude_n", flop.amplitude_n)?;
            // Each of its periods is integrated.
            above_zero("measurement.flop.hz", flop.hz, 1e4)?;
            not_negative("measurement.flop.decay_per_s", flop.decay_per_s)?;
        }
        if let Some(hum) = &self.hum {
            not_negative("measurement.hum.amplitude_n", hum.amplitude_n)?;
            positive("measurement.hum.hz", hum.hz)?;
        }
        if let Some(drift) = &self.drift {
            not_negative("measurement.drift.amplitude_n", drift.amplitude_n)?;
            positive("measurement.drift.period_s", drift.period_s)?;
        }
        if let Some(step) = &self.zero_step {
            not_negative("measurement.zero_step.at_s", step.at_s)?;
            between("measurement.zero_step.height_n", step.height_n, -1e9, 1e9)?;
        }
        Ok(())
    }

    fn validate_cell(&self, rate_hz: f64) -> Result<(), SceneError> {
        self.coloured.as_ref().map_or(Ok(()), |c| c.validate())?;
        self.lag.as_ref().map_or(Ok(()), |l| l.validate())?;
        require(self.lag.is_none() || self.aperture_s <= 0.0, || {
            "measurement.lag: not together with measurement.aperture_s".to_owned()
        })?;
        let ramp = self.ramp.unwrap_or_default();
        between("measurement.ramp.zero_n_per_s", ramp.zero_n_per_s, -1e6, 1e6)?;
        between("measurement.ramp.span_per_s", ramp.span_per_s, -1.0, 1.0)?;
        let jitter_s = self.jitter.map_or(0.0, |j| j.std_s);
        require(self.lag.is_none() || jitter_s <= 0.0, || {
            "measurement.lag: not together with measurement.jitter".to_owned()
        })?;
        between("measurement.jitter.std_s", jitter_s, 0.0, 0.2 / rate_hz + 1e-12)
    }

    fn validate_faults(&self, rate_hz: f64) -> Result<(), SceneError> {
        let chances =
            [("spikes", self.spikes), ("dropped", self.dropped), ("repeated", self.repeated)];
        for (name, chance) in chances {
            let probability = chance.map_or(0.0, |c| c.probability);
            between(&format!("measurement.{name}.probability"), probability, 0.0, 1.0)?;
        }
        require(self.spikes.is_none() || self.range_n > 0.0, || {
            "measurement.spikes: give measurement.range_n, a spike is the largest code".to_owned()
        })?;
        if let Some(late) = &self.late {
            between("measurement.late.probability", late.probability, 0.0, 1.0)?;
            between("measurement.late.delay_s", late.delay_s, 0.0, 1.0 / rate_hz)?;
        }
        Ok(())
    }
}
