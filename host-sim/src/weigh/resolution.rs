//! Uncertainty of a mean due to the step of its readings.

use std::f64::consts::PI;

/// Standard deviation, N, that the step adds to the mean of the `last` readings, failed ones
/// included; `None` where all are equal.
///
/// Noise larger than the step averages the error out, by the factor `exp(-2 pi² noise² / step²)`.
/// Readings that alternate between two values show no noise: they scatter by at most half a step.
pub(super) fn std_n(readings: &[Option<f32>], last: usize) -> Option<f64> {
    let readings = readings.get(readings.len().saturating_sub(last)..).unwrap_or_default();
    let forces: Vec<f64> = readings.iter().flatten().map(|&force_n| force_n.into()).collect();
    let differences = || {
        forces.windows(2).map(|pair| match pair {
            [a, b] => (a - b).abs(),
            _ => 0.0,
        })
    };
    let step_n = differences().filter(|&it| it > 0.0).min_by(f64::total_cmp)?;
    let squares = differences().map(|it| it * it).sum::<f64>();
    let scatter = squares / (2.0 * forces.len() as f64) / (step_n * step_n);
    let averaged = (-2.0 * PI * PI * (scatter - 0.25).max(0.0)).exp();
    Some(step_n / 12.0_f64.sqrt() * averaged)
}

#[cfg(test)]
mod tests {
    fn std_n(forces_n: impl Iterator<Item = f32>) -> Option<f64> {
        super::std_n(&forces_n.map(Some).collect::<Vec<_>>(), 640)
    }

    #[test]
    fn a_step_counts_where_no_noise_averages_it_out() {
        let rarely = (0..640).map(|i: u16| if i.is_multiple_of(7) { 640.0 } else { 630.0 });
        assert!((std_n(rarely).expect("a step") - 2.887).abs() < 0.01);
        let noisy = (0..640).map(|i: u16| 630.0 + f32::from(i % 7 * (i % 7) % 7));
        assert!(std_n(noisy).expect("a step") < 1e-6);
        assert_eq!(std_n((0..640).map(|_| 630.0)), None);
        let before = (0..1280).map(|i: u16| if i < 640 { f32::from(i) } else { 630.0 });
        assert_eq!(std_n(before), None, "what came before the weighing tells nothing");
    }
}
