//! The block on a cable by brute force: Newton's law in small steps.
//!
//! Knows none of the formulas it is to check: no ellipse, no closed times.

/// What is pulled; SI units.
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
    /// Compliance of the sag, N³·(m/N)/... : stretch = F/k + sag (1/F0² − 1/F²)/2.
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
    /// Time of the first sample after the start, s.
    pub delay_s: f64,
    /// Time step, s.
    pub step_s: f64,
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
            step_s: 2e-5,
        }
    }
}

/// What really happened in one event.
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
    /// Smallest speed the equations would reach, m/s.
    pub top_speed_m_per_s: f64,
    /// Coefficients.
    pub mu_s: f64,
    /// Dynamic.
    pub mu: f64,
    /// The cable went slack.
    pub slack: bool,
}

/// A finished pull: forces at `delay + i / rate`, and the truth.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Forces, N.
    pub forces_n: Vec<f64>,
    /// Events.
    pub events: Vec<Truth>,
}

/// Runs the pull.
#[must_use]
pub fn run(pull: &Pull, seed: u64) -> Record {
    let mut random = crate::normal::Normal::new(seed);
    let mut block = Block::new(pull, &mut random);
    let mut record = Record::default();
    let (mut sum, mut parts) = (0.0, 0);
    let mut sample_s = pull.delay_s;
    let steps = (pull.duration_s / pull.step_s) as u64;
    for i in 0..steps {
        let time_s = i as f64 * pull.step_s;
        if time_s > sample_s - pull.aperture_s - pull.step_s {
            sum += block.force_n(pull);
            parts += 1;
        }
        if time_s >= sample_s {
            let force_n =
                if pull.aperture_s > 0.0 { sum / f64::from(parts) } else { block.force_n(pull) };
            record.forces_n.push(force_n + pull.noise_n * random.sample());
            (sum, parts) = (0.0, 0);
            sample_s = pull.delay_s + record.forces_n.len() as f64 / pull.rate_hz;
        }
        if let Some(event) = block.step(pull, time_s, &mut random) {
            record.events.push(event);
        }
    }
    record
}

#[derive(Debug)]
struct Block {
    /// Cable taken up minus way of the block, m.
    stretch_m: f64,
    speed_m_per_s: f64,
    sliding: bool,
    now: Truth,
}

impl Block {
    fn new(pull: &Pull, random: &mut crate::normal::Normal) -> Self {
        let mut block =
            Self { stretch_m: 0.0, speed_m_per_s: 0.0, sliding: false, now: Truth::default() };
        block.draw(pull, random);
        let rest = pull.weight_n * (2.0 * pull.mu - pull.mu_s);
        block.stretch_m = rest.max(0.0) / pull.stiffness_n_per_m;
        block
    }

    fn draw(&mut self, pull: &Pull, random: &mut crate::normal::Normal) {
        let mut vary = || 1.0 + pull.variation * random.sample().clamp(-2.0, 2.0);
        self.now = Truth { mu_s: pull.mu_s * vary(), mu: pull.mu * vary(), ..Truth::default() };
    }

    fn force_n(&self, pull: &Pull) -> f64 {
        let force_n = pull.stiffness_n_per_m * self.stretch_m;
        if force_n <= 0.0 || pull.sag_n2_m <= 0.0 {
            return force_n.max(0.0);
        }
        // F/k − sag/(2 F²) = stretch, by Newton's rule.
        let mut f = force_n.max(50.0);
        for _ in 0..20 {
            let value = f / pull.stiffness_n_per_m - pull.sag_n2_m / (2.0 * f * f) - self.stretch_m;
            let slope = 1.0 / pull.stiffness_n_per_m + pull.sag_n2_m / (f * f * f);
            f = (f - value / slope).max(0.5 * f);
        }
        f
    }

    fn step(
        &mut self,
        pull: &Pull,
        time_s: f64,
        random: &mut crate::normal::Normal,
    ) -> Option<Truth> {
        let (sin, cos) = pull.slope_rad.sin_cos();
        let ripple = 1.0 + pull.ripple.0 * (std::f64::consts::TAU * time_s / pull.ripple.1).sin();
        let winch = pull.winch_m_per_s * ripple;
        let force_n = self.force_n(pull);
        let limit_n = pull.weight_n * (sin + self.now.mu_s * cos);
        if !self.sliding {
            if force_n < limit_n {
                self.stretch_m += winch * pull.step_s;
                return None;
            }
            self.sliding = true;
            self.now.onset_s = time_s;
            self.now.static_n = force_n;
        }
        let mass_kg = pull.weight_n / 9.806_65;
        let drag_n = pull.weight_n * (sin + self.now.mu * cos);
        let acceleration = (force_n - drag_n) / mass_kg;
        // Midpoint in the stretch, so that the ellipse keeps its size.
        self.speed_m_per_s += acceleration * pull.step_s;
        self.stretch_m += (winch - self.speed_m_per_s) * pull.step_s;
        self.now.peak_n = self.now.peak_n.max(force_n);
        self.now.top_speed_m_per_s = self.now.top_speed_m_per_s.max(self.speed_m_per_s);
        self.now.slack |= self.stretch_m < 0.0;
        if self.speed_m_per_s > 0.0 {
            return None;
        }
        (self.sliding, self.speed_m_per_s) = (false, 0.0);
        let event = Truth { stop_s: time_s, restick_n: self.force_n(pull), ..self.now };
        self.draw(pull, random);
        Some(event)
    }
}
