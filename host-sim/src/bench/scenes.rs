//! The scenes, simulated once for all methods.

use crate::sim::bound::LinearEvent;
use crate::sim::{Scene, SceneError, TrueEvent, simulate};

use super::method::{Sample, Setup};

/// Amount of simulation and timing.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Smallest number of events in a linear scene, over all its records.
    pub linear_events: usize,
    /// Number of records of a hard scene.
    pub hard_records: u64,
    /// Smallest number of timed samples per scene.
    pub timed_samples: usize,
}

impl Effort {
    /// For published figures: the relative uncertainty of an error is about 2 %.
    pub const FULL: Self = Self { linear_events: 1200, hard_records: 6, timed_samples: 6000 };
    /// For a quick look.
    pub const QUICK: Self = Self { linear_events: 100, hard_records: 1, timed_samples: 1000 };
}

/// Noise of the linear scenes, as a fraction of the weight.
const NOISE: [f64; 3] = [0.001, 0.003, 0.02];

/// Linear scenes: the model holds exactly, the noise is white.
const LINEAR: [(&str, &str); 5] = [
    ("dff8-13", include_str!("../../scenes/dff8-13.toml")),
    ("heavy", include_str!("../../scenes/linear/heavy.toml")),
    ("fast", include_str!("../../scenes/linear/fast.toml")),
    ("snow", include_str!("../../scenes/linear/snow.toml")),
    ("light", include_str!("../../scenes/linear/light.toml")),
];

macro_rules! hard {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../scenes/hard/", $name, ".toml")))),*]
    };
}

/// Scenes with properties of real tests beyond the linear model.
const HARD: [(&str, &str); 23] = hard![
    "flop",
    "sag_flop",
    "ripple",
    "varying",
    "shortening",
    "aperture",
    "unresolved",
    "slack",
    "small_drop",
    "no_flat_top",
    "uphill",
    "downhill",
    "dropped",
    "spikes",
    "coarse",
    "drift",
    "noisy",
    "tare",
    "creep",
    "partial",
    "smooth",
    "breaking",
    "all",
];

/// A true event with the bounds of its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Onset of the slip, s.
    pub onset_s: f64,
    /// Re-stick, s.
    pub stop_s: f64,
    /// True static coefficient, for any weight given to the methods.
    pub mu_s: f64,
    /// True dynamic coefficient, for any weight given to the methods.
    pub mu: f64,
    /// Cramér-Rao bounds of both coefficients with five free unknowns; `None` where the model does
    /// not hold or the samples do not determine them.
    pub bound: Option<(f64, f64)>,
}

/// One record.
#[derive(Clone, Debug)]
pub struct Record {
    /// The samples.
    pub samples: Vec<Sample>,
    /// Events that end within the record.
    pub events: Vec<Truth>,
}

impl Record {
    /// The judged events: all except the last, whose following stick line is cut by the end of the
    /// record.
    #[must_use]
    pub fn judged(&self) -> &[Truth] {
        self.events.split_last().map_or(&[], |(_, judged)| judged)
    }
}

/// A scene, simulated.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Name of the scene.
    pub name: &'static str,
    /// Whether the model holds exactly and the noise is white.
    pub linear: bool,
    /// White noise, as a fraction of the weight.
    pub noise: f64,
    /// Information for the methods.
    pub setup: Setup,
    /// Smallest number of timed samples, if the scene has enough.
    pub timed_samples: usize,
    /// The records, with seeds from 1, each with another sampling phase.
    pub records: Vec<Record>,
}

/// A scene that is still to be simulated.
#[derive(Clone, Debug)]
pub struct Plan {
    name: &'static str,
    linear: bool,
    scene: Scene,
    effort: Effort,
}

/// Sampling phase of a record, 0 to 1; multiples of the golden ratio are evenly spread for any
/// number of seeds.
#[must_use]
pub fn phase(seed: u64) -> f64 {
    (seed as f64 * 0.618_033_988_749_895).fract()
}

/// The scene with the sampling phase of a seed: its start is shifted by a fraction of a period.
#[must_use]
pub fn at_phase(scene: &Scene, seed: u64) -> Scene {
    let rate = scene.stiffness_n_per_m * scene.winch_m_per_s;
    let start_force_n = scene.start_force_n + phase(seed) * rate / scene.rate_hz;
    Scene { start_force_n, ..scene.clone() }
}

/// All scenes, in the order of the table.
///
/// # Errors
/// A scene cannot be read.
pub fn plans(effort: Effort) -> Result<Vec<Plan>, SceneError> {
    let mut plans = Vec::new();
    for (name, text) in LINEAR {
        for noise in NOISE {
            plans.push(Plan::new((name, text), Some(noise), effort)?);
        }
    }
    for scene in HARD {
        plans.push(Plan::new(scene, None, effort)?);
    }
    Ok(plans)
}

impl Plan {
    /// A plan; the scene is linear if white noise is given, as a fraction of the weight.
    fn new(
        (name, text): (&'static str, &str),
        noise: Option<f64>,
        effort: Effort,
    ) -> Result<Self, SceneError> {
        let mut scene = Scene::from_toml(text)?;
        if let Some(noise) = noise {
            scene.measurement.white_n = noise * scene.weight_n;
        }
        Ok(Self { name, linear: noise.is_some(), scene, effort })
    }

    /// Name of the scene.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Simulates the scene.
    ///
    /// # Errors
    /// A value is out of its range, or the integrator fails.
    pub fn run(&self) -> Result<Trial, SceneError> {
        let mut records = Vec::new();
        let mut events = 0;
        for seed in 1.. {
            let record = self.record(seed)?;
            events += record.events.len();
            let found_none = record.events.is_empty();
            records.push(record);
            let enough = if self.linear {
                events >= self.effort.linear_events || found_none
            } else {
                seed >= self.effort.hard_records
            };
            if enough {
                break;
            }
        }
        Ok(Trial {
            name: self.name,
            linear: self.linear,
            noise: self.scene.measurement.white_n / self.scene.weight_n,
            setup: self.setup(),
            timed_samples: self.effort.timed_samples,
            records,
        })
    }

    fn setup(&self) -> Setup {
        let range_n = self.scene.measurement.range_n - self.scene.measurement.tare_n.abs();
        Setup {
            rate_hz: self.scene.rate_hz,
            weight_n: self.scene.weight_n,
            slope_rad: self.scene.slope_rad(),
            range_n: (self.scene.measurement.range_n > 0.0).then_some(range_n),
        }
    }

    fn record(&self, seed: u64) -> Result<Record, SceneError> {
        let simulation = simulate(&at_phase(&self.scene, seed), seed)?;
        let sample = |s: &crate::sim::Sample| Sample { index: s.index, force_n: s.force_n as f32 };
        let samples: Vec<Sample> = simulation.samples.iter().map(sample).collect();
        let events = self.truths(&samples, &simulation.events);
        Ok(Record { samples, events })
    }

    fn truths(&self, samples: &[Sample], events: &[TrueEvent]) -> Vec<Truth> {
        let setup = self.setup();
        let truth = |(i, event): (usize, &TrueEvent)| {
            let end_s = events.get(i + 1).map_or(self.scene.duration_s, |next| next.onset_s);
            let bound = self.bound(samples, event, end_s).map(|(static_n, dynamic_n)| {
                (static_n * setup.per_newton(), dynamic_n * setup.per_newton())
            });
            Truth {
                onset_s: event.onset_s,
                stop_s: event.stop_s,
                mu_s: event.mu_s,
                mu: event.mu,
                bound,
            }
        };
        events.iter().enumerate().map(truth).collect()
    }

    /// Bounds of `Fs` and `Fp`, N, for the samples of the record.
    fn bound(&self, samples: &[Sample], event: &TrueEvent, end_s: f64) -> Option<(f64, f64)> {
        let noise_n = self.scene.measurement.white_n;
        if noise_n <= 0.0 || !self.scene.is_linear() || event.slack {
            return None;
        }
        let from_s = event.onset_s - event.stick_s;
        let times_s = samples.iter().map(|s| s.index as f64 / self.scene.rate_hz);
        let own = times_s.filter(|t| (from_s..end_s).contains(t));
        LinearEvent::from(event).bound(own, noise_n).map(|b| (b.static_n, b.dynamic_n))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The linear scenes with a given noise, N.
    pub fn linear(noise_n: f64, linear_events: usize) -> Vec<Trial> {
        let effort = Effort { linear_events, ..Effort::QUICK };
        let trial = |scene: &(&'static str, &str)| {
            let weight_n = Scene::from_toml(scene.1).unwrap().weight_n;
            Plan::new(*scene, Some(noise_n / weight_n), effort).unwrap().run().unwrap()
        };
        LINEAR.iter().map(trial).collect()
    }

    #[test]
    fn records_start_at_different_phases_and_have_bounds() {
        let trials = linear(2.0, 150);
        let records = &trials[0].records;
        assert!(records.len() >= 2);
        assert!(records[0].samples != records[1].samples);
        let events = records.iter().flat_map(|record| record.judged());
        assert!(events.clone().count() >= 100);
        assert!(events.clone().all(|e| (e.mu_s - 1.24).abs() < 1e-9));
        // 0.32 and 0.14 sigma over the weight, depending on the sampling phase.
        let bound = |e: &Truth| e.bound.unwrap();
        assert!(events.clone().all(|e| (0.0005..0.002).contains(&bound(e).0)));
        assert!(events.clone().all(|e| (0.0003..0.0006).contains(&bound(e).1)));
    }
}
