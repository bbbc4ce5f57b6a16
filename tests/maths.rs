//! The table in `docs/maths.md` is right, and the core's functions are accurate enough.

use floe_core::num::math;
use floe_tests::maths::{Error, FUNCTIONS, Function, bearable, columns, is_used};

/// Distance between neighbouring `f32` numbers just above one.
const EPSILON: f64 = f32::EPSILON as f64;

fn function(name: &str, library: &str) -> Function {
    let named = |f: &&Function| f.name == name && f.library == library;
    *FUNCTIONS.iter().find(named).unwrap_or_else(|| panic!("no {name} of {library}"))
}

#[test]
fn the_table_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/maths.md");
    let page = std::fs::read_to_string(path).unwrap();
    for function in FUNCTIONS {
        let columns = columns(&function);
        let times = page.lines().filter(|line| line.starts_with(&columns)).count();
        assert_eq!(times, 1, "`cargo xtask maths` writes the page; it lacks {columns}");
    }
}

#[test]
fn what_is_used_is_good_enough() {
    for function in FUNCTIONS.iter().filter(|f| is_used(f)) {
        let (error, most) = (Error::of(function), bearable(function.name).unwrap());
        assert!(error.size < most, "{function}: {error}, {most:.1e} can be borne");
    }
    let used = |name: &str| FUNCTIONS.iter().filter(|f| f.name == name && is_used(f)).count();
    assert_eq!(
        ["sqrt", "rough_sqrt", "sin", "cos", "atan2", "acos", "exp", "ln"].map(used),
        [1; 8]
    );
}

#[test]
fn rounded_to_the_neighbour_or_the_next() {
    // Correct rounding: half a distance at most, for the root always.
    assert!(Error::of(&function("sqrt", "floe")).size <= 0.5 * EPSILON);
    for name in ["sin", "cos", "exp"] {
        assert!(Error::of(&function(name, "floe")).size <= EPSILON, "{name}");
    }
    // Largest results: π/2, π and 27.7.
    for (name, largest) in [("atan2", 1.57), ("acos", 3.15), ("ln", 27.7)] {
        let error = Error::of(&function(name, "floe"));
        assert!(error.size <= largest * EPSILON, "{name}: {error}");
    }
}

#[test]
fn the_root_is_the_processors_bit_for_bit() {
    let roots = ["floe", "libm", "hardware"].map(|library| function("sqrt", library).hash());
    assert_eq!([roots[2]; 3], roots);
}

/// Points of ellipses in all four quadrants.
#[test]
fn angle_of_a_point() {
    let ratios = function("atan2", "floe");
    for ratio in (0..100_000).map(|i| ratios.argument(i, 100_000)) {
        for (y, x) in [(ratio, 1.0), (ratio, -1.0), (-ratio, 1.0), (-ratio, -1.0), (1.0, ratio)] {
            let exact = f64::from(y).atan2(f64::from(x));
            let error = (f64::from(math::atan2(y, x)) - exact).abs();
            assert!(error <= 1.5 * EPSILON * exact.abs(), "{y} {x}: {error:e}");
        }
    }
}

#[test]
fn outside_the_range() {
    assert!(math::sqrt(-1.0).is_nan());
    assert!(math::sqrt(0.0).to_bits() == 0 && math::exp(-1e9).to_bits() == 0);
    // The argument is limited to 1, because rounding may leave it slightly above.
    for x in [1.0, 1.000_001, f32::MAX] {
        assert!(math::acos(x).abs() < 1e-9 && (math::acos(-x) - std::f32::consts::PI).abs() < 1e-6);
    }
}

#[test]
fn the_rough_root_is_never_too_small() {
    let rough = function("rough_sqrt", "micromath");
    let arguments = (0..100_000).map(|i| rough.argument(i, 100_000));
    for x in arguments {
        assert!(math::rough_sqrt(x) >= 0.9999 * math::sqrt(x), "{x}");
    }
}
