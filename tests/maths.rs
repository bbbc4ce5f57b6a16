//! Elementary functions as the shipped core has them, against double precision.
//!
//! A unit test inside the core would see std's methods where the board sees a
//! library's: this one goes through the built library. The table it prints
//! (`-- --nocapture`) is where the numbers in `floe_core::math` come from; micromath
//! stands beside libm to show why it is not used for results.

use floe_core::math;
use micromath::F32Ext;

/// How far single-precision answers are off.
#[derive(Default)]
struct Worst {
    ulp: f64,
    relative: f64,
    absolute: f64,
}

impl Worst {
    fn see(&mut self, got: f32, exact: f64) {
        let error = (f64::from(got) - exact).abs();
        assert!(error.is_finite(), "{got} {exact}");
        self.absolute = self.absolute.max(error);
        if exact != 0.0 {
            self.relative = self.relative.max(error / exact.abs());
            self.ulp = self.ulp.max(error / ulp(exact));
        }
    }
}

/// Distance of neighbouring `f32` numbers around a value.
fn ulp(exact: f64) -> f64 {
    let size = (exact.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(f32::from_bits(size.to_bits() + 1)) - f64::from(size)
}

/// Two hundred thousand points, evenly spaced.
fn evenly(from: f32, to: f32) -> impl Iterator<Item = f32> {
    const POINTS: u32 = 200_000;
    (0..=POINTS).map(move |i| from + (to - from) * (i as f32 / POINTS as f32))
}

/// The same, evenly in the logarithm.
fn over_decades(from: f32, to: f32) -> impl Iterator<Item = f32> {
    evenly(from.log2(), to.log2()).map(f32::exp2)
}

fn worst(
    points: impl Iterator<Item = f32>,
    function: impl Fn(f32) -> f32,
    exact: impl Fn(f64) -> f64,
) -> Worst {
    let mut worst = Worst::default();
    points.for_each(|x| worst.see(function(x), exact(f64::from(x))));
    worst
}

fn row(name: &str, range: &str, library: &str, worst: &Worst) {
    println!(
        "| {name} | {range} | {library} | {:.3} ulp | {:.1e} relative | {:.1e} absolute |",
        worst.ulp, worst.relative, worst.absolute
    );
}

/// Angles of points on ellipses: from flat to tall, all four quadrants.
fn worst_atan2(function: impl Fn(f32, f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for ratio in over_decades(1e-6, 1e6) {
        for (y, x) in [(ratio, 1.0), (ratio, -1.0), (-ratio, 1.0), (300.0, 300.0 * ratio)] {
            worst.see(function(y, x), f64::from(y).atan2(f64::from(x)));
        }
    }
    worst
}

/// Variances of forces between micronewtons and meganewtons.
fn variances() -> impl Iterator<Item = f32> {
    over_decades(1e-12, 1e12)
}

/// `omega` times a time within a slip.
fn angles() -> impl Iterator<Item = f32> {
    evenly(-6.3, 6.3)
}

#[test]
fn square_root() {
    let core = worst(variances(), math::sqrt, f64::sqrt);
    row("sqrt", "1e-12 to 1e12", "libm (core)", &core);
    assert!(core.ulp <= 0.5001, "{}", core.ulp);
    let rough = worst(variances(), math::rough_sqrt, f64::sqrt);
    row("rough_sqrt", "1e-12 to 1e12", "micromath (core)", &rough);
    assert!(rough.relative <= 0.061, "{}", rough.relative);
    assert!(variances().all(|x| math::rough_sqrt(x) >= 0.9999 * math::sqrt(x)), "never too small");
    assert!(math::sqrt(-1.0).is_nan());
}

#[test]
fn sine_and_cosine() {
    let sin = worst(angles(), |x| math::sin_cos(x).0, f64::sin);
    let cos = worst(angles(), |x| math::sin_cos(x).1, f64::cos);
    row("sin", "-6.3 to 6.3", "libm (core)", &sin);
    row("cos", "-6.3 to 6.3", "libm (core)", &cos);
    row("sin", "-6.3 to 6.3", "micromath", &worst(angles(), F32Ext::sin, f64::sin));
    row("cos", "-6.3 to 6.3", "micromath", &worst(angles(), F32Ext::cos, f64::cos));
    assert!(sin.ulp <= 1.0 && cos.ulp <= 1.0, "{} {}", sin.ulp, cos.ulp);
}

#[test]
fn angle_of_a_point() {
    let core = worst_atan2(math::atan2);
    row("atan2", "y/x 1e-6 to 1e6", "libm (core)", &core);
    row("atan2", "y/x 1e-6 to 1e6", "micromath", &worst_atan2(F32Ext::atan2));
    assert!(core.ulp <= 2.0, "{}", core.ulp);
}

#[test]
fn arc_cosine() {
    let core = worst(evenly(-1.0, 1.0), math::acos, f64::acos);
    row("acos", "-1 to 1", "libm (core)", &core);
    row("acos", "-1 to 1", "micromath", &worst(evenly(-1.0, 1.0), F32Ext::acos, f64::acos));
    assert!(core.ulp <= 2.0, "{}", core.ulp);
    // Limited, as rounding may leave an argument just outside.
    for x in [1.0, 1.000_001, f32::MAX] {
        assert!(math::acos(x).abs() < 1e-9 && (math::acos(-x) - std::f32::consts::PI).abs() < 1e-6);
    }
}

/// Not used in the core; measured so that the choice stays known.
#[test]
#[allow(clippy::disallowed_methods, reason = "measured, not used")]
fn what_the_core_does_without() {
    let exponents = || evenly(-20.0, 20.0);
    let positives = || over_decades(1e-6, 1e6);
    let exp = worst(exponents(), libm::expf, f64::exp);
    let ln = worst(positives(), libm::logf, f64::ln);
    row("exp", "-20 to 20", "libm", &exp);
    row("exp", "-20 to 20", "micromath", &worst(exponents(), F32Ext::exp, f64::exp));
    row("ln", "1e-6 to 1e6", "libm", &ln);
    row("ln", "1e-6 to 1e6", "micromath", &worst(positives(), F32Ext::ln, f64::ln));
    assert!(exp.ulp <= 1.0 && ln.ulp <= 1.0, "{} {}", exp.ulp, ln.ulp);
}
