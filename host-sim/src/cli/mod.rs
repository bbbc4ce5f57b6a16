//! The commands of `floe`.

pub mod simulate;
