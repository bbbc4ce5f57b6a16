//! The forces of a scene at any moment, with all its terms.

use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;

use super::friction::Pair;
use super::random::{self, Stream};
use super::scene::Scene;
use super::state::{Mechanics, State};
use super::terms::{Sag, WinchProfile};
use super::winch::Winch;

/// Forces and parameters at the current time. Parameters that change in steps (weight, winch on and
/// off) are advanced with [`Physics::pass_break`].
#[derive(Clone, Debug)]
pub struct Physics {
    /// With the weight that the block has now.
    scene: Scene,
    pair: Pair,
    winch: Winch,
    /// Position, m, and time, s, at which the slip began.
    slip_from: (f64, f64),
    cable_lies: bool,
}

impl Physics {
    /// The forces at the start of a scene, with the coefficients of the first
    /// event.
    #[must_use]
    pub fn new(scene: &Scene, pair: Pair, seed: u64) -> Self {
        let random = random::stream(seed, Stream::Winch);
        Self {
            scene: scene.clone(),
            pair,
            winch: Winch::new(scene.winch_m_per_s, scene.winch_profile.clone(), random),
            slip_from: (0.0, 0.0),
            cable_lies: false,
        }
    }

    /// Sets the coefficients of the next event.
    pub fn set_pair(&mut self, pair: Pair) {
        self.pair = pair;
    }

    /// The current coefficients.
    #[must_use]
    pub fn pair(&self) -> Pair {
        self.pair
    }

    /// Current mass, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.scene.weight_n / GRAVITY_M_PER_S2
    }

    /// Slope of the ice under the block, rad.
    #[must_use]
    pub fn slope_rad(&self, position_m: f64) -> f64 {
        let per_m = self.scene.tilt.map_or(0.0, |tilt| tilt.deg_per_m.to_radians());
        self.scene.slope_rad() + per_m * position_m
    }

    /// Speed of the winch, m/s.
    #[must_use]
    pub fn winch_m_per_s(&self, time_s: f64) -> f64 {
        self.winch.m_per_s(time_s)
    }

    /// Free length of the cable, m.
    fn length_m(&self, position_m: f64) -> f64 {
        let start_m = self.scene.cable_length_m;
        if self.scene.shortening { start_m - position_m } else { start_m }
    }

    /// Whether too little of the cable is left for a meaningful length.
    #[must_use]
    pub fn is_at_winch(&self, position_m: f64) -> bool {
        let used_up = self.length_m(position_m) < 0.01 * self.scene.cable_length_m;
        self.scene.shortening && used_up
    }

    /// Stiffness of the cable, N/m.
    #[must_use]
    pub fn stiffness_n_per_m(&self, force_n: f64, position_m: f64) -> f64 {
        let length = self.length_m(position_m);
        let taut = self.scene.stiffness_n_per_m * self.scene.cable_length_m / length;
        let Some(Sag { weight_n_per_m: q, .. }) = self.scene.sag else { return taut };
        let lying_n = self.lying_force_n(position_m);
        // Forces far below that occur only within a step that overshoots.
        let hanging_n = if self.cable_lies { lying_n } else { force_n.max(0.1 * lying_n) };
        1.0 / (1.0 / taut + (q * q * length.powi(3)) / (12.0 * hanging_n.powi(3)))
    }

    /// Force below which a sagging cable lies on the ice, N; zero without sag.
    fn lying_force_n(&self, position_m: f64) -> f64 {
        let length = self.length_m(position_m);
        self.scene.sag.map_or(0.0, |s| s.weight_n_per_m * length * length / (8.0 * s.height_m))
    }

    /// Sets whether the cable lies on the ice: the stiffness has a kink there, and each side has
    /// its own smooth law.
    pub fn settle_cable(&mut self, state: &State) {
        self.cable_lies = state.force_n < self.lying_force_n(state.position_m);
    }

    /// Distance of the force from that kink, N; negative when the kink has just been passed.
    #[must_use]
    pub fn to_kink_n(&self, state: &State) -> f64 {
        let lying_n = self.lying_force_n(state.position_m);
        let above_n = state.force_n - lying_n;
        // A small offset beyond the kink, or rounding would pass it again and again.
        1e-9 * lying_n + if self.cable_lies { -above_n } else { above_n }
    }

    /// Whether the stiffness has such a kink.
    #[must_use]
    pub fn has_kink(&self) -> bool {
        self.scene.sag.is_some()
    }

    /// Coefficient of the moving block.
    #[must_use]
    pub fn mu(&self, state: &State) -> f64 {
        let speed = state.speed_m_per_s.max(0.0);
        let Pair { mu_s, mu, .. } = self.pair;
        let law = match (self.scene.rate_and_state, self.scene.rate_dependence) {
            (Some(law), _) => law.mu(mu, speed, state.contact_s),
            (None, Some(r)) => mu + r.per_decade * (1.0 + speed / r.reference_m_per_s).log10(),
            (None, None) => mu,
        };
        let falling = self.scene.stribeck.map_or(0.0, |s| (mu_s - mu) * s.left(speed));
        (law + falling) * self.factor_in_slip(state)
    }

    /// Factor on the friction due to the terms that act within a slip.
    fn factor_in_slip(&self, state: &State) -> f64 {
        let (from_m, from_s) = self.slip_from;
        let along = self.scene.along_slip.map_or(1.0, |a| a.factor(state.position_m - from_m));
        let rocking = self.scene.rocking.map_or(1.0, |r| {
            let omega = (self.scene.stiffness_n_per_m / self.mass_kg()).sqrt();
            r.factor(omega, state.time_s - from_s)
        });
        along * rocking
    }

    /// Sets the start of a slip.
    pub fn start_slip(&mut self, state: &State) {
        self.slip_from = (state.position_m, state.time_s);
    }

    /// To be called when the block has come to rest.
    pub fn note_stop(&mut self) {
        self.winch.note_stop();
    }

    /// Whether the force has its peak some time after the block begins to move.
    #[must_use]
    pub fn has_smooth_onset(&self) -> bool {
        self.scene.has_smooth_onset()
    }

    /// Damping coefficient of the cable, N s/m.
    #[must_use]
    pub fn damping_n_s_per_m(&self) -> f64 {
        self.scene
            .cable_damping
            .map_or(0.0, |d| d.n_s_per_m(self.scene.stiffness_n_per_m, self.mass_kg()))
    }

    /// Rate of the age of the contacts at a speed of the block.
    #[must_use]
    pub fn ageing(&self, speed_m_per_s: f64, contact_s: f64) -> f64 {
        self.scene.rate_and_state.map_or(0.0, |law| law.ageing(speed_m_per_s, contact_s))
    }

    /// Speed below which a moving block counts as resting, m/s.
    #[must_use]
    pub fn rest_m_per_s(&self) -> f64 {
        self.scene.rate_and_state.map_or(0.0, |law| law.rest_m_per_s(self.winch.nominal_m_per_s()))
    }

    /// Force that balances friction, slope and drag on the moving block, N.
    #[must_use]
    pub fn resistance_n(&self, state: &State) -> f64 {
        let (sin, cos) = self.slope_rad(state.position_m).sin_cos();
        let v = state.speed_m_per_s;
        let drag_n = self.scene.drag.map_or(0.0, |d| (d.n_s_per_m + d.n_s2_per_m2 * v) * v);
        self.scene.weight_n * (sin + self.mu(state) * cos) + drag_n
    }

    /// Speed of the creep of a resting block, m/s.
    #[must_use]
    pub fn creep_m_per_s(&self, state: &State) -> f64 {
        if self.scene.post {
            return 0.0;
        }
        if let Some(law) = self.scene.rate_and_state {
            let (sin, cos) = self.slope_rad(state.position_m).sin_cos();
            let mu = (state.force_n / self.scene.weight_n - sin) / cos;
            let most = self.winch.nominal_m_per_s();
            return law.creep_m_per_s(self.pair.mu, mu, state.contact_s, most);
        }
        let Some(creep) = self.scene.creep else { return 0.0 };
        let below_n = state.force_n - self.mechanics(state).static_force_n(state);
        // Forces above the onset occur only within a step that overshoots.
        let growth = (below_n / creep.range_n).min(5.0).exp();
        creep.onset_fraction * self.winch_m_per_s(state.time_s) * growth
    }

    /// Speed at which a slip starts, m/s: that of the creep at `Fs`. Where friction falls from its
    /// static value, a block at rest would stay in equilibrium: a thousandth of the winch's speed
    /// starts it.
    #[must_use]
    pub fn onset_speed_m_per_s(&self, time_s: f64) -> f64 {
        if let Some(law) = self.scene.rate_and_state {
            return law.slip_m_per_s(self.winch.nominal_m_per_s());
        }
        if self.scene.stribeck.is_some() {
            return 1e-3 * self.winch.nominal_m_per_s();
        }
        self.scene.creep.map_or(0.0, |c| c.onset_fraction * self.winch_m_per_s(time_s))
    }

    /// The parameters of the linear block on a cable at this moment; constant if
    /// [`Scene::is_linear`].
    #[must_use]
    pub fn mechanics(&self, state: &State) -> Mechanics {
        let (sin, cos) = self.slope_rad(state.position_m).sin_cos();
        let mu_s = self.scene.rate_and_state.map_or(self.pair.mu_s, |law| {
            let speed = law.slip_m_per_s(self.winch.nominal_m_per_s());
            law.mu(self.pair.mu, speed, state.contact_s)
        });
        let static_n = self.scene.weight_n * (sin + mu_s * cos);
        Mechanics {
            weight_n: self.scene.weight_n,
            mass_kg: self.mass_kg(),
            slope_rad: self.slope_rad(state.position_m),
            stiffness_n_per_m: self.stiffness_n_per_m(state.force_n, state.position_m),
            winch_m_per_s: self.winch_m_per_s(state.time_s),
            reference_static_force_n: if self.scene.post { f64::INFINITY } else { static_n },
            dynamic_force_n: self.resistance_n(state),
            mu: self.mu(state),
            hold: self.scene.hold_time,
        }
    }

    /// Time of the next change of a parameter, s; infinite if there is none.
    #[must_use]
    pub fn next_break_s(&self) -> f64 {
        let breaking_s = self.scene.breaking.map_or(f64::INFINITY, |b| b.at_s);
        self.winch.next_s().min(breaking_s)
    }

    /// Applies the change at [`Physics::next_break_s`].
    pub fn pass_break(&mut self) {
        let now_s = self.next_break_s();
        if let Some(breaking) = self.scene.breaking.take_if(|b| b.at_s <= now_s) {
            self.scene.weight_n = breaking.weight_n;
        }
        if self.winch.next_s() <= now_s {
            self.winch.pass();
        }
    }

    /// The longest step that cannot miss an event, s.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        self.winch.longest_step_s()
    }
}

impl Scene {
    /// Whether the closed form holds from event to event.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        let ripples = matches!(self.winch_profile, Some(WinchProfile::Ripple { .. }));
        let constant_cable =
            !self.shortening && self.sag.is_none() && self.cable_damping.is_none() && !ripples;
        let constant_friction = self.rate_dependence.is_none()
            && self.drag.is_none()
            && self.creep.is_none()
            && self.along_slip.is_none()
            && self.rocking.is_none()
            && !self.has_smooth_onset();
        // An exact zero turns the tilt off.
        let constant_slope = self.tilt.is_none_or(|tilt| tilt.deg_per_m.abs() <= 0.0);
        self.weighing.is_none() && constant_cable && constant_friction && constant_slope
    }

    /// Whether the force has its peak some time after the block begins to move.
    fn has_smooth_onset(&self) -> bool {
        self.stribeck.is_some() || self.rate_and_state.is_some()
    }
}
