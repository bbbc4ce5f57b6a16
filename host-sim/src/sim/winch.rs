//! The speed of the winch over time.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardUniform};
use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, not_negative, positive, require};

/// Longest integration step over the period of a ripple.
const PART_OF_RIPPLE: f64 = 0.125;

/// A winch whose speed varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "snake_case")]
pub enum WinchProfile {
    /// `w (1 + fraction sin(2 pi t / period_s))`: also the cogging of a motor.
    Ripple {
        /// Amplitude over the mean speed, 0 to 1.
        fraction: f64,
        /// Period, s.
        period_s: f64,
    },
    /// Runs, stops, runs again.
    StopAndGo {
        /// Time of running, s.
        go_s: f64,
        /// Time of standing, s.
        stop_s: f64,
    },
    /// Stops at random: exponentially distributed times of running, uniformly distributed times of
    /// standing.
    Pauses {
        /// Mean time of running, s.
        every_s: f64,
        /// Shortest time of standing, s.
        least_s: f64,
        /// Longest time of standing, s.
        most_s: f64,
    },
    /// Runs at another speed until the first slip has ended.
    FirstSlip {
        /// Speed until then, over the nominal speed.
        factor: f64,
    },
    /// Changes of speed, `[time_s, factor]`: from each time on the nominal speed times the factor;
    /// 1 before the first. With a negative factor the winch pays out cable.
    Steps {
        /// Changes in order of time.
        steps: Vec<[f64; 2]>,
        /// The sequence repeats after this time, s; it does not if not given.
        period_s: Option<f64>,
    },
}

impl WinchProfile {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        match self {
            Self::Ripple { fraction, period_s } => {
                between("winch_profile.fraction", *fraction, 0.0, 1.0)?;
                positive("winch_profile.period_s", *period_s)
            }
            Self::StopAndGo { go_s, stop_s } => {
                positive("winch_profile.go_s", *go_s)?;
                positive("winch_profile.stop_s", *stop_s)
            }
            Self::Pauses { every_s, least_s, most_s } => {
                positive("winch_profile.every_s", *every_s)?;
                positive("winch_profile.least_s", *least_s)?;
                between("winch_profile.most_s", *most_s, *least_s, 1e6)
            }
            Self::FirstSlip { factor } => between("winch_profile.factor", *factor, 0.01, 100.0),
            Self::Steps { steps, period_s } => validate_steps(steps, *period_s),
        }
    }

    /// Number of steps that the computation takes for the winch alone, about.
    pub(super) fn work(&self, duration_s: f64) -> f64 {
        match self {
            Self::Ripple { period_s, .. } => duration_s / (PART_OF_RIPPLE * period_s),
            Self::StopAndGo { go_s, stop_s } => 2.0 * duration_s / (go_s + stop_s),
            Self::Pauses { every_s, least_s, most_s } => {
                2.0 * duration_s / (every_s + 0.5 * (least_s + most_s))
            }
            Self::FirstSlip { .. } => 1.0,
            Self::Steps { steps, period_s } => {
                steps.len() as f64 * period_s.map_or(1.0, |period_s| duration_s / period_s)
            }
        }
    }
}

fn validate_steps(steps: &[[f64; 2]], period_s: Option<f64>) -> Result<(), SceneError> {
    let mut before_s = 0.0;
    for &[at_s, factor] in steps {
        not_negative("winch_profile.steps: time", at_s)?;
        require(at_s >= before_s, || format!("winch_profile.steps: {at_s} s is out of order"))?;
        between("winch_profile.steps: factor", factor, -100.0, 100.0)?;
        before_s = at_s;
    }
    let last_s = before_s;
    require(period_s.is_none_or(|p| p.is_finite() && p > last_s), || {
        "winch_profile.period_s: must be after the last step".to_owned()
    })
}

/// State of the winch. Its speed changes in steps at [`Winch::next_s`], and with a ripple also
/// continuously in between.
#[derive(Clone, Debug)]
pub(super) struct Winch {
    nominal_m_per_s: f64,
    factor: f64,
    next_s: f64,
    /// Steps passed.
    passed: u32,
    profile: Option<WinchProfile>,
    random: ChaCha8Rng,
}

impl Winch {
    pub(super) fn new(
        nominal_m_per_s: f64,
        profile: Option<WinchProfile>,
        random: ChaCha8Rng,
    ) -> Self {
        let factor = match profile {
            Some(WinchProfile::FirstSlip { factor }) => factor,
            _ => 1.0,
        };
        let next_s = f64::INFINITY;
        let mut winch = Self { nominal_m_per_s, factor, next_s, passed: 0, profile, random };
        winch.next_s = winch.following_s(0.0);
        if winch.next_s <= 0.0 {
            winch.pass();
        }
        winch
    }

    /// Speed, m/s.
    pub(super) fn m_per_s(&self, time_s: f64) -> f64 {
        let ripple = match self.profile {
            Some(WinchProfile::Ripple { fraction, period_s }) => {
                fraction * (std::f64::consts::TAU * time_s / period_s).sin()
            }
            _ => 0.0,
        };
        self.nominal_m_per_s * self.factor * (1.0 + ripple)
    }

    /// Nominal speed, to which the laws of friction refer, m/s.
    pub(super) fn nominal_m_per_s(&self) -> f64 {
        self.nominal_m_per_s
    }

    /// Time of the next step of the speed, s; infinite if there is none.
    pub(super) fn next_s(&self) -> f64 {
        self.next_s
    }

    /// The longest integration step that cannot miss an event, s.
    pub(super) fn longest_step_s(&self) -> f64 {
        match self.profile {
            Some(WinchProfile::Ripple { period_s, .. }) => PART_OF_RIPPLE * period_s,
            _ => f64::INFINITY,
        }
    }

    /// Applies the step of the speed at [`Winch::next_s`].
    pub(super) fn pass(&mut self) {
        let now_s = self.next_s;
        self.factor = match &self.profile {
            Some(WinchProfile::StopAndGo { .. } | WinchProfile::Pauses { .. }) => 1.0 - self.factor,
            Some(WinchProfile::Steps { steps, .. }) => steps[self.passed as usize % steps.len()][1],
            Some(WinchProfile::Ripple { .. } | WinchProfile::FirstSlip { .. }) | None => 1.0,
        };
        self.passed += 1;
        self.next_s = self.following_s(now_s);
    }

    /// To be called when a slip has ended.
    pub(super) fn note_stop(&mut self) {
        if let Some(WinchProfile::FirstSlip { .. }) = self.profile {
            self.factor = 1.0;
        }
    }

    /// Time of the change after the one at `now_s`.
    fn following_s(&mut self, now_s: f64) -> f64 {
        let running = self.factor > 0.0;
        match &self.profile {
            // Computed from the number of the cycle, so that rounding errors do not add up.
            Some(WinchProfile::StopAndGo { go_s, stop_s }) => {
                let start_s = f64::from(self.passed / 2) * (go_s + stop_s);
                start_s + if running { *go_s } else { go_s + stop_s }
            }
            Some(WinchProfile::Pauses { every_s, least_s, most_s }) => {
                let u: f64 = StandardUniform.sample(&mut self.random);
                let running_s = -every_s * (1.0 - u).ln();
                now_s + if running { running_s } else { least_s + u * (most_s - least_s) }
            }
            Some(WinchProfile::Steps { steps, period_s }) => {
                let round = self.passed as usize / steps.len().max(1);
                let within = steps.get(self.passed as usize % steps.len().max(1));
                match (within, period_s) {
                    (Some(step), None) if round == 0 => step[0],
                    (Some(step), Some(period_s)) => round as f64 * period_s + step[0],
                    _ => f64::INFINITY,
                }
            }
            Some(WinchProfile::Ripple { .. } | WinchProfile::FirstSlip { .. }) | None => {
                f64::INFINITY
            }
        }
    }
}
