//! Forces written by hand.

use floe_core::detector::{Detector, Transition};
use floe_core::{Config, Effects, Event};
use floe_tests::feed;

/// Forces in order; `None` is a sampling period without a sample.
#[derive(Clone, Default)]
pub struct Script {
    pub forces: Vec<Option<f64>>,
    noise_n: f64,
}

/// Fixed values that resemble noise, with mean zero and standard deviation one.
const ZIGZAG: [f64; 11] = [0.3, -1.2, 0.8, -0.1, 1.5, -0.9, 0.2, -1.7, 1.1, 0.6, -0.6];

impl Script {
    pub fn noisy(noise_n: f64) -> Self {
        Self { noise_n, ..Self::default() }
    }

    pub fn push(mut self, forces: impl IntoIterator<Item = f64>) -> Self {
        for force_n in forces {
            let noise = ZIGZAG[self.forces.len() % ZIGZAG.len()];
            self.forces.push(Some(force_n + self.noise_n * noise));
        }
        self
    }

    /// Appends `count` samples on a line.
    pub fn line(self, from_n: f64, rise_n: f64, count: u32) -> Self {
        self.push((0..count).map(|i| from_n + rise_n * f64::from(i)))
    }

    /// Appends the usual stick line: 30 samples, 200 N to 780 N.
    pub fn stick(self) -> Self {
        self.line(200.0, 20.0, 30)
    }

    /// Appends the usual slip after it; the lowest sample is the last one.
    pub fn slip(self) -> Self {
        self.push([640.0, 370.0, 180.0])
    }

    pub fn gap(mut self, count: usize) -> Self {
        self.forces.extend(vec![None; count]);
        self
    }

    pub fn at(mut self, index: usize, force_n: f64) -> Self {
        self.forces[index] = Some(force_n);
        self
    }

    pub fn samples(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        (0..).zip(&self.forces).filter_map(|(index, force)| Some((index, (*force)?)))
    }

    pub fn transitions(&self) -> Vec<String> {
        self.transitions_with(|_| false)
    }

    /// Transitions of the detector when the caller has no room for an event at the samples where
    /// `waits`.
    pub fn transitions_with(&self, waits: impl Fn(u32) -> bool) -> Vec<String> {
        let mut detector = Detector::new(16.0, Effects::default());
        let told = |(index, force_n): (u32, f64)| {
            let transition = detector.step(index, force_n as f32, waits(index))?;
            Some(match transition {
                Transition::Onset => format!("{index} onset"),
                Transition::Restick { peak, low } => {
                    format!("{index} restick {} {}", peak.index, low.index)
                }
                Transition::Cancelled => format!("{index} cancelled"),
                Transition::Lost => format!("{index} lost"),
            })
        };
        self.samples().filter_map(told).collect()
    }

    pub fn becomes(&self, expected: &[&str]) {
        assert_eq!(self.transitions(), expected);
    }

    /// Events of the whole pipeline, with a weight of 630 N.
    pub fn events(&self) -> Vec<Event> {
        let config = Config { weight_n: 630.0, ..Config::default() };
        feed::replay(&config, self.samples().map(|(i, f)| feed::force(i, f))).events
    }
}
