//! Errors of the elementary functions, and the largest acceptable errors.

use std::fmt;

#[path = "../../firmware/src/bin/mps2-test/functions.rs"]
mod functions;

mod hardware {
    /// Square root by the instruction of the PC.
    pub fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }
}

pub use functions::{EMPTY, FUNCTIONS, Function};

/// Number of points at which a function is evaluated.
const POINTS: u32 = 1_000_000;

/// Largest error of a function: relative to the exact result, or absolute for functions with a
/// zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Magnitude of the error.
    pub size: f64,
    /// Whether the error is relative to the result.
    pub relative: bool,
}

impl Error {
    /// The largest error of a function over its range, compared with double precision.
    #[must_use]
    pub fn of(function: &Function) -> Self {
        let exact: fn(f64) -> f64 = match function.name {
            "sqrt" | "rough_sqrt" => f64::sqrt,
            "sin" => f64::sin,
            "cos" => f64::cos,
            "atan2" => f64::atan,
            "acos" => f64::acos,
            "exp" => f64::exp,
            "ln" => f64::ln,
            other => panic!("no exact {other}"),
        };
        let relative = matches!(function.name, "sqrt" | "rough_sqrt" | "exp");
        let size = |i| {
            let x = function.argument(i, POINTS);
            let (got, exact) = (f64::from((function.call)(x)), exact(f64::from(x)));
            assert!(got.is_finite(), "{function} at {x}: {got}");
            if relative { (got / exact - 1.0).abs() } else { (got - exact).abs() }
        };
        Self { size: (0..=POINTS).map(size).fold(0.0, f64::max), relative }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1e}{}", self.size, if self.relative { " relative" } else { "" })
    }
}

/// Acceptable error of a force, in weights. The fit at most doubles it, so it moves a coefficient
/// by a fiftieth of an event's smallest standard deviation, `0.14 σ / M g` at a noise of 0.1 % of
/// the weight.
const FORCE: f64 = 0.02 * 0.14 * 0.001 / 2.0;
/// Test DFF8-13: `mu_s − mu`; and `k w / (ω M g) = w ω / g` at the fastest winch.
const DROP: f64 = 1.24 - 0.78;
const WINCH: f64 = 0.04 * 18.9 / floe_core::units::STANDARD_GRAVITY_M_PER_S2;
/// Range of a creep's force, in weights: a sixth of `DROP`.
const CREEP: f64 = 0.08;
/// Angle at which a fit begins, rad.
const GUESS: f64 = 0.1;

/// Largest acceptable error of a function in its use by the core; `None` if the core does not use
/// it. `docs/maths.md` has the reasons.
#[must_use]
pub fn bearable(name: &str) -> Option<f64> {
    match name {
        "sqrt" => Some(FORCE / DROP.hypot(WINCH)),
        "rough_sqrt" => Some(0.1),
        "sin" | "cos" => Some(FORCE / DROP),
        "atan2" => Some(FORCE / (2.0 * WINCH)),
        "exp" | "ln" => Some(FORCE / CREEP),
        "acos" => Some(GUESS),
        _ => None,
    }
}

/// Whether the core calls this function.
#[must_use]
pub fn is_used(function: &Function) -> bool {
    let library = match function.name {
        "rough_sqrt" => "micromath",
        _ => "floe",
    };
    function.library == library && bearable(function.name).is_some()
}

/// The columns of the table in `docs/maths.md` that are equal on every machine.
#[must_use]
pub fn columns(function: &Function) -> String {
    let error = Error::of(function);
    let share = bearable(function.name).map_or("-".into(), |most| times(error.size / most));
    let used = if is_used(function) { "yes" } else { "" };
    let (from, to) = function.range;
    let range = if from <= 0.0 { format!("{from} to {to}") } else { format!("{from:e} to {to:e}") };
    format!("| {} | {range} | {} | {used} | {error} | {share} |", function.name, function.library)
}

fn times(part: f64) -> String {
    match part {
        ..0.001 => "< 0.001".into(),
        ..10.0 => format!("{part:.3}"),
        _ => format!("{part:.0}"),
    }
}
