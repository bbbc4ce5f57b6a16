//! A log for the tests of the report: the exact solution of the model, event by event, with white
//! noise and a small variation between events.

use floe_core::{ForceSample, SampleFlag, Step};

use super::Recorder;
use crate::replay::events::Events;
use crate::replay::quantities::Quantities;
use crate::replay::result::{
    CoefficientSummary, EstimateSummary, EventSummary, LogSummary, ReplayResult, SCHEMA,
    TestSummary,
};

const WEIGHT_N: f64 = 630.0;
const STIFFNESS_N_PER_M: f64 = 23_000.0;
const LOADING_N_PER_S: f64 = 360.0;
const NOISE_N: f64 = 2.0;
const RATE_HZ: f64 = 16.0;
const SEED: u64 = 0x5EED;
/// Standard deviation of either coefficient between events, relative.
const VARIATION: f64 = 0.004;

/// Samples and result of a test.
pub(crate) struct SampleLog {
    pub times_s: Vec<f64>,
    pub steps: Vec<Step>,
    pub result: ReplayResult,
}

/// White noise from a 64-bit linear congruential generator.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn omega() -> f64 {
    (STIFFNESS_N_PER_M / (WEIGHT_N / floe_core::units::STANDARD_GRAVITY_M_PER_S2)).sqrt()
}

/// The event that follows a re-stick at `from_s` with `from_n`.
fn event(index: u32, from_s: f64, from_n: f64, noise: &mut Noise) -> EventSummary {
    let mu_s = 1.24 * (1.0 + VARIATION * noise.normal());
    let mu = 0.78 * (1.0 + VARIATION * noise.normal());
    let (fs, fp, beside) = (mu_s * WEIGHT_N, mu * WEIGHT_N, LOADING_N_PER_S / omega());
    let stick_s = (fs - from_n) / LOADING_N_PER_S;
    let slip_s = (2.0 * beside.atan2(fs - fp) + std::f64::consts::PI) / omega();
    let onset_s = from_s + stick_s;
    EventSummary {
        index,
        onset_s,
        stop_s: onset_s + slip_s,
        static_force_n: fs,
        dynamic_force_n: fp,
        peak_force_n: fp + (fs - fp).hypot(beside),
        restick_force_n: 2.0 * fp - fs,
        mu_s: Some(mu_s),
        mu_s_std: Some(0.25 * NOISE_N / WEIGHT_N),
        mu: Some(mu),
        mu_std: Some(0.14 * NOISE_N / WEIGHT_N),
        stick_s: (index > 0).then_some(stick_s),
        slip_s,
        loading_rate_n_per_s: LOADING_N_PER_S,
        omega_rad_per_s: Some(omega()),
        quality: "good".into(),
        mu_s_systematic_std: Some(0.004),
        mu_systematic_std: Some(0.003),
        mu_s_combined_std: Some(0.0041),
        mu_combined_std: Some(0.0031),
        mu_s_ci95: Some([mu_s - 0.0082, mu_s + 0.0082]),
        mu_ci95: Some([mu - 0.0062, mu + 0.0062]),
        slip_length_m: Some(0.03),
        energy_j: Some(15.0),
        slip_length_m_std: Some(0.0003),
        energy_j_std: Some(0.2),
        ..EventSummary::default()
    }
}

fn force_n(events: &[EventSummary], time_s: f64) -> f64 {
    let next = events.partition_point(|e| e.stop_s <= time_s);
    let Some(e) = events.get(next) else { return 0.0 };
    if time_s < e.onset_s {
        return e.static_force_n - LOADING_N_PER_S * (e.onset_s - time_s);
    }
    let (above, beside) = (e.static_force_n - e.dynamic_force_n, LOADING_N_PER_S / omega());
    let phase = omega() * (time_s - e.onset_s) - beside.atan2(above);
    e.dynamic_force_n + above.hypot(beside) * phase.cos()
}

/// Mean and uncertainty of these values.
fn coefficient(values: &[f64]) -> CoefficientSummary {
    let (n, systematic) = (values.len() as f64, 0.003_f64);
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let several = |value: f64| (values.len() > 1).then_some(value);
    let (random, combined) = ((variance / n).sqrt(), systematic.hypot((variance / n).sqrt()));
    CoefficientSummary {
        mean: (!values.is_empty()).then_some(mean),
        std_error: several(random),
        spread: several(variance.sqrt()),
        systematic_std: (!values.is_empty()).then_some(systematic),
        combined_std: several(combined),
        ci95: several(combined).map(|std| [mean - 1.96 * std, mean + 1.96 * std]),
        reason: (values.len() == 1).then_some("one event"),
    }
}

impl SampleLog {
    /// Test DFF8-13 for `duration_s`, at least two events long.
    pub fn dff8_13(duration_s: f64) -> Self {
        let mut noise = Noise(SEED);
        let mut events: Vec<EventSummary> = Vec::new();
        let (mut from_s, mut from_n) = (0.0, 0.0);
        while from_s < duration_s + 10.0 {
            let next = event(events.len() as u32, from_s, from_n, &mut noise);
            (from_s, from_n) = (next.stop_s, next.restick_force_n);
            events.push(next);
        }
        let samples = (duration_s * RATE_HZ) as u64;
        let times_s: Vec<f64> = (0..samples).map(|i| i as f64 / RATE_HZ).collect();
        let step = |(i, &t): (usize, &f64)| {
            let force = force_n(&events, t) + NOISE_N * noise.normal();
            step(i as u32, force as f32)
        };
        let steps = times_s.iter().enumerate().map(step).collect();
        events.retain(|e| e.stop_s < duration_s - 0.2);
        let result = result(events, samples, duration_s);
        Self { times_s, steps, result }
    }

    /// A log with troubles of the field: a slack event, a clipped one, an unresolved one, a gap,
    /// saturated samples and warnings.
    pub fn troubled(duration_s: f64) -> Self {
        let mut log = Self::dff8_13(duration_s);
        let [_, second, third, fourth, ..] = &mut log.result.events.kept[..] else { return log };
        second.quality = "unresolved".into();
        second.omega_rad_per_s = None;
        third.quality = "slack".into();
        third.slack = true;
        fourth.quality = "clipped".into();
        fourth.reason = Some("a gap or saturated samples hide the slip".into());
        (fourth.mu_s, fourth.mu_s_std, fourth.mu, fourth.mu_std) = (None, None, None, None);
        let hidden = (fourth.onset_s * RATE_HZ) as usize;
        for step in &mut log.steps[hidden..hidden + 3] {
            step.sample.force_n = None;
            step.sample.flag = SampleFlag::Saturated;
        }
        log.result.log.saturated = 3;
        log.result.log.missing = 12;
        log.result.log.warnings = vec![
            "the last line is cut off: it was left out".into(),
            "37 time stamps do not fit 16 Hz".into(),
        ];
        log.result.estimate.events -= 1;
        log
    }

    /// The log's samples without a result.
    pub fn without_events(mut self) -> Self {
        self.keep_events(0);
        self
    }

    /// Only the first `n` events (0 or 1) and what they give.
    pub fn keep_events(&mut self, n: usize) {
        let result = &mut self.result;
        result.events.kept.truncate(n);
        let of = |pick: fn(&EventSummary) -> Option<f64>| {
            coefficient(&result.events.iter().filter_map(pick).collect::<Vec<_>>())
        };
        result.estimate =
            EstimateSummary { mu_s: of(|e| e.mu_s), mu: of(|e| e.mu), events: n as u64 };
        result.events.means.truncate(n);
        (result.quantities.recurrence_s, result.zero_n) = (None, None);
        if n == 0 {
            result.quantities = Quantities::default();
            result.budget.clear();
            result.noise_n = None;
        }
    }

    /// All forces times `factor`, for tests with other units.
    pub fn scaled(mut self, factor: f64) -> Self {
        for step in &mut self.steps {
            step.sample.force_n = step.sample.force_n.map(|f| f * factor as f32);
        }
        let result = &mut self.result;
        result.test.weight_n *= factor;
        result.noise_n = result.noise_n.map(|n| n * factor);
        let rate = &mut result.quantities.loading_rate_n_per_s;
        *rate = rate.map(|r| r * factor);
        for e in &mut result.events.kept {
            e.static_force_n *= factor;
            e.dynamic_force_n *= factor;
            e.peak_force_n *= factor;
            e.restick_force_n *= factor;
            e.loading_rate_n_per_s *= factor;
        }
        self
    }

    /// The samples as the report remembers them.
    pub fn recorder(&self) -> Recorder {
        let mut recorder = Recorder::new(RATE_HZ);
        self.times_s.iter().zip(&self.steps).for_each(|(&t, step)| recorder.push(t, step));
        recorder
    }

    /// The page.
    pub fn page(&self) -> String {
        super::render(&self.result, &self.recorder(), &super::Provenance::default())
    }
}

fn step(index: u32, force_n: f32) -> Step {
    Step::of(ForceSample { index, force_n: Some(force_n), flag: SampleFlag::Good, gap: 0 })
}

fn result(events: Vec<EventSummary>, samples: u64, duration_s: f64) -> ReplayResult {
    let of_mu_s: Vec<f64> = events.iter().filter_map(|e| e.mu_s).collect();
    let of_mu: Vec<f64> = events.iter().filter_map(|e| e.mu).collect();
    let after = |n: usize| [coefficient(&of_mu_s[..n]), coefficient(&of_mu[..n])];
    let mut kept = Events::default();
    for (n, event) in events.iter().enumerate() {
        kept.push(event.clone(), || after(n + 1)).unwrap();
    }
    let [mu_s, mu] = after(events.len());
    kept.finish(Quantities::default(), [mu_s, mu]);
    ReplayResult {
        schema: SCHEMA,
        log: LogSummary {
            path: "logs/dff8-13.csv".into(),
            format: "csv".into(),
            rate_hz: RATE_HZ,
            samples,
            duration_s,
            ..LogSummary::default()
        },
        test: TestSummary {
            test_id: Some("DFF8-13 (synthetic)".into()),
            weight_n: WEIGHT_N,
            slope_rad: 0.0,
            mass_kg: None,
        },
        estimate: EstimateSummary { mu_s, mu, events: events.len() as u64 },
        noise_n: Some(NOISE_N),
        quantities: Quantities {
            loading_rate_n_per_s: Some(LOADING_N_PER_S),
            omega_rad_per_s: Some(omega()),
            stiffness_n_per_m: Some(STIFFNESS_N_PER_M),
            recurrence_s: Some(1.78),
            ..Quantities::default()
        },
        budget: Vec::new(),
        zero_n: None,
        changes: Vec::new(),
        stretches: Default::default(),
        effects: Vec::new(),
        events: kept,
    }
}
