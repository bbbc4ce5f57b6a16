//! Rounded corners: creep before the onset, and a converter that averages.

use floe_core::model::CycleParams;
use floe_core::model::corner::Corner;

/// Test DFF8-13 in sampling periods of 1/16 s.
fn dff8_13() -> CycleParams {
    let (static_n, half_drop_n) = (781.2, 289.8);
    CycleParams { onset: 0.0, rate: 22.5, static_n, half_drop_n, omega: 1.1828, rate_change: 0.0 }
}

/// `F' = r (1 - f exp((F - Fs) / c))` before the onset, and Newton's law after it.
#[test]
fn core_force_of_a_creeping_block() {
    const STEP: f64 = 1e-4;
    let cycle = dff8_13();
    let [r, fs, omega] = [cycle.rate, cycle.static_n, cycle.omega].map(f64::from);
    let (fp, shape) = (f64::from(cycle.dynamic_n()), cycle.shape());
    for (f, c) in [(0.2, 30.0), (0.5, 10.0), (0.5, 30.0), (0.8, 60.0)] {
        let missing_n = (-c * f64::ln(1.0 - f)) as f32;
        let corner = Corner { smoothing: 0.0, missing_n, range_n: c as f32 };
        let model = |time: f64| {
            let since_onset = time as f32;
            f64::from(shape.force(since_onset).0 + corner.at(&shape).shift(since_onset).force_n)
        };
        let creeping = |force_n: f64| r * (1.0 - f * ((force_n - fs) / c).exp());
        let mut force_n = fs;
        for i in 0..60_000 {
            let half = force_n - 0.5 * STEP * creeping(force_n);
            force_n -= STEP * creeping(half);
            let time = -STEP * f64::from(i + 1);
            let error = model(time) - force_n;
            assert!(error.abs() < 1e-3, "f {f}, c {c}: {error} N at {time}");
        }
        let (mut force_n, mut rate, mut time) = (fs, (1.0 - f) * r, 0.0);
        while time < 1.0 || rate < r {
            rate += STEP * omega * omega * (fp - force_n - 0.5 * STEP * rate);
            force_n += STEP * rate;
            time += STEP;
            // The stop is modelled to first order; an error of f² q² / 2 d remains.
            let error = model(time) - force_n;
            assert!(error.abs() < 0.45, "f {f}, c {c}: {error} N at {time}");
        }
        let error = model(time + 3.0) - (force_n + 3.0 * r);
        assert!(error.abs() < 0.45, "f {f}, c {c}: {error} N after the stop");
    }
}

/// The force averaged over an aperture around each time.
#[test]
fn core_force_that_a_converter_averages() {
    const PIECES: i32 = 400;
    let (cycle, aperture) = (dff8_13(), 0.6);
    let shape = cycle.shape();
    let corner = Corner { smoothing: aperture * aperture / 24.0, missing_n: 0.0, range_n: 30.0 };
    for i in 0..600 {
        let since_onset = 0.01 * i as f32 - 1.5;
        let mean = (0..PIECES).fold(0.0, |sum, piece| {
            let part = (f64::from(piece) + 0.5) / f64::from(PIECES) - 0.5;
            let time = f64::from(since_onset) + part * f64::from(aperture);
            sum + f64::from(shape.force(time as f32).0) / f64::from(PIECES)
        });
        let model = shape.force(since_onset).0 + corner.at(&shape).shift(since_onset).force_n;
        let error = f64::from(model) - mean;
        let plain = f64::from(shape.force(since_onset).0) - mean;
        assert!(error.abs() < 0.15 + 0.1 * plain.abs(), "{error} N at {since_onset}, not {plain}");
    }
}
