//! The same samples through the core in single and in double precision.

use floe_core::{Config, Event, Pipeline, RawSample, Reading, Report};

use crate::wide;

/// The two pipelines side by side.
#[derive(Clone, Debug)]
pub struct Both {
    /// As shipped.
    pub single: Pipeline,
    /// The reference.
    pub double: wide::Pipeline,
    /// Events of either, in order.
    pub events: (Vec<Event>, Vec<wide::Event>),
}

impl Both {
    /// Starts a test.
    ///
    /// # Panics
    /// The configuration is refused.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let single = Pipeline::new(config).expect("the configuration is valid");
        let double = wide::Pipeline::new(&widened(config)).expect("the configuration is valid");
        Self { single, double, events: (Vec::new(), Vec::new()) }
    }

    /// Takes a force, N: rounded for the one, as it is for the other.
    pub fn force(&mut self, index: u64, force_n: f64) {
        let single = Reading::Force(floe_core::Newtons(force_n as f32));
        let double = wide::Reading::Force(wide::Newtons(force_n));
        self.step(index, single, double);
    }

    /// Takes a converter's code.
    pub fn counts(&mut self, index: u64, counts: i32) {
        let single = Reading::Counts(floe_core::Counts(counts));
        let double = wide::Reading::Counts(wide::Counts(counts));
        self.step(index, single, double);
    }

    fn step(&mut self, index: u64, single: Reading, double: wide::Reading) {
        self.events.0.extend(self.single.step(RawSample { index, reading: single }).event);
        let step = self.double.step(wide::RawSample { index, reading: double });
        self.events.1.extend(step.event);
    }

    /// Ends the test.
    pub fn finish(&mut self) {
        while let Some(event) = self.single.finish() {
            self.events.0.push(event);
        }
        while let Some(event) = self.double.finish() {
            self.events.1.push(event);
        }
    }

    /// Both results.
    #[must_use]
    pub fn reports(&self) -> (Report, wide::Report) {
        (self.single.report(), self.double.report())
    }
}

/// The configuration, its numbers as single precision has them.
fn widened(config: &Config) -> wide::Config {
    let floe_core::Calibration { tare_counts, counts_per_n, range_counts } = config.calibration;
    let counts_per_n = counts_per_n.into();
    wide::Config {
        rate_hz: config.rate_hz.into(),
        weight_n: config.weight_n.into(),
        slope_rad: config.slope_rad.into(),
        winch_m_per_s: config.winch_m_per_s.map(f64::from),
        range_n: config.range_n.map(f64::from),
        calibration: wide::Calibration { tare_counts, counts_per_n, range_counts },
    }
}
