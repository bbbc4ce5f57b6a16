//! A test as a sequence of pieces of motion.

use super::exact::{self, Motion};
use super::scene::{GRAVITY_M_PER_S2, Scene};
use super::state::{End, Mechanics, Phase, State};

/// A piece of motion with its two ends.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// What block and cable do.
    pub phase: Phase,
    /// At its start.
    pub from: State,
    /// At its end; the time is infinite for a motion without end.
    pub to: State,
    /// Why it ends.
    pub end: End,
    /// What holds in it.
    pub mechanics: Mechanics,
    /// The motion in between.
    pub motion: Motion,
}

impl Segment {
    /// Force at a time inside the segment, N.
    #[must_use]
    pub fn force_n(&self, time_s: f64) -> f64 {
        self.motion.force_n(&self.from, time_s - self.from.time_s)
    }

    /// Largest force in the segment, N.
    #[must_use]
    pub fn peak_force_n(&self) -> f64 {
        let ends = self.from.force_n.max(self.to.force_n);
        match self.motion {
            // The top of the ellipse lies ahead while the force still rises.
            Motion::Ellipse { centre_n, cosine_n, sine_n, .. }
                if cosine_n >= 0.0 && sine_n > 0.0 =>
            {
                ends.max(centre_n + cosine_n.hypot(sine_n))
            }
            Motion::Ellipse { .. } | Motion::Line { .. } | Motion::Slack { .. } => ends,
        }
    }
}

/// All segments of a scene in order, without end: take as many as needed.
#[derive(Clone, Debug)]
pub struct Segments {
    phase: Phase,
    state: State,
    mechanics: Mechanics,
}

impl Segments {
    /// Starts a test: the block at rest on a cable that is just taut.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let state = State { force_n: scene.start_force_n, ..State::default() };
        Self { phase: Phase::Stick, state, mechanics: mechanics(scene) }
    }
}

impl Iterator for Segments {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        if !self.state.time_s.is_finite() {
            return None;
        }
        let (phase, from, mechanics) = (self.phase, self.state, self.mechanics);
        let (_, end, to) = exact::finish(phase, &from, &mechanics);
        self.phase = after(phase, end);
        self.state = to;
        let motion = Motion::start(phase, &from, &mechanics);
        Some(Segment { phase, from, to, end, mechanics, motion })
    }
}

/// The state machine, see [`Phase`].
fn after(phase: Phase, end: End) -> Phase {
    match (phase, end) {
        (Phase::Stick, End::Onset) | (Phase::SlackSliding, End::Taut) => Phase::Slip,
        (Phase::Slip, End::Stop) | (Phase::SlackStuck, End::Taut) => Phase::Stick,
        (Phase::Slip, End::Slack) => Phase::SlackSliding,
        (Phase::SlackSliding, End::Stop) => Phase::SlackStuck,
        (phase, End::Continue | End::Onset | End::Stop | End::Slack | End::Taut) => phase,
    }
}

/// Forces on the slope, (26) to (28): `Mg (sin alpha + mu cos alpha)`.
fn mechanics(scene: &Scene) -> Mechanics {
    let (sin, cos) = scene.slope_rad().sin_cos();
    Mechanics {
        mass_kg: scene.weight_n / GRAVITY_M_PER_S2,
        stiffness_n_per_m: scene.stiffness_n_per_m,
        winch_m_per_s: scene.winch_m_per_s,
        static_force_n: scene.weight_n * (sin + scene.mu_s * cos),
        dynamic_force_n: scene.weight_n * (sin + scene.mu * cos),
    }
}
