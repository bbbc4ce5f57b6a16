//! A block that hangs from a tripod and swings: the force a weighing records.
//!
//! `theta'' = -(g/l) sin theta - 2 d theta'`, tension
//! `M (g cos theta + l theta'²)`. Averaged over a swing of amplitude `A` it is
//! `Mg (1 + A²/4)`, not `Mg`: the cell measures along the cable.

use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;

use super::integrate;
use super::scene::Scene;
use super::state::{Phase, State};
use super::step::{Step, Vector};
use super::terms::Weighing;

struct Pendulum(Weighing);

impl ODE<f64, Vector> for Pendulum {
    fn diff(&self, _t: f64, [theta, speed, ..]: &Vector, rate: &mut Vector) {
        let pull = -GRAVITY_M_PER_S2 / self.0.length_m * theta.sin();
        *rate = [*speed, pull - 2.0 * self.0.damping_per_s * speed, 0.0, 0.0];
    }
}

impl Pendulum {
    fn tension_n(&self, weight_n: f64, [theta, speed, ..]: Vector) -> f64 {
        weight_n * (theta.cos() + self.0.length_m * speed * speed / GRAVITY_M_PER_S2)
    }
}

/// Integrator of the swing.
pub(super) struct Swing {
    pendulum: Pendulum,
    weight_n: f64,
    method: Box<integrate::Method>,
}

impl std::fmt::Debug for Swing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Swing").field("weight_n", &self.weight_n).finish()
    }
}

impl Swing {
    /// A swing that starts at rest at its largest angle.
    pub(super) fn new(scene: &Scene, weighing: Weighing) -> Result<Self, String> {
        let pendulum = Pendulum(weighing);
        let omega = (GRAVITY_M_PER_S2 / weighing.length_m).sqrt();
        let start = [weighing.swing_deg.to_radians(), 0.0, 0.0, 0.0];
        let mut method = integrate::verner_9(integrate::TOLERANCE, [1e-13; 4], 0.2 / omega);
        method.init(&pendulum, 0.0, 1e12, &start).map_err(|e| integrate::explain(&e))?;
        Ok(Self { pendulum, weight_n: scene.weight_n, method: Box::new(method) })
    }

    /// The next step from a state.
    pub(super) fn advance(&mut self, from: &State) -> Result<(Step, State), String> {
        let start_s = self.method.t();
        integrate::accepted_step(&mut self.method, &self.pendulum)?;
        let length_s = self.method.t() - start_s;
        let tension = |angle| [self.pendulum.tension_n(self.weight_n, angle), 0.0, 0.0, 0.0];
        let at_nodes = integrate::at_nodes(&mut self.method, start_s)?.map(tension);
        let step = Step::new(Phase::Stick, length_s, at_nodes);
        Ok((step, step.state(from, length_s)))
    }
}
