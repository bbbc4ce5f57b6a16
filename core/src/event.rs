//! One stick-slip cycle as it was measured.

use core::fmt;

use crate::coefficient::Coefficient;
use crate::sample::SampleTime;

/// A first answer on a slip that is going on or has just ended, from the samples so far and the
/// expectations from earlier events. The [`Event`] itself is complete when the next slip has ended
/// the stick line after this one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Provisional {
    /// Static coefficient.
    pub mu_s: Coefficient,
    /// Dynamic coefficient; unknown while the force falls, and after a slip on a slack cable.
    pub mu: Option<Coefficient>,
}

/// How far an event can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Quality {
    /// The model fits the samples.
    Good,
    /// The slip is too short for the sampling: intervals are wider.
    Unresolved,
    /// The cable went slack.
    Slack,
    /// A saturated sample or a gap lies inside.
    Clipped,
}

/// Why an event gives no coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Reason {
    /// The slip began or ended inside a gap or saturated samples.
    Hidden,
    /// Too few samples around the slip to fit the model.
    TooShort,
    /// More samples lie in the slip than are kept.
    TooLong,
    /// The model does not describe the samples.
    NoFit,
    /// Omega differs from that of the events before: the mass may have changed. The next event
    /// decides.
    Suspect,
    /// Fewer than four samples from slip to slip; or loading rate and winch speed give a far
    /// stiffer cable than omega does.
    Aliased,
    /// No rest beside the fall: the force does not rise before it, does not rise again after it, or
    /// rises as it falls, like an oscillation.
    NoRest,
    /// A coefficient above 3, or clearly below zero.
    Implausible,
    /// The force falls to zero at once, or stays there too long: the cable may have been let go.
    LetGo,
    /// The force falls along a straight line, as a winch that turns back makes it: no slip.
    WoundBack,
    /// The force is below zero: no slip.
    Negative,
    /// The force scatters too much to show a slip.
    Scatters,
}

impl Reason {
    /// Does the reason say that nothing slipped, so that there is no event?
    #[must_use]
    pub fn is_no_slip(self) -> bool {
        matches!(self, Self::WoundBack | Self::Negative | Self::Scatters)
    }

    /// Does the reason say that the force does not take the course of a slip?
    pub(crate) fn is_of_shape(self) -> bool {
        matches!(self, Self::NoFit | Self::NoRest | Self::LetGo)
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Good => "good",
            Self::Unresolved => "unresolved",
            Self::Slack => "slack",
            Self::Clipped => "clipped",
        })
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hidden => "a gap or saturated samples hide the slip",
            Self::TooShort => "too few samples around the slip",
            Self::TooLong => "the slip has more samples than are kept: sample more slowly",
            Self::NoFit => "the model does not describe the samples",
            Self::Suspect => "omega is another than before: another block, or the pull changed in the slip",
            Self::Aliased => {
                "fewer than four samples from slip to slip: sample faster, or check weight and winch speed"
            }
            Self::NoRest => {
                "no rest shows before or after it: the winch stood, the block slid on, or the force swings"
            }
            Self::Implausible => "a coefficient above 3 or below 0: check weight, unit and zero",
            Self::LetGo => {
                "the force falls to nothing at once or stays there: the cable may have been let go"
            }
            Self::WoundBack => "the force falls evenly: the winch turned back",
            Self::Scatters => "the force scatters: noise, or slips too fast for the sampling",
            Self::Negative => "the force is below zero: check polarity and zero",
        })
    }
}

/// One stick-slip cycle: the stick before, the onset, the slip, the re-stick.
///
/// Symbols as in the paper: `Fs` force at the onset, `Fp` centre of the ellipse,
/// `Fe` force at the re-stick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// Number of the event in its test, from 0.
    pub index: u32,
    /// The slip begins.
    pub onset: SampleTime,
    /// The block rests again.
    pub stop: SampleTime,
    /// `Fs`, N.
    pub static_force_n: f32,
    /// `Fp`, N.
    pub dynamic_force_n: f32,
    /// Largest force of the cycle, a little after the onset, N.
    pub peak_force_n: f32,
    /// `Fe`, N.
    pub restick_force_n: f32,
    /// Static coefficient.
    pub mu_s: Option<Coefficient>,
    /// Dynamic coefficient.
    pub mu: Option<Coefficient>,
    /// Time of rest before the onset, s; unknown for the first event.
    pub stick_s: Option<f32>,
    /// Time of motion, s.
    pub slip_s: f32,
    /// Rate of the force while the block rests, `k w`, N/s.
    pub loading_rate_n_per_s: f32,
    /// Natural frequency while sliding, rad/s; unknown for unresolved slips.
    pub omega_rad_per_s: Option<f32>,
    /// The cable went slack during the slip.
    pub slack: bool,
    /// How far the event can be trusted.
    pub quality: Quality,
    /// Why a coefficient is missing.
    pub reason: Option<Reason>,
}
