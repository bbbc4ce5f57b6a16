//! The steps of a converter, found from readings that lie on them.

/// Largest number of which all differences of `numbers` are multiples, by Euclid's algorithm with
/// remainders up to `tolerance` taken for zero. Zero where it is less than eight times that, as for
/// arbitrary numbers. Every turn of the inner loop halves the remainder: there are at most 32
/// turns, and one a number.
pub(crate) fn spacing(numbers: impl Iterator<Item = f32>, tolerance: f32) -> f32 {
    const CLEAR: f32 = 8.0;
    let (mut first, mut spacing) = (None, f32::INFINITY);
    for number in numbers {
        let Some(first) = first else {
            first = Some(number);
            continue;
        };
        let mut distance: f32 = number - first;
        distance = distance.abs();
        let mut left = distance;
        while left > tolerance {
            let rest = remainder(spacing, left);
            (spacing, left) = (left, rest);
        }
        // Rounding matters less the further two numbers are apart: the spacing follows once more
        // from this distance.
        let steps = whole(distance / spacing);
        if steps > 0.0 {
            spacing = distance / steps;
        }
        if spacing < CLEAR * tolerance {
            return 0.0;
        }
    }
    if spacing.is_finite() { spacing } else { 0.0 }
}

/// Distance of a number from the nearest multiple of another; zero where that multiple is beyond a
/// million, as for an infinite number.
fn remainder(number: f32, step: f32) -> f32 {
    let steps = number / step;
    if steps < 1e6 { (number - step * whole(steps)).abs() } else { 0.0 }
}

/// Rounds to the nearest whole number.
fn whole(steps: f32) -> f32 {
    (steps + 0.5) as i32 as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f32 = 0.01;

    #[test]
    fn steps_are_seen_and_numbers_anywhere_have_none() {
        let steps = [9.0, 9.0, -26.0, -49.0, 4.0, 9.0, 8.0];
        for step in [5.0, 0.5, 2.44] {
            let mut force_n = 700.0;
            let forces = steps.map(|n| {
                force_n += n * step;
                force_n
            });
            let seen = spacing(forces.into_iter(), TOLERANCE);
            assert!((seen - step).abs() < TOLERANCE, "{seen}, not {step}");
        }
        let anywhere = [12.34, 77.891, 103.017, 311.46, 290.339, 17.52];
        assert!(spacing(anywhere.into_iter(), TOLERANCE) <= 0.0);
        assert!(spacing([3.0; 9].into_iter(), TOLERANCE) <= 0.0);
        assert!(spacing([f32::NAN, 1.0, f32::INFINITY].into_iter(), TOLERANCE).is_finite());
    }

    #[test]
    fn steps_are_seen_in_rounded_numbers() {
        let steps = [0.0, 5.0, 32.0, 98.0, 122.0, 117.0, 112.0];
        let forces_n = steps.map(|n: f32| libm::roundf((776.356 - 4.5137 * n) * 1e3) / 1e3);
        let seen = spacing(forces_n.into_iter(), 0.03);
        assert!((seen - 4.5137).abs() < 1e-3, "{seen}");
    }
}
