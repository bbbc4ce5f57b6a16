//! One step of the integrator as a polynomial.

use super::physics::Physics;
use super::quadrature::GAUSS_5;
use super::root;
use super::state::{Phase, State};

/// Force on a taut cable or slack of a slack one, speed, distance, age of the contacts.
pub(super) type Vector = [f64; 4];
/// Number of points that determine a polynomial of degree 9.
pub(super) const COUNT: usize = 10;

/// Chebyshev points on 0 to 1.
pub(super) const NODES: [f64; COUNT] = [
    0.0,
    0.030_153_689_607_045_786,
    0.116_977_778_440_511,
    0.25,
    0.413_175_911_166_534_8,
    0.586_824_088_833_465_2,
    0.75,
    0.883_022_221_559_489,
    0.969_846_310_392_954_2,
    1.0,
];

/// One step, or the part of it before an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub(super) phase: Phase,
    pub(super) length_s: f64,
    at_nodes: [Vector; COUNT],
}

impl Step {
    /// A step from its values at [`NODES`].
    pub(super) fn new(phase: Phase, length_s: f64, at_nodes: [Vector; COUNT]) -> Self {
        Self { phase, length_s, at_nodes }
    }

    /// The state `t` seconds after the step's start, within the step.
    #[must_use]
    pub fn state(&self, from: &State, t: f64) -> State {
        let values = self.values(t / self.length_s);
        let state = State { time_s: from.time_s + t, ..*from };
        to_state(self.phase, values, state)
    }

    /// State vector at a fraction of the step, by barycentric interpolation.
    pub(super) fn values(&self, fraction: f64) -> Vector {
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        for (j, (node, values)) in NODES.iter().zip(&self.at_nodes).enumerate() {
            let distance = fraction - node;
            if distance == 0.0 {
                return *values;
            }
            let end = if j == 0 || j == NODES.len() - 1 { 0.5 } else { 1.0 };
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let weight = sign * end / distance;
            weights += weight;
            for (s, v) in sum.iter_mut().zip(values) {
                *s += weight * v;
            }
        }
        sum.map(|s| s / weights)
    }

    /// First fraction of the step at which `f` falls below zero, if it does.
    pub(super) fn first_fall(&self, f: impl Fn(f64, &Vector) -> f64) -> Option<f64> {
        let at = |fraction: f64| f(fraction, &self.values(fraction));
        let values = NODES.map(at);
        if values[0] < 0.0 {
            return Some(0.0);
        }
        let below = values.iter().skip(1).position(|&v| v < 0.0).map(|i| i + 1);
        if let Some(i) = below {
            let (before, after) = (NODES.get(i - 1)?, NODES.get(i)?);
            return Some(root::crossing(at, *before, *after));
        }
        let dip = self.dip(&values, at)?;
        (at(dip.1) < 0.0).then(|| root::crossing(at, dip.0, dip.1))
    }

    /// Fractions of a local minimum between nodes and of the point before it.
    fn dip(&self, values: &[f64; COUNT], at: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let lowest =
            |i: &usize| values.get(i - 1) > values.get(*i) && values.get(*i) < values.get(i + 1);
        let i = (1..COUNT - 1).find(lowest)?;
        let (before, after) = (*NODES.get(i - 1)?, *NODES.get(i + 1)?);
        Some((before, root::lowest(at, before, after)))
    }

    /// Largest force in the first `duration_s` of the step, N.
    #[must_use]
    pub fn peak_force_n(&self, duration_s: f64) -> f64 {
        let end = duration_s / self.length_s;
        let below = |fraction: f64| -self.values(fraction)[0];
        -below(root::lowest(below, 0.0, end)).min(below(0.0)).min(below(end))
    }

    /// Averages over the distance, by Gauss-Legendre quadrature: force of resistance, N, and
    /// dynamic coefficient.
    pub(super) fn averages(&self, physics: &Physics, from: &State, end: f64) -> (f64, f64) {
        let (mut way, mut work, mut friction) = (0.0, 0.0, 0.0);
        for (point, weight) in GAUSS_5 {
            let state = self.state(from, point * end * self.length_s);
            let v = state.speed_m_per_s;
            way += weight * v;
            work += weight * v * physics.resistance_n(&state);
            friction += weight * v * physics.mu(&state);
        }
        if way > 0.0 { (work / way, friction / way) } else { (0.0, 0.0) }
    }
}

pub(super) fn to_state(phase: Phase, [u, v, x, contact_s]: Vector, state: State) -> State {
    let (force_n, slack_m) = match phase {
        Phase::Stick | Phase::Slip => (u, 0.0),
        Phase::SlackSliding | Phase::SlackStuck => (0.0, u),
    };
    State { force_n, slack_m, speed_m_per_s: v, position_m: x, contact_s, ..state }
}

pub(super) fn to_vector(phase: Phase, state: &State) -> Vector {
    let u = match phase {
        Phase::Stick | Phase::Slip => state.force_n,
        Phase::SlackSliding | Phase::SlackStuck => state.slack_m,
    };
    [u, state.speed_m_per_s, state.position_m, state.contact_s]
}
