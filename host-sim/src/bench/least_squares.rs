//! Least-squares fit of the model to each whole event, offline and in double precision: the
//! reference for accuracy.
//!
//! All samples are kept. A first pass finds the turning points of the record. Then five unknowns
//! (`t0`, `k w`, `Fs`, `Fp`, `omega`; `k w` and `omega` as logarithms, so that they stay positive)
//! are fitted to all samples from the stop before an event to the onset after it. A second fit uses
//! the ends and the usual `omega` from the first fits. The solver is the crate
//! `levenberg-marquardt`.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DVector, Dyn, OMatrix, SVector, U5};

use crate::log::timing::median;
use crate::sim::bound::LinearEvent;

use super::method::{Found, Method, Sample, Setup, Tick};
use super::segments::{Segment, segments};

/// The method.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    setup: Setup,
    samples: Vec<Sample>,
    /// Events not returned yet, the last one first; `None` before the end of the record.
    found: Option<Vec<Found>>,
}

impl Method for LeastSquares {
    const NAME: &'static str = "least squares (offline)";
    const STREAMS: bool = false;

    fn new(setup: &Setup) -> Self {
        Self { setup: *setup, samples: Vec::new(), found: None }
    }

    fn step(&mut self, sample: Sample) -> Tick {
        let last = self.samples.last();
        if self.setup.is_force(sample.force_n) && last.is_none_or(|l| l.index < sample.index) {
            self.samples.push(sample);
        }
        Tick::default()
    }

    fn finish(&mut self) -> Option<Found> {
        let (setup, samples) = (&self.setup, &self.samples);
        let all = || events(setup, samples).into_iter().rev().collect();
        self.found.get_or_insert_with(all).pop()
    }

    fn state_bytes(&self) -> usize {
        size_of::<Self>() + self.samples.len() * size_of::<Sample>()
    }
}

/// Force of a linear event, N: line, ellipse, line.
#[must_use]
pub fn force_n(event: &LinearEvent, time_s: f64) -> f64 {
    let t = time_s - event.onset_s;
    let slip_s = event.slip_s();
    let a = event.static_force_n - event.dynamic_force_n;
    if t < 0.0 {
        event.static_force_n + event.loading_rate_n_per_s * t
    } else if t < slip_s {
        let (sin, cos) = (event.omega_rad_per_s * t).sin_cos();
        event.dynamic_force_n + a * cos + event.loading_rate_n_per_s / event.omega_rad_per_s * sin
    } else {
        event.dynamic_force_n - a + event.loading_rate_n_per_s * (t - slip_s)
    }
}

/// A least-squares problem: samples of one event, and a trial event.
#[derive(Clone, Debug)]
struct Problem<'a> {
    /// Time, s, and force, N.
    points: &'a [(f64, f64)],
    event: LinearEvent,
    /// Largest `omega`, rad/s: for a slip shorter than a quarter period the samples only show a
    /// jump.
    most_omega: f64,
}

/// Force of an event minus the measured force at each point, N.
fn residuals_n(event: LinearEvent, points: &[(f64, f64)]) -> impl Iterator<Item = f64> + '_ {
    points.iter().map(move |&(time_s, measured_n)| force_n(&event, time_s) - measured_n)
}

fn squares_n2(event: LinearEvent, points: &[(f64, f64)]) -> f64 {
    residuals_n(event, points).map(|r| r * r).sum()
}

impl Problem<'_> {
    fn is_possible(&self) -> bool {
        self.event.omega_rad_per_s.is_finite() && self.event.loading_rate_n_per_s.is_finite()
    }
}

impl LeastSquaresProblem<f64, Dyn, U5> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U5>;
    type ParameterStorage = Owned<f64, U5>;

    fn set_params(&mut self, x: &SVector<f64, 5>) {
        self.event = LinearEvent {
            onset_s: x[0],
            loading_rate_n_per_s: x[1].exp(),
            static_force_n: x[2],
            dynamic_force_n: x[3],
            omega_rad_per_s: x[4].exp().min(self.most_omega),
        };
    }

    fn params(&self) -> SVector<f64, 5> {
        let e = &self.event;
        SVector::from([
            e.onset_s,
            e.loading_rate_n_per_s.ln(),
            e.static_force_n,
            e.dynamic_force_n,
            e.omega_rad_per_s.ln(),
        ])
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let length = self.points.len();
        self.is_possible()
            .then(|| DVector::from_iterator(length, residuals_n(self.event, self.points)))
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U5>> {
        let e = &self.event;
        let rows = self.points.iter().map(|&(time_s, _)| {
            let [t0, rate, static_n, dynamic_n, omega] = e.gradient(time_s);
            [t0, rate * e.loading_rate_n_per_s, static_n, dynamic_n, omega * e.omega_rad_per_s]
        });
        let cells: Vec<f64> = rows.flatten().collect();
        Some(OMatrix::<f64, Dyn, U5>::from_row_slice(&cells))
    }
}

/// The events of a record.
fn events(setup: &Setup, samples: &[Sample]) -> Vec<Found> {
    let segments = segments(setup, samples);
    let time_s = |s: &Sample| s.index as f64 / setup.rate_hz;
    let points: Vec<(f64, f64)> =
        samples.iter().map(|s| (time_s(s), f64::from(s.force_n))).collect();
    let within = |from_s: f64, to_s: f64| {
        let place = |t: f64| points.partition_point(|p| p.0 <= t);
        points.get(place(from_s)..place(to_s)).unwrap_or_default()
    };
    let rough = |segment: &Segment| {
        let (from_s, to_s) = (segment.from_s, segment.to_s);
        let points = within(from_s, to_s);
        fit(setup, points, guess(points, segment)?)
    };
    let first: Vec<Option<LinearEvent>> = segments.iter().map(rough).collect();
    let omegas = first.iter().flatten().map(|e| e.omega_rad_per_s);
    let omega = median(omegas.collect()).unwrap_or(1.0);
    let second = |(i, segment): (usize, &Segment)| {
        let fitted = |i: usize| first.get(i).copied().flatten();
        let before = i.checked_sub(1).and_then(fitted);
        let from_s = before.map_or(segment.from_s, |e| e.onset_s + e.slip_s());
        let to_s = fitted(i + 1).map_or(segment.to_s, |e| e.onset_s);
        let points = within(from_s, to_s);
        let event = fitted(i).and_then(|event| fit(setup, points, with_omega(event, omega)));
        read(setup, segment, points, event)
    };
    segments.iter().enumerate().map(second).collect()
}

fn fit(setup: &Setup, points: &[(f64, f64)], event: LinearEvent) -> Option<LinearEvent> {
    if points.len() <= 5 {
        return None;
    }
    let most_omega = 4.0 * std::f64::consts::PI * setup.rate_hz;
    let problem = Problem { points, event, most_omega };
    let (problem, report) = LevenbergMarquardt::new().minimize(problem);
    let resolved = problem.event.omega_rad_per_s < most_omega;
    let usable = report.objective_function.is_finite() && problem.is_possible() && resolved;
    usable.then_some(problem.event)
}

/// The best of several trial onsets and durations of the slip.
fn guess(points: &[(f64, f64)], segment: &Segment) -> Option<LinearEvent> {
    let (peak_s, peak_n) = segment.peak;
    let (low_s, low_n) = segment.low;
    let drop_n = peak_n - low_n;
    let rate = rise(points, segment.from_s, peak_s).max(1e-3 * drop_n);
    let trial = |slip_s: f64, onset_s: f64| {
        let half = (rate * slip_s).atan2(std::f64::consts::PI * 0.5 * drop_n);
        LinearEvent {
            onset_s,
            loading_rate_n_per_s: rate,
            static_force_n: peak_n,
            dynamic_force_n: peak_n - 0.5 * drop_n,
            omega_rad_per_s: (std::f64::consts::PI + 2.0 * half) / slip_s,
        }
    };
    let fall_s = low_s - peak_s;
    let middle_s = 0.5 * (peak_s + low_s);
    let trials = [0.6, 0.8, 1.0, 1.25, 1.6].into_iter().flat_map(|part| {
        let slip_s = part * fall_s;
        [-0.3, -0.15, 0.0, 0.15, 0.3].map(|s| trial(slip_s, middle_s + s * fall_s - 0.5 * slip_s))
    });
    let cost = |event: &LinearEvent| squares_n2(*event, points);
    trials.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// An event with the usual `omega` and the same middle of its slip. With two samples in a slip two
/// different events fit exactly; this selects the usual one.
fn with_omega(event: LinearEvent, omega: f64) -> LinearEvent {
    let usual = LinearEvent { omega_rad_per_s: omega, ..event };
    let onset_s = event.onset_s + 0.5 * (event.slip_s() - usual.slip_s());
    LinearEvent { onset_s, ..usual }
}

/// Mean rate of the force between two times, N/s, by a least-squares line.
fn rise(points: &[(f64, f64)], from_s: f64, to_s: f64) -> f64 {
    let line = || points.iter().filter(|p| p.0 > from_s && p.0 < to_s);
    let count = line().count() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| line().map(f).sum::<f64>() / count;
    let (time_s, force_n) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = line().map(|p| (p.0 - time_s) * (p.1 - force_n)).sum();
    let variance: f64 = line().map(|p| (p.0 - time_s).powi(2)).sum();
    if variance > 0.0 { covariance / variance } else { 0.0 }
}

fn read(
    setup: &Setup,
    segment: &Segment,
    points: &[(f64, f64)],
    event: Option<LinearEvent>,
) -> Found {
    let Some(event) = event else {
        return Found { onset_s: segment.peak.0, mu_s: None, mu: None };
    };
    let free = points.len().saturating_sub(5).max(1) as f64;
    let noise_n = (squares_n2(event, points) / free).sqrt();
    let bound = event.bound(points.iter().map(|p| p.0), noise_n);
    Found {
        onset_s: event.onset_s,
        mu_s: setup.value(event.static_force_n, bound.map(|b| b.static_n)),
        mu: setup.value(event.dynamic_force_n, bound.map(|b| b.dynamic_n)),
    }
}
