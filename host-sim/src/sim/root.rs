//! Roots and extremes of smooth functions of one variable.

/// Position where `f` changes sign between `low` and `high`, by the ITP method of Oliveira and
/// Takahashi (2020): never slower than bisection.
///
/// `f(low)` and `f(high)` must differ in sign or be zero. The result is a few roundings of the
/// bracket from a sign change, on the side of `high`.
pub(super) fn crossing(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut a, mut b) = (low, high);
    let (mut fa, mut fb) = (f(a), f(b));
    if fa == 0.0 || fb == 0.0 {
        return if fa == 0.0 { a } else { b };
    }
    let sign = fb.signum();
    let tolerance = 4.0 * f64::EPSILON * low.abs().max(high.abs()).max(high - low);
    let bisections = ((b - a) / tolerance).log2().ceil().clamp(1.0, 200.0);
    let mut radius = tolerance * bisections.exp2();
    let truncation = 0.2 / (b - a);
    while b - a > 2.0 * tolerance {
        let middle = 0.5 * (a + b);
        let secant = (b * fa - a * fb) / (fa - fb);
        let toward = (middle - secant).signum();
        let shift = (truncation * (b - a) * (b - a)).min((middle - secant).abs());
        let truncated = secant + toward * shift;
        let reach = (radius - 0.5 * (b - a)).max(0.0);
        let x =
            if (truncated - middle).abs() <= reach { truncated } else { middle - toward * reach };
        let x = x.clamp(a, b);
        let y = f(x);
        if y == 0.0 {
            return x;
        }
        if y * sign > 0.0 {
            (b, fb) = (x, y);
        } else {
            (a, fa) = (x, y);
        }
        radius *= 0.5;
        if radius < tolerance {
            radius = 0.5 * (b - a);
        }
    }
    b
}

/// Position of the minimum of `f` between `low` and `high`, by golden section.
pub(super) fn lowest(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (mut a, mut b) = (low, high);
    while b - a > 1e-9 * (high - low) {
        let (x, y) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if f(x) < f(y) { b = y } else { a = x }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_found_to_rounding() {
        type Case = (fn(f64) -> f64, f64, f64, f64);
        let cases: [Case; 4] = [
            (|x| x * x - 2.0, 0.0, 2.0, std::f64::consts::SQRT_2),
            (|x| (x - 1e-6).powi(3), 0.0, 1.0, 1e-6),
            (f64::cos, 0.0, 3.0, std::f64::consts::FRAC_PI_2),
            (|x| 1.0 - x, 0.0, 1.0, 1.0),
        ];
        for (f, low, high, root) in cases {
            let found = crossing(f, low, high);
            assert!((found - root).abs() <= 10.0 * f64::EPSILON * high, "{found} {root}");
        }
    }

    #[test]
    fn the_lowest_point_is_found() {
        assert!((lowest(|x| (x - 0.3).powi(2), 0.0, 1.0) - 0.3).abs() < 1e-7);
    }
}
