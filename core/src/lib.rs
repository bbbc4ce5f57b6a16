//! Friction of a block pulled over ice, estimated from the force in its cable.
//!
//! ```text
//!  counts ─► calibrate ─► derivative ─► detector ─► cycle ─► estimator ─► report
//!  RawSample  ForceSample   dF/dt        stick|slip   Event     mu_s, mu    Report
//!  └───────────────────────────── Pipeline::step ─────────────────────────────┘
//! ```
//!
//! One call per sample, [`Pipeline::step`], is all that the firmware and the host
//! tools use. The crate knows no clock, no input or output, no allocation and no
//! globals: a sample carries its index, and seconds are index over rate.
//!
//! The model is the block on a cable of Pritchard, Knoke and Echert (2012); see
//! [`model`] for its equations.
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | rest, stick | the block stands still while the winch stretches the cable |
//! | stick line | the straight line of the force in a rest; its slope is the loading rate `r = k w` |
//! | slip | the block slides; it begins at the *onset* and ends at the *stop* |
//! | re-stick | the detector has seen that a slip is over |
//! | swing | `1/ω` of the sliding block, periods; not an *oscillation* of the force about its line |
//! | rate change | loading rate after a slip less that before it |
//! | corner | the bend between stick line and slip |
//! | innovation | a sample less the forecast of the stick line so far |
//! | level | a force that a fit compares with the model: a sample's, or that of a line's middle |
//! | wander | departure of the force from a stick line beyond white noise |
//! | expectation, prior | distribution of an unknown that earlier events give |
//!
//! Unless a name says otherwise a force is in newtons and a time in sampling *periods*; `_n2` is
//! the variance or square of a force, N². A variance *in units of the noise* is over that of a
//! sample.
#![no_std]
#![forbid(unsafe_code)]
#![warn(unreachable_pub)]

mod budget;
mod coefficient;
mod config;
mod cycle;
pub mod detector;
mod effect;
mod effects;
pub mod estimator;
mod event;
mod fit;
pub mod model;
mod noise;
pub mod num;
mod pipeline;
mod report;
mod sample;
pub mod signal;
mod stats;
mod stretch;
pub mod units;

pub use budget::{Entry, Input, Losses, Share, budget, of_constant_force};
pub use coefficient::{Coefficient, Estimate};
pub use config::{Calibration, Config, ConfigError, InputStd};
pub use effect::{Effect, Effects, Finding, Parameter};
pub use effects::level_shift::{Cause, Change};
pub use event::{Event, Provisional, Quality, Reason};
pub use pipeline::{Pipeline, Step};
pub use report::{Counters, Report};
pub use sample::{Fault, ForceSample, Phase, RawSample, Reading, SampleFlag, SampleTime};
pub use stats::quantity::Quantity;
pub use stretch::{Stretch, StretchKind};
pub use units::{Counts, Newtons};

#[cfg(test)]
mod tests {
    /// Random numbers for unit tests, the same on every machine.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Random(pub(crate) u32);

    impl Random {
        /// Even between zero and one.
        pub(crate) fn even(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (self.0 >> 8) as f32 / 16_777_216.0
        }

        /// Nearly normal, of variance one: the sum of twelve even ones.
        pub(crate) fn normal(&mut self) -> f32 {
            (0..12).fold(-6.0, |sum, _| sum + self.even())
        }
    }
}
