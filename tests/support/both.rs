//! Runs the core in single and in double precision on the same samples.

use floe::sim::Scene;
use floe_core::{
    Coefficient, Config, Counts, Event, InputStd, Newtons, Pipeline, RawSample, Reading,
};

use crate::wide;

/// The pipelines in both precisions.
#[derive(Clone, Debug)]
pub struct Both {
    /// The core in single precision, as shipped.
    pub single: Pipeline,
    /// The core in double precision.
    pub double: wide::Pipeline,
    /// Events of both, in order.
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

    /// Takes a force, N, rounded for single precision only.
    pub fn force(&mut self, index: u32, force_n: f64) {
        let single = Reading::Force(Newtons(force_n as f32));
        self.step(index, single, wide::Reading::Force(wide::Newtons(force_n)));
    }

    /// Takes a converter's code.
    pub fn counts(&mut self, index: u32, counts: i32) {
        let single = Reading::Counts(Counts(counts));
        self.step(index, single, wide::Reading::Counts(wide::Counts(counts)));
    }

    fn step(&mut self, index: u32, single: Reading, double: wide::Reading) {
        self.events.0.extend(self.single.step(RawSample { index, reading: single }).event);
        let double = self.double.step(wide::RawSample { index, reading: double });
        self.events.1.extend(double.event);
    }

    /// Ends the test.
    pub fn finish(&mut self) {
        let Self { single, double, events } = self;
        events.0.extend(std::iter::from_fn(|| single.finish()));
        events.1.extend(std::iter::from_fn(|| double.finish()));
    }
}

/// Configuration of the core for a scene.
#[must_use]
pub fn config(scene: &Scene) -> Config {
    let range_n = scene.measurement.range_n - scene.measurement.tare_n.abs();
    Config {
        rate_hz: scene.rate_hz as f32,
        weight_n: scene.weight_n as f32,
        slope_rad: scene.slope_rad() as f32,
        range_n: (scene.measurement.range_n > 0.0).then_some(range_n as f32),
        winch_m_per_s: Some(scene.winch_m_per_s as f32),
        std: InputStd::EXACT,
        ..Config::default()
    }
}

/// The configuration in double precision, with the values rounded to single precision.
fn widened(config: &Config) -> wide::Config {
    let floe_core::Calibration { tare_counts, counts_per_n, range_counts } = config.calibration;
    let counts_per_n = counts_per_n.into();
    wide::Config {
        rate_hz: config.rate_hz.into(),
        weight_n: config.weight_n.into(),
        mass_kg: config.mass_kg.map(f64::from),
        slope_rad: config.slope_rad.into(),
        winch_m_per_s: config.winch_m_per_s.map(f64::from),
        range_n: config.range_n.map(f64::from),
        calibration: wide::Calibration { tare_counts, counts_per_n, range_counts },
        effects: wide::Effects::from_mask(config.effects.mask()),
        std: wide::InputStd::EXACT,
    }
}

/// Differences between the precisions.
#[derive(Clone, Debug, Default)]
pub struct Differences {
    /// Differences of `mu_s` and `mu`, in stated standard deviations of the event.
    pub coefficients: [Vec<f64>; 2],
    /// Differences of the onset, sampling periods.
    pub onset: Vec<f64>,
    /// Number of events, or coefficients of an event, that only one precision has.
    pub alone: usize,
}

impl Differences {
    /// Adds the events of a test.
    pub fn add(&mut self, (single, double): &(Vec<Event>, Vec<wide::Event>)) {
        let mut left = single.as_slice();
        for event in double {
            let time = event.onset.index as f64 + event.onset.fraction;
            let near = |s: &Event| (periods(s) - time).abs() < 1.0;
            match left.iter().position(near) {
                Some(place) => {
                    self.alone += place;
                    self.onset.push(periods(&left[place]) - time);
                    self.pair(0, left[place].mu_s, event.mu_s);
                    self.pair(1, left[place].mu, event.mu);
                    left = &left[place + 1..];
                }
                None => self.alone += 1,
            }
        }
        self.alone += left.len();
    }

    fn pair(&mut self, which: usize, a: Option<Coefficient>, b: Option<wide::Coefficient>) {
        match (a, b) {
            (Some(a), Some(b)) => {
                self.coefficients[which].push((f64::from(a.value) - b.value) / b.std);
            }
            (None, None) => {}
            _ => self.alone += 1,
        }
    }
}

/// Onset of an event, in sampling periods.
#[must_use]
pub fn periods(event: &Event) -> f64 {
    event.onset.index as f64 + f64::from(event.onset.fraction)
}
