//! Integrals of the force over a short time, by Gauss-Legendre quadrature.

/// Points on 0 to 1 and weights of the Gauss-Legendre rule of five points, exact for polynomials of
/// degree 9.
pub(super) const GAUSS_5: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_46, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Integral of `f` from `start` to `end` over panels no longer than `panel`.
pub(super) fn integral(f: impl Fn(f64) -> f64, start: f64, end: f64, panel: f64) -> f64 {
    let panels = ((end - start) / panel).ceil().clamp(1.0, 1e6);
    let width = (end - start) / panels;
    let one = |i: f64| -> f64 {
        let left = start + i * width;
        GAUSS_5.iter().map(|(point, weight)| weight * f(left + point * width)).sum()
    };
    (0..panels as u64).map(|i| one(i as f64)).sum::<f64>() * width
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_right_to_rounding() {
        let value = integral(|t| (40.0 * t).cos(), 0.0, 1.3, 0.25 / 40.0);
        assert!((value - (52.0_f64).sin() / 40.0).abs() < 1e-14);
    }
}
