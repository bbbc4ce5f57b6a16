//! The core in double precision, generated from its source by `build.rs`.
//!
//! Algorithm and constants are those of [`floe_core`], so every difference on equal samples is
//! rounding.

#![allow(clippy::all, reason = "the core's own text, checked there")]

include!(concat!(env!("OUT_DIR"), "/wide.rs"));
