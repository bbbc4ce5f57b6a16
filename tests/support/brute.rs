//! A block on a cable, integrated by Newton's law in small steps.
//!
//! Uses only `M dv/dt = F − W (sin α + mu cos α)` and `d(stretch)/dt = w − v`, and none of the
//! formulas that it verifies (no ellipse, no closed-form times). The method is classical
//! Runge-Kutta; the times at which the block starts or stops, or the cable goes slack, are found by
//! bisection.

use crate::normal::Normal;

/// Parameters of a pull, in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Pull {
    /// Weight of the block, N.
    pub weight_n: f64,
    /// Static coefficient.
    pub mu_s: f64,
    /// Dynamic coefficient.
    pub mu: f64,
    /// Stiffness, N/m.
    pub stiffness_n_per_m: f64,
    /// Winch speed, m/s.
    pub winch_m_per_s: f64,
    /// Slope, rad.
    pub slope_rad: f64,
    /// Sag, N² m: `stretch = F/k − sag/(2 F²)`.
    pub sag_n2_m: f64,
    /// Sinusoidal variation of the winch speed: relative size and period, s.
    pub ripple: (f64, f64),
    /// Relative variation of both coefficients between events.
    pub variation: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Integration time of a sample, s.
    pub aperture_s: f64,
    /// White noise, N.
    pub noise_n: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Time of the first sample, s.
    pub delay_s: f64,
    /// Time step, s.
    pub step_s: f64,
    /// Gravity, m/s²: turns the weight into a mass.
    pub gravity_m_per_s2: f64,
}

impl Default for Pull {
    /// Test DFF8-13 without noise.
    fn default() -> Self {
        Self {
            weight_n: 630.0,
            mu_s: 1.24,
            mu: 0.78,
            stiffness_n_per_m: 23_000.0,
            winch_m_per_s: 360.0 / 23_000.0,
            slope_rad: 0.0,
            sag_n2_m: 0.0,
            ripple: (0.0, 1.0),
            variation: 0.0,
            rate_hz: 16.0,
            aperture_s: 0.0,
            noise_n: 0.0,
            duration_s: 120.0,
            delay_s: 0.0,
            step_s: 1e-3,
            gravity_m_per_s2: floe_core::units::STANDARD_GRAVITY_M_PER_S2,
        }
    }
}

/// True values of one event.
#[derive(Clone, Copy, Debug, Default)]
pub struct Truth {
    /// Onset, s.
    pub onset_s: f64,
    /// Re-stick, s.
    pub stop_s: f64,
    /// Force at the onset, N.
    pub static_n: f64,
    /// Largest force, N.
    pub peak_n: f64,
    /// Force at the re-stick, N.
    pub restick_n: f64,
    /// Largest speed, m/s.
    pub top_speed_m_per_s: f64,
    /// Static coefficient.
    pub mu_s: f64,
    /// Dynamic coefficient.
    pub mu: f64,
    /// Whether the cable went slack.
    pub slack: bool,
}

/// A complete pull: forces at `delay + i / rate`, and the true events.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Forces, N.
    pub forces_n: Vec<f64>,
    /// Events.
    pub events: Vec<Truth>,
}

/// State of block and cable.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Time, s.
    pub time_s: f64,
    /// Length of cable taken up minus distance moved by the block, m; negative: slack.
    pub stretch_m: f64,
    /// Speed of the block, m/s.
    pub speed_m_per_s: f64,
    /// Whether the block moves.
    pub sliding: bool,
}

impl Pull {
    /// Force in the cable, N; never negative.
    #[must_use]
    pub fn force_n(&self, state: &State) -> f64 {
        let force_n = self.stiffness_n_per_m * state.stretch_m;
        if force_n <= 0.0 || self.sag_n2_m <= 0.0 {
            return force_n.max(0.0);
        }
        // F/k − sag/(2 F²) = stretch, solved by Newton's method.
        let mut f = force_n.max(50.0);
        for _ in 0..20 {
            let value =
                f / self.stiffness_n_per_m - self.sag_n2_m / (2.0 * f * f) - state.stretch_m;
            let slope = 1.0 / self.stiffness_n_per_m + self.sag_n2_m / (f * f * f);
            f = (f - value / slope).max(0.5 * f);
        }
        f
    }

    /// Resistance from friction with this coefficient and from the slope, N.
    #[must_use]
    pub fn resistance_n(&self, mu: f64) -> f64 {
        self.weight_n * (self.slope_rad.sin() + mu * self.slope_rad.cos())
    }

    /// Speed of the winch, m/s.
    #[must_use]
    pub fn winch_m_per_s(&self, time_s: f64) -> f64 {
        let phase = std::f64::consts::TAU * time_s / self.ripple.1;
        self.winch_m_per_s * (1.0 + self.ripple.0 * phase.sin())
    }

    /// The state `h` seconds later by one Runge-Kutta step. A resting block stays at rest, a
    /// sliding one slides against `mu` at any speed.
    #[must_use]
    pub fn moved(&self, mu: f64, from: &State, h: f64) -> State {
        let mass_kg = self.weight_n / self.gravity_m_per_s2;
        let after = |part: f64, rate: (f64, f64)| State {
            time_s: from.time_s + part,
            stretch_m: from.stretch_m + part * rate.0,
            speed_m_per_s: from.speed_m_per_s + part * rate.1,
            ..*from
        };
        let rates = |s: State| {
            let stretching = self.winch_m_per_s(s.time_s) - s.speed_m_per_s;
            let net_n = self.force_n(&s) - self.resistance_n(mu);
            (stretching, if s.sliding { net_n / mass_kg } else { 0.0 })
        };
        let a = rates(*from);
        let b = rates(after(0.5 * h, a));
        let c = rates(after(0.5 * h, b));
        let d = rates(after(h, c));
        let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * (b + c) + d) / 6.0;
        after(h, (mean(a.0, b.0, c.0, d.0), mean(a.1, b.1, c.1, d.1)))
    }

    /// The first state within `h` seconds that satisfies a condition which holds at their end, by
    /// bisection.
    #[must_use]
    pub fn first(&self, mu: f64, from: &State, h: f64, holds: impl Fn(&State) -> bool) -> State {
        let (mut before, mut after) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (before + after);
            if holds(&self.moved(mu, from, middle)) {
                after = middle;
            } else {
                before = middle;
            }
        }
        self.moved(mu, from, after)
    }
}

/// A block in motion, with the event in progress.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// State of block and cable.
    pub state: State,
    now: Truth,
}

impl Block {
    /// A block at rest with the given force, N, and a straight cable.
    #[must_use]
    pub fn resting(pull: &Pull, force_n: f64) -> Self {
        let stretch_m = force_n / pull.stiffness_n_per_m;
        let now = Truth { mu_s: pull.mu_s, mu: pull.mu, ..Truth::default() };
        Self { state: State { stretch_m, ..State::default() }, now }
    }

    fn draw(&mut self, pull: &Pull, random: &mut Normal) {
        let mut vary = || 1.0 + pull.variation * random.sample().clamp(-2.0, 2.0);
        self.now = Truth { mu_s: pull.mu_s * vary(), mu: pull.mu * vary(), ..Truth::default() };
    }

    /// Advances by `h` seconds or up to the next change of phase; returns a completed event.
    pub fn step(&mut self, pull: &Pull, h: f64) -> Option<Truth> {
        let from = self.state;
        let (mu, limit_n) = (self.now.mu, pull.resistance_n(self.now.mu_s));
        let starts = |s: &State| pull.force_n(s) >= limit_n;
        let turns =
            |s: &State| s.speed_m_per_s <= 0.0 || (s.stretch_m < 0.0) != (from.stretch_m < 0.0);
        let next = pull.moved(mu, &from, h);
        self.state = match from.sliding {
            false if starts(&next) => pull.first(mu, &from, h, starts),
            true if turns(&next) => pull.first(mu, &from, h, turns),
            _ => next,
        };
        if from.sliding {
            self.slide(pull, &from)
        } else {
            self.rest(pull, &starts);
            None
        }
    }

    fn rest(&mut self, pull: &Pull, starts: &impl Fn(&State) -> bool) {
        self.state.sliding = starts(&self.state);
        if self.state.sliding {
            self.now.onset_s = self.state.time_s;
            self.now.static_n = pull.force_n(&self.state);
            self.now.peak_n = self.now.static_n;
        }
    }

    fn slide(&mut self, pull: &Pull, from: &State) -> Option<Truth> {
        let falls = |s: &State| s.speed_m_per_s >= pull.winch_m_per_s(s.time_s);
        if falls(&self.state) && !falls(from) {
            let h = self.state.time_s - from.time_s;
            let peak_n = pull.force_n(&pull.first(self.now.mu, from, h, falls));
            self.now.peak_n = self.now.peak_n.max(peak_n);
        }
        let state = &mut self.state;
        self.now.peak_n = self.now.peak_n.max(pull.force_n(state));
        self.now.top_speed_m_per_s = self.now.top_speed_m_per_s.max(state.speed_m_per_s);
        self.now.slack |= state.stretch_m < 0.0;
        if state.speed_m_per_s > 0.0 {
            return None;
        }
        (state.sliding, state.speed_m_per_s) = (false, 0.0);
        Some(Truth { stop_s: state.time_s, restick_n: pull.force_n(state), ..self.now })
    }
}

/// Runs the pull, starting with the usual force at the beginning of a stick.
#[must_use]
pub fn run(pull: &Pull, seed: u64) -> Record {
    let mut random = Normal::new(seed);
    let rest_n = pull.weight_n * (2.0 * pull.mu - pull.mu_s);
    let mut block = Block::resting(pull, rest_n.max(0.0));
    block.draw(pull, &mut random);
    let mut runner = Runner { pull, block, random, record: Record::default() };
    let count = ((pull.duration_s - pull.delay_s) * pull.rate_hz).ceil() as usize;
    for i in 0..count {
        let sample_s = pull.delay_s + i as f64 / pull.rate_hz;
        let force_n = runner.sample_n(sample_s);
        let noise_n = pull.noise_n * runner.random.sample();
        runner.record.forces_n.push(force_n + noise_n);
    }
    runner.record
}

struct Runner<'a> {
    pull: &'a Pull,
    block: Block,
    random: Normal,
    record: Record,
}

impl Runner<'_> {
    /// Mean force over the aperture that ends at the current time, N.
    fn sample_n(&mut self, sample_s: f64) -> f64 {
        let aperture_s = self.pull.aperture_s;
        self.advance(sample_s - aperture_s);
        let parts = (aperture_s / self.pull.step_s).ceil();
        let mut mean_n = 0.0;
        for part in 0..parts as u32 {
            self.advance(sample_s - aperture_s * (1.0 - (f64::from(part) + 0.5) / parts));
            mean_n += self.pull.force_n(&self.block.state) / parts;
        }
        self.advance(sample_s);
        if parts > 0.0 { mean_n } else { self.pull.force_n(&self.block.state) }
    }

    fn advance(&mut self, until_s: f64) {
        while self.block.state.time_s < until_s {
            let h = self.pull.step_s.min(until_s - self.block.state.time_s);
            if self.block.state.time_s + h <= self.block.state.time_s {
                return;
            }
            if let Some(event) = self.block.step(self.pull, h) {
                self.record.events.push(event);
                self.block.draw(self.pull, &mut self.random);
            }
        }
    }
}
