//! A test as a sequence of phases of motion.

use super::exact::{self, Motion};
use super::friction::Friction;
use super::integrate::{self, Integrator};
use super::physics::Physics;
use super::random::{self, Stream};
use super::scene::Scene;
use super::state::{End, Mechanics, Phase, State};
use super::weighing::Swing;

/// Method that computes the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// From event to event in closed form.
    ClosedForm,
    /// By an adaptive integrator with this relative tolerance.
    Integrator {
        /// Relative tolerance of a step.
        tolerance: f64,
    },
}

impl Method {
    /// The closed form where it holds, else the integrator.
    #[must_use]
    pub fn for_scene(scene: &Scene) -> Self {
        if scene.is_linear() {
            Self::ClosedForm
        } else {
            Self::Integrator { tolerance: integrate::TOLERANCE }
        }
    }
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::ClosedForm => f.write_str("closed form from event to event"),
            Self::Integrator { tolerance } => {
                write!(f, "adaptive integrator (Verner 9(8), tolerance {tolerance:e})")
            }
        }
    }
}

/// A phase of motion, or a part of one, with its two ends.
#[derive(Clone, Debug)]
pub struct Segment {
    /// State of block and cable.
    pub phase: Phase,
    /// State at the start.
    pub from: State,
    /// State at the end; the time is infinite for a motion without end.
    pub to: State,
    /// Why the segment ends.
    pub end: End,
    /// Parameters at the start (for an onset: at the end); in closed form they hold for the whole
    /// segment.
    pub mechanics: Mechanics,
    /// Whether only a part of the contact slips in this event.
    pub partial: bool,
    /// The motion between both ends.
    pub motion: Motion,
    /// Whether the force of a slip that starts here has its peak some time later.
    pub smooth_onset: bool,
    /// Mean force of friction, slope and drag over the distance, N.
    pub mean_resistance_n: f64,
    /// Mean dynamic coefficient over the distance.
    pub mean_mu: f64,
}

impl Segment {
    /// Force at a time inside the segment, N.
    #[must_use]
    pub fn force_n(&self, time_s: f64) -> f64 {
        self.motion.force_n(&self.from, time_s - self.from.time_s)
    }

    /// The state at a time inside the segment.
    #[must_use]
    pub fn state(&self, time_s: f64) -> State {
        self.motion.state(&self.from, time_s - self.from.time_s)
    }

    /// Largest force in the segment, N.
    #[must_use]
    pub fn peak_force_n(&self) -> f64 {
        let ends = self.from.force_n.max(self.to.force_n);
        match &self.motion {
            // The top of the ellipse is still ahead while the force rises.
            Motion::Ellipse { centre_n, cosine_n, sine_n, .. }
                if *cosine_n >= 0.0 && *sine_n > 0.0 =>
            {
                ends.max(centre_n + cosine_n.hypot(*sine_n))
            }
            Motion::Step(step) => ends.max(step.peak_force_n(self.to.time_s - self.from.time_s)),
            Motion::Ellipse { .. } | Motion::Line { .. } | Motion::Slack { .. } => ends,
        }
    }
}

/// All segments of a scene in order. The sequence ends only when the integrator gives up, see
/// [`Segments::failure`], or after a motion without end.
#[derive(Debug)]
pub struct Segments {
    method: Method,
    physics: Physics,
    friction: Friction,
    phase: Phase,
    state: State,
    integrator: Option<Integrator>,
    swing: Option<Swing>,
    failure: Option<String>,
}

impl Segments {
    /// Starts a test: the block at rest on a taut cable, or sliding at constant speed.
    #[must_use]
    pub fn new(scene: &Scene, seed: u64, method: Method) -> Self {
        let mut friction = Friction::new(scene, random::stream(seed, Stream::Friction));
        let mut physics = Physics::new(scene, friction.draw(), seed);
        let mut state = State { force_n: scene.start_force_n, contact_s: 1.0, ..State::default() };
        if scene.start_sliding {
            state.speed_m_per_s = physics.winch_m_per_s(0.0).max(0.0);
            state.force_n = physics.resistance_n(&state);
        }
        physics.settle_cable(&state);
        let phase = if scene.start_sliding { Phase::Slip } else { Phase::Stick };
        let mut segments = Self {
            method,
            physics,
            friction,
            phase,
            state,
            integrator: None,
            swing: None,
            failure: None,
        };
        match scene.weighing.map(|weighing| Swing::new(scene, weighing)) {
            Some(Ok(swing)) => segments.swing = Some(swing),
            Some(Err(failure)) => segments.failure = Some(failure),
            None => {}
        }
        segments
    }

    /// Why the integrator gave up, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    fn closed_form(&self) -> Segment {
        let (phase, from) = (self.phase, self.state);
        let mechanics = self.physics.mechanics(&from);
        let motion = Motion::start(phase, &from, &mechanics);
        let (_, mut end, mut to) = exact::finish(phase, &from, &mechanics);
        let break_s = self.physics.next_break_s();
        if to.time_s > break_s {
            to = State { time_s: break_s, ..motion.state(&from, break_s - from.time_s) };
            end = End::Continue;
        }
        Segment {
            phase,
            from,
            to,
            end,
            mechanics,
            partial: self.physics.pair().partial,
            smooth_onset: false,
            motion,
            mean_resistance_n: mechanics.dynamic_force_n,
            mean_mu: mechanics.mu,
        }
    }

    fn integrated(&mut self, tolerance: f64) -> Result<Segment, String> {
        let (phase, from, physics) = (self.phase, self.state, &self.physics);
        let mut integrator = match self.integrator.take() {
            Some(integrator) => integrator,
            None => Integrator::new(phase, from, physics, tolerance)?,
        };
        let advance = integrator.advance(physics, physics.next_break_s())?;
        if physics.is_at_winch(advance.to.position_m) {
            return Err(format!("the block runs into the winch after {:.1} s", from.time_s));
        }
        let at_break = advance.to.time_s >= physics.next_break_s();
        if advance.goes_on && !at_break {
            self.integrator = Some(integrator);
        }
        // A slip starts with the parameters at its onset.
        let at = if advance.end == End::Onset { &advance.to } else { &from };
        Ok(Segment {
            phase,
            from,
            to: advance.to,
            end: advance.end,
            mechanics: physics.mechanics(at),
            partial: physics.pair().partial,
            smooth_onset: physics.has_smooth_onset(),
            motion: Motion::Step(Box::new(advance.step)),
            mean_resistance_n: advance.mean_resistance_n,
            mean_mu: advance.mean_mu,
        })
    }

    fn compute(&mut self) -> Result<Segment, String> {
        if let Some(swing) = &mut self.swing {
            let (step, to) = swing.advance(&self.state)?;
            let motion = Motion::Step(Box::new(step));
            return Ok(Segment { to, end: End::Continue, motion, ..self.closed_form() });
        }
        match self.method {
            Method::ClosedForm => Ok(self.closed_form()),
            Method::Integrator { tolerance } => self.integrated(tolerance),
        }
    }

    /// Prepares the phase after a segment.
    fn enter_next(&mut self, last: &Segment) {
        self.state = last.to;
        self.phase = after(last.phase, last.end);
        if last.end == End::Stop {
            let pair = self.friction.draw();
            self.physics.set_pair(pair);
            self.physics.note_stop();
        }
        if last.end == End::Onset {
            self.physics.start_slip(&self.state);
        }
        if last.end == End::Continue && last.to.time_s >= self.physics.next_break_s() {
            self.pass_break();
        }
        if self.integrator.is_none() {
            self.physics.settle_cable(&self.state);
        }
    }

    /// The force of the cable's damping changes in a step with the speed of the winch.
    fn pass_break(&mut self) {
        let time_s = self.state.time_s;
        let before = self.physics.winch_m_per_s(time_s);
        self.physics.pass_break();
        let faster = self.physics.winch_m_per_s(time_s) - before;
        if self.phase == Phase::Stick || self.phase == Phase::Slip {
            let change_n = self.physics.damping_n_s_per_m() * faster;
            self.state.force_n = (self.state.force_n + change_n).max(0.0);
        }
    }
}

impl Iterator for Segments {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        if !self.state.time_s.is_finite() || self.failure.is_some() {
            return None;
        }
        let segment = match self.compute().and_then(with_a_force) {
            Ok(segment) => segment,
            Err(failure) => {
                self.failure = Some(failure);
                return None;
            }
        };
        self.enter_next(&segment);
        Some(segment)
    }
}

/// Rejects a segment at whose end the force is no number.
fn with_a_force(segment: Segment) -> Result<Segment, String> {
    if segment.to.force_n.is_nan() {
        let since_s = segment.from.time_s;
        return Err(format!(
            "the force is no number after {since_s:.1} s: some value is far too large or too small"
        ));
    }
    Ok(segment)
}

/// The state machine of [`Phase`].
fn after(phase: Phase, end: End) -> Phase {
    match (phase, end) {
        (Phase::Stick, End::Onset) | (Phase::SlackSliding, End::Taut) => Phase::Slip,
        (Phase::Slip, End::Stop) | (Phase::SlackStuck, End::Taut) => Phase::Stick,
        (Phase::Slip, End::Slack) => Phase::SlackSliding,
        (Phase::SlackSliding, End::Stop) | (Phase::Stick, End::Slack) => Phase::SlackStuck,
        (phase, End::Continue | End::Onset | End::Stop | End::Slack | End::Taut) => phase,
    }
}

#[cfg(test)]
mod tests {
    use super::super::rate_and_state::RateAndState;
    use super::super::terms::Drag;
    use super::super::winch::WinchProfile;
    use super::super::{Scene, simulate};

    /// The block starts with the speed that the winch has then, not with the nominal one.
    #[test]
    fn a_block_that_starts_sliding_slides_on() {
        let factor = 0.5;
        for profile in [
            WinchProfile::FirstSlip { factor },
            WinchProfile::Steps { steps: vec![[0.0, factor]], period_s: None },
        ] {
            let winch_profile = Some(profile);
            let scene = Scene { start_sliding: true, winch_profile, ..Scene::default() };
            let simulation = simulate(&scene, 1).unwrap();
            let steady_n = scene.mu * scene.weight_n;
            assert_eq!(simulation.events, []);
            assert!(simulation.samples.iter().all(|s| (s.force_n - steady_n).abs() < 1e-6));
        }
    }

    #[test]
    fn a_force_that_is_no_number_ends_the_test() {
        let drag = Some(Drag { n_s2_per_m2: 1e9, n_s_per_m: 0.0 });
        let error = simulate(&Scene { drag, ..Scene::default() }, 1).unwrap_err().to_string();
        assert!(error.starts_with("the force is no number after "), "{error}");
    }

    #[test]
    fn nothing_slips_at_a_post() {
        let law =
            RateAndState { reference_m_per_s: 0.01, direct: 0.01, evolving: 0.02, renewal_m: 1e-4 };
        let rate_and_state = Some(law);
        let scene = Scene { post: true, duration_s: 5.0, rate_and_state, ..Scene::default() };
        for sample in simulate(&scene, 1).unwrap().samples {
            let expected_n = scene.stiffness_n_per_m * scene.winch_m_per_s * sample.time_s;
            assert!((sample.force_n - expected_n).abs() < 1e-6, "{sample:?}");
        }
    }
}
