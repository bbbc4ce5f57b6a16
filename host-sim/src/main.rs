//! The `floe` command.
#![forbid(unsafe_code)]
fn main() {}
