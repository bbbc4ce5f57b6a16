//! Friction of a block pulled over ice, read from the force in its cable.
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
#![no_std]
#![forbid(unsafe_code)]

mod arrow;
pub mod budget;
pub mod calibrate;
pub mod change;
pub mod config;
pub mod corner;
pub mod correlation;
pub mod cycle;
pub mod decimate;
pub mod derivative;
pub mod detector;
pub mod division;
pub mod double;
mod drift;
pub mod estimator;
pub mod event;
mod finishing;
pub mod fit;
mod floor;
mod learnt;
mod learnt_corner;
pub mod line;
pub mod mass;
pub mod math;
pub mod memory;
pub mod model;
pub mod noise;
mod pending;
pub mod pipeline;
pub mod posterior;
pub mod profile;
pub mod quantile;
pub mod report;
pub mod residuals;
mod sag;
pub mod sample;
pub mod shared;
mod slack;
pub mod solve;
pub mod spike;
pub mod units;
pub mod whiteness;
pub mod window;

pub use budget::{Entry, Input, budget};
pub use change::{Cause, Change};
pub use config::{Calibration, Config, ConfigError, InputStd};
pub use event::{Coefficient, Event, Provisional, Quality, Reason, SampleTime};
pub use pipeline::{Pipeline, Step};
pub use report::{Counters, Estimate, Quantity, Report};
pub use sample::{Fault, ForceSample, Phase, RawSample, Reading, SampleFlag};
pub use units::{Counts, Newtons};
