//! Measures elementary functions on this PC, for `cargo xtask maths`.
//!
//! Prints `NAME/LIBRARY NS` lines: the shortest of 100 rounds of 4096 dependent calls, minus the
//! time of an empty call.

use std::hint::black_box;
use std::time::Instant;

use floe_tests::maths::{EMPTY, FUNCTIONS, Function};

const ROUNDS: u32 = 100;
const CALLS: u32 = 4096;

fn main() {
    let empty_ns = nanoseconds(&EMPTY);
    for function in FUNCTIONS {
        println!("{function} {:.2}", (nanoseconds(&function) - empty_ns).max(0.0));
    }
}

/// Time of a call, ns.
fn nanoseconds(function: &Function) -> f64 {
    let arguments: Vec<f32> = (0..CALLS).map(|i| function.argument(i, CALLS)).collect();
    let call = black_box(function.call);
    let round = |_| {
        let start = Instant::now();
        // Adding the result times zero makes each call depend on the previous one.
        black_box(arguments.iter().fold(0.0, |last, &x| call(x + 0.0 * last)));
        start.elapsed()
    };
    let shortest = (0..ROUNDS).map(round).min().unwrap_or_default();
    1e9 * shortest.as_secs_f64() / f64::from(CALLS)
}
