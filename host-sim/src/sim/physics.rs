//! The forces of a scene at any moment, with all its terms.

use super::friction::Pair;
use super::scene::{GRAVITY_M_PER_S2, Scene};
use super::state::{Hold, Mechanics, State};
use super::terms::{Breaking, Creep, Drag, RateDependence, Sag, WinchProfile};

/// What acts on block and cable now. Parameters that change in steps (weight,
/// winch on and off) are advanced with [`Physics::pass_break`].
#[derive(Clone, Debug)]
pub struct Physics {
    pair: Pair,
    weight_n: f64,
    stiffness_n_per_m: f64,
    length_m: f64,
    winch_m_per_s: f64,
    slope_rad: f64,
    slope_rad_per_m: f64,
    post: bool,
    hold: Option<Hold>,
    rate: Option<RateDependence>,
    creep: Option<Creep>,
    shortening: bool,
    sag: Option<Sag>,
    cable_lies: bool,
    ripple: Option<WinchProfile>,
    drag: Option<Drag>,
    weighing: bool,
    breaking: Option<Breaking>,
    switching: Option<Switching>,
}

/// A winch that is switched on and off.
#[derive(Clone, Copy, Debug)]
struct Switching {
    go_s: f64,
    stop_s: f64,
    cycle: u32,
    running: bool,
}

impl Switching {
    fn next_s(&self) -> f64 {
        let start = f64::from(self.cycle) * (self.go_s + self.stop_s);
        start + if self.running { self.go_s } else { self.go_s + self.stop_s }
    }

    fn switch(&mut self) {
        self.cycle += u32::from(!self.running);
        self.running = !self.running;
    }
}

impl Physics {
    /// The forces at the start of a scene, with the coefficients of the first
    /// event.
    #[must_use]
    pub fn new(scene: &Scene, pair: Pair) -> Self {
        let (ripple, switching) = match scene.winch_profile {
            Some(WinchProfile::StopAndGo { go_s, stop_s }) => {
                (None, Some(Switching { go_s, stop_s, cycle: 0, running: true }))
            }
            Some(ripple @ WinchProfile::Ripple { .. }) => (Some(ripple), None),
            None => (None, None),
        };
        Self {
            pair,
            weight_n: scene.weight_n,
            stiffness_n_per_m: scene.stiffness_n_per_m,
            length_m: scene.cable_length_m,
            winch_m_per_s: scene.winch_m_per_s,
            slope_rad: scene.slope_rad(),
            slope_rad_per_m: scene.tilt.map_or(0.0, |t| t.deg_per_m.to_radians()),
            post: scene.post,
            hold: scene
                .hold_time
                .map(|h| Hold { reference_s: h.reference_s, per_decade: h.per_decade }),
            rate: scene.rate_dependence,
            creep: scene.creep,
            shortening: scene.shortening,
            sag: scene.sag,
            cable_lies: false,
            ripple,
            drag: scene.drag,
            weighing: scene.weighing.is_some(),
            breaking: scene.breaking,
            switching,
        }
    }

    /// Sets the coefficients of the next event.
    pub fn set_pair(&mut self, pair: Pair) {
        self.pair = pair;
    }

    /// The coefficients in force.
    #[must_use]
    pub fn pair(&self) -> Pair {
        self.pair
    }

    /// Weight now, N.
    #[must_use]
    pub fn weight_n(&self) -> f64 {
        self.weight_n
    }

    /// Mass now, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.weight_n / GRAVITY_M_PER_S2
    }

    /// Slope of the ice under the block, rad.
    #[must_use]
    pub fn slope_rad(&self, position_m: f64) -> f64 {
        self.slope_rad + self.slope_rad_per_m * position_m
    }

    /// Speed of the winch, m/s.
    #[must_use]
    pub fn winch_m_per_s(&self, time_s: f64) -> f64 {
        match (self.switching, self.ripple) {
            (Some(Switching { running: false, .. }), _) => 0.0,
            (_, Some(ripple)) => self.winch_m_per_s * ripple.factor(time_s),
            (_, None) => self.winch_m_per_s,
        }
    }

    /// Free length of the cable, m.
    fn length_m(&self, position_m: f64) -> f64 {
        if self.shortening { self.length_m - position_m } else { self.length_m }
    }

    /// Whether so little of the cable is left that its length no longer makes sense.
    #[must_use]
    pub fn is_at_winch(&self, position_m: f64) -> bool {
        let used_up = self.length_m(position_m) < 0.01 * self.length_m;
        self.shortening && used_up
    }

    /// Stiffness of the cable, N/m.
    #[must_use]
    pub fn stiffness_n_per_m(&self, force_n: f64, position_m: f64) -> f64 {
        let length = self.length_m(position_m);
        let taut = self.stiffness_n_per_m * self.length_m / length;
        let Some(Sag { weight_n_per_m: q, .. }) = self.sag else { return taut };
        let lying_n = self.lying_force_n(position_m);
        // Far below that force only within a step that goes too far.
        let hanging_n = if self.cable_lies { lying_n } else { force_n.max(0.1 * lying_n) };
        1.0 / (1.0 / taut + (q * q * length.powi(3)) / (12.0 * hanging_n.powi(3)))
    }

    /// Force below which a sagging cable lies on the ice, N; zero without sag.
    fn lying_force_n(&self, position_m: f64) -> f64 {
        let length = self.length_m(position_m);
        self.sag.map_or(0.0, |s| s.weight_n_per_m * length * length / (8.0 * s.height_m))
    }

    /// Notes whether the cable lies on the ice: the stiffness has a kink there,
    /// and each side is followed by its own smooth law.
    pub fn settle_cable(&mut self, state: &State) {
        self.cable_lies = state.force_n < self.lying_force_n(state.position_m);
    }

    /// How far the cable is from that kink, N; below zero when it has just passed.
    #[must_use]
    pub fn to_kink_n(&self, state: &State) -> f64 {
        let lying_n = self.lying_force_n(state.position_m);
        let above_n = state.force_n - lying_n;
        // A little past it, or rounding would pass it again and again.
        1e-9 * lying_n + if self.cable_lies { -above_n } else { above_n }
    }

    /// Whether there is such a kink.
    #[must_use]
    pub fn has_kink(&self) -> bool {
        self.sag.is_some()
    }

    /// Dynamic coefficient at a speed.
    #[must_use]
    pub fn mu(&self, speed_m_per_s: f64) -> f64 {
        self.rate.map_or(self.pair.mu, |r| {
            let ratio = speed_m_per_s.max(0.0) / r.reference_m_per_s;
            self.pair.mu + r.per_decade * (1.0 + ratio).log10()
        })
    }

    /// Force that balances friction, slope and drag on the moving block, N.
    #[must_use]
    pub fn resistance_n(&self, speed_m_per_s: f64, position_m: f64) -> f64 {
        let (sin, cos) = self.slope_rad(position_m).sin_cos();
        let drag_n = self.drag.map_or(0.0, |d| d.n_s2_per_m2 * speed_m_per_s * speed_m_per_s);
        self.weight_n * (sin + self.mu(speed_m_per_s) * cos) + drag_n
    }

    /// Speed of the creep of a resting block, m/s.
    #[must_use]
    pub fn creep_m_per_s(&self, state: &State) -> f64 {
        let Some(creep) = self.creep else { return 0.0 };
        let below_n = state.force_n - self.mechanics(state).static_force_n(state);
        // Above the onset only within a step that goes too far.
        let growth = (below_n / creep.range_n).min(5.0).exp();
        creep.onset_fraction * self.winch_m_per_s(state.time_s) * growth
    }

    /// Speed with which a slip starts, m/s: that of the creep at `Fs`.
    #[must_use]
    pub fn onset_speed_m_per_s(&self, time_s: f64) -> f64 {
        self.creep.map_or(0.0, |c| c.onset_fraction * self.winch_m_per_s(time_s))
    }

    /// The linear block on a cable as it is at this moment; what it stays when
    /// [`Physics::is_linear`].
    #[must_use]
    pub fn mechanics(&self, state: &State) -> Mechanics {
        let (sin, cos) = self.slope_rad(state.position_m).sin_cos();
        let static_n = self.weight_n * (sin + self.pair.mu_s * cos);
        Mechanics {
            weight_n: self.weight_n,
            mass_kg: self.mass_kg(),
            slope_rad: self.slope_rad(state.position_m),
            stiffness_n_per_m: self.stiffness_n_per_m(state.force_n, state.position_m),
            winch_m_per_s: self.winch_m_per_s(state.time_s),
            reference_static_force_n: if self.post { f64::INFINITY } else { static_n },
            dynamic_force_n: self.resistance_n(state.speed_m_per_s, state.position_m),
            mu: self.mu(state.speed_m_per_s),
            hold: self.hold,
        }
    }

    /// Whether the closed form holds between breaks.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        let constant_cable = !self.shortening && self.sag.is_none() && self.ripple.is_none();
        let constant_friction = self.rate.is_none() && self.drag.is_none() && self.creep.is_none();
        // An exact zero switches the tilt off.
        !self.weighing && constant_cable && constant_friction && self.slope_rad_per_m.abs() <= 0.0
    }

    /// When a parameter changes next, s; infinite if never.
    #[must_use]
    pub fn next_break_s(&self) -> f64 {
        let breaking_s = self.breaking.map_or(f64::INFINITY, |b| b.at_s);
        self.switching.map_or(f64::INFINITY, |s| s.next_s()).min(breaking_s)
    }

    /// Changes what changes at [`Physics::next_break_s`].
    pub fn pass_break(&mut self) {
        let now_s = self.next_break_s();
        if let Some(breaking) = self.breaking.filter(|b| b.at_s <= now_s) {
            self.weight_n = breaking.weight_n;
            self.breaking = None;
        }
        if let Some(switching) = self.switching.as_mut().filter(|s| s.next_s() <= now_s) {
            switching.switch();
        }
    }

    /// The longest step that cannot overlook anything, s.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        match self.ripple {
            Some(WinchProfile::Ripple { period_s, .. }) => 0.125 * period_s,
            Some(WinchProfile::StopAndGo { .. }) | None => f64::INFINITY,
        }
    }
}
