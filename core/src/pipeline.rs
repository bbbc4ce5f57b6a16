//! The one entry point: a sample in, what is known out.

use crate::config::{Config, ConfigError};
use crate::event::Event;
use crate::report::{Counters, Report};
use crate::sample::{ForceSample, Phase, RawSample, SampleFlag};

/// What one sample led to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Step {
    /// The sample after calibration. It may still be declared a spike by the
    /// next one, see [`Step::spike`].
    pub sample: ForceSample,
    /// Index of an earlier sample that is now known to be a spike.
    pub spike: Option<u64>,
    /// What the block is doing.
    pub phase: Phase,
    /// An event that is now complete.
    pub event: Option<Event>,
}

/// The whole computation for one test.
#[derive(Clone, Debug)]
pub struct Pipeline {
    counters: Counters,
}

impl Pipeline {
    /// Starts a test.
    ///
    /// # Errors
    /// A configuration value out of its range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate()?;
        Ok(Self { counters: Counters::default() })
    }

    /// Takes one sample. Bounded in time and memory; never panics.
    pub fn step(&mut self, raw: RawSample) -> Step {
        self.counters.samples += 1;
        let sample =
            ForceSample { index: raw.index, force_n: None, flag: SampleFlag::Good, gap: 0 };
        Step { sample, spike: None, phase: Phase::Unknown, event: None }
    }

    /// Ends the test: completes what is pending, one event a call, until `None`.
    pub fn finish(&mut self) -> Option<Event> {
        None
    }

    /// The result so far.
    #[must_use]
    pub fn report(&self) -> Report {
        Report {
            counters: self.counters,
            events: 0,
            mu_s: None,
            mu: None,
            noise_n: None,
            loading_rate_n_per_s: None,
            omega_rad_per_s: None,
            stiffness_n_per_m: None,
            recurrence_s: None,
        }
    }
}
