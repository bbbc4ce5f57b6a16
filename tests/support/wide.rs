//! The core in double precision, made from its own source by `build.rs`.
//!
//! The same algorithm with the same constants: whatever differs from [`floe_core`]
//! on the same samples is rounding.

#![allow(clippy::all, reason = "the core's own text, checked there")]

include!(concat!(env!("OUT_DIR"), "/wide.rs"));
