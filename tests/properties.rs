//! Invariances of the results: chunks, units, and start of the indices.

use std::cell::Cell;

use floe_core::estimator::Estimator;
use floe_core::{
    Calibration, Coefficient, Config, Counts, Event, Pipeline, RawSample, Reading, SampleTime,
};
use floe_tests::brute::Pull;
use floe_tests::feed::{self, Outcome};
use floe_tests::random::{check, forces_n, pulls, samples};
use floe_tests::scenes;
use proptest::prelude::*;

/// The other properties hold for pulls without a slip too, and would then say nothing.
#[test]
fn most_pulls_have_slips() {
    let (with_slips, read) = (Cell::new(0), Cell::new(0));
    check(60, pulls(), |test| {
        let events = feed::replay(&scenes::config(&test.0), samples(&test)).events;
        with_slips.set(with_slips.get() + u32::from(events.len() > 4));
        read.set(read.get() + events.iter().filter(|it| it.mu_s.is_some()).count());
        Ok(())
    });
    let (with_slips, read) = (with_slips.get(), read.get());
    println!("{with_slips} of 60 pulls have slips, {read} of these with mu_s");
    assert!(with_slips > 50 && read > 1000, "{with_slips} {read}");
}

/// The pipeline contains its whole state: it can be moved or copied between samples at any time.
#[test]
fn incremental_equals_batch_in_any_chunks() {
    let input = (pulls(), proptest::collection::vec(0..960_usize, 0..6));
    check(60, input, |(test, mut cuts)| {
        let samples = samples(&test);
        let config = scenes::config(&test.0);
        let whole = feed::replay(&config, samples.iter().copied());
        cuts.sort_unstable();
        let mut pipeline = Pipeline::new(&config).unwrap();
        let (mut events, mut from) = (Vec::new(), 0);
        for to in cuts.into_iter().chain([samples.len()]) {
            let mut next = pipeline.clone();
            // Samples fed to the old pipeline do not affect its copy.
            feed::feed(&mut pipeline, (0..50).map(|i| feed::force(1_000_000 + i, 1e3)));
            events.extend(feed::feed(&mut next, samples[from..to].iter().copied()));
            let _ = next.report();
            (pipeline, from) = (next, to);
        }
        events.extend(feed::finish(&mut pipeline));
        prop_assert_eq!((events, pipeline.report()), (whole.events, whole.report));
        Ok(())
    });
}

/// Random events: values around one, with individual errors.
fn coefficients(most: usize) -> impl Strategy<Value = Vec<Coefficient>> {
    let one =
        (0.2..1.6_f32, 1e-4..0.1_f32).prop_map(|(value, std)| Coefficient::random(value, std));
    proptest::collection::vec(one, 1..most)
}

fn estimator(events: &[Coefficient]) -> Estimator {
    let mut estimator = Estimator::default();
    events.iter().for_each(|event| estimator.add(*event));
    estimator
}

/// Number of events up to which a prior on the scatter counts; other tests cover it.
const FEW: usize = 8;

/// Mean, standard error and spread by the formulas of `estimator`, computed over all events at
/// once.
fn batch(events: &[Coefficient]) -> [f64; 3] {
    let n = events.len() as f64;
    let value = |e: &Coefficient| f64::from(e.value);
    let variance = |e: &Coefficient| f64::from(e.std).powi(2);
    let sum = |f: &dyn Fn(&Coefficient) -> f64| events.iter().map(f).sum::<f64>();
    let plain = sum(&value) / n;
    let squares = sum(&|e| (value(e) - plain).powi(2));
    let own = sum(&variance) / n;
    let weights = sum(&|e| 1.0 / variance(e));
    let weighted = sum(&|e| value(e) / variance(e)) / weights;
    let between = match events.len() {
        0 | 1 => 0.0,
        2..=FEW => squares / (n - 1.0) - own,
        _ => {
            let far = sum(&|e| (value(e) - weighted).powi(2) / variance(e)) - (n - 1.0);
            let uneven = weights - sum(&|e| variance(e).powi(-2)) / weights;
            (squares / (n - 1.0) - own).max(far / uneven)
        }
    };
    let between = between.max(0.0);
    let harmonic = n / weights;
    let lambda = harmonic / (harmonic + between);
    // Variance of Σ c_i x_i with c_i = λ w_i / Σ w + (1 − λ) / n.
    let share = |e: &Coefficient| lambda / (variance(e) * weights) + (1.0 - lambda) / n;
    let independent = sum(&|e| share(e).powi(2) * (variance(e) + between));
    let shared_line = if events.len() > 1 { 1.0 + 0.36 * lambda } else { 1.0 };
    let inflation = if events.len() >= 30 && squares > 0.0 {
        wandering(events, plain, squares / n).max(shared_line)
    } else {
        shared_line
    };
    let mean = lambda * weighted + (1.0 - lambda) * plain;
    [mean, (independent * inflation).sqrt(), between.sqrt()]
}

/// `1 + 2 Σ ρ_k` over the lags up to the first whose correlation is within one standard error of
/// zero, corrected for the effect of the estimated mean on variance and covariances.
fn wandering(events: &[Coefficient], mean: f64, variance: f64) -> f64 {
    let n = events.len();
    let from_mean = |i: usize| f64::from(events[i].value) - mean;
    let correlation = |lag: usize| {
        let products = (lag..n).map(|i| from_mean(i) * from_mean(i - lag)).sum::<f64>();
        (products / (n - lag) as f64 / variance).min(1.0)
    };
    let lags = 1..=(n / 4).min(floe_core::estimator::LAGS);
    let n = n as f64;
    let seen: Vec<f64> = lags.map(correlation).take_while(|c| *c > 1.0 / n.sqrt()).collect();
    let (sum, missing) = (seen.iter().sum::<f64>(), seen.iter().map(|c| 1.0 - c).sum::<f64>());
    let inflation = (1.0 + 2.0 * sum) / (1.0 - 2.0 * missing / n);
    inflation * (n - 1.0) / (n - inflation.min(0.5 * n))
}

fn result(estimator: &Estimator) -> [f64; 3] {
    let estimate = estimator.estimate().unwrap();
    let (std_error, spread) = (estimate.std_error.unwrap_or(0.0), estimate.spread.unwrap_or(0.0));
    [estimate.mean, std_error, spread].map(f64::from)
}

/// Equality within the rounding of the results to single precision.
fn close(got: [f64; 3], expected: [f64; 3]) -> Result<(), TestCaseError> {
    for (got, expected) in got.into_iter().zip(expected) {
        // The spread is the root of a difference, which rounding may leave near zero.
        let tolerance = 2e-7 * expected.abs() + 1e-8;
        prop_assert!((got - expected).abs() <= tolerance, "{got} {expected}");
    }
    Ok(())
}

#[test]
fn estimator_equals_the_batch_formulas() {
    check(500, coefficients(200), |events| {
        let (got, expected) = (result(&estimator(&events)), batch(&events));
        let all = events.len() > FEW;
        close(
            if all { got } else { [0.0, 0.0, got[2]] },
            if all { expected } else { [0.0, 0.0, expected[2]] },
        )
    });
}

/// Results of a test through a converter with the given zero and span.
fn in_counts(test: &(Pull, u64), tare_counts: i32, counts_per_n: f32) -> Outcome {
    let calibration = Calibration { tare_counts, counts_per_n, ..Calibration::default() };
    let config = Config { calibration, ..scenes::config(&test.0) };
    let code = |force_n: f64| (force_n * f64::from(counts_per_n)).round() as i32 + tare_counts;
    let samples = (0..).zip(forces_n(test)).map(|(index, force_n)| RawSample {
        index,
        reading: Reading::Counts(Counts(code(force_n))),
    });
    feed::replay(&config, samples)
}

/// A constant force on the cell, removed by taring, changes nothing.
#[test]
fn offset() {
    check(40, (pulls(), -2_000_000..2_000_000_i32), |(test, tare_counts)| {
        prop_assert_eq!(in_counts(&test, tare_counts, 256.0), in_counts(&test, 0, 256.0));
        Ok(())
    });
}

/// A cell with reversed polarity changes nothing.
#[test]
fn polarity() {
    check(40, (pulls(), -2_000_000..2_000_000_i32), |(test, tare_counts)| {
        let positive = in_counts(&test, tare_counts, 256.0);
        prop_assert_eq!(in_counts(&test, tare_counts, -256.0), positive);
        Ok(())
    });
}

/// Results with all forces and the weight multiplied by a factor.
fn scaled(test: &(Pull, u64), factor: f64) -> Outcome {
    let config = scenes::config(&test.0);
    let forces_n: Vec<f64> = forces_n(test).iter().map(|f| f64::from(*f as f32) * factor).collect();
    let config = Config { weight_n: config.weight_n * factor as f32, ..config };
    feed::replay(&config, feed::in_a_row(&forces_n))
}

/// The results that do not depend on the unit of force.
type Plain = (SampleTime, [Option<Coefficient>; 2], Option<f32>, f32, Option<f32>);

fn plain(event: &Event) -> Plain {
    let coefficients = [event.mu_s, event.mu];
    (event.onset, coefficients, event.stick_s, event.slip_s, event.omega_rad_per_s)
}

/// Factors that are powers of two keep every digit: the core contains no absolute force.
#[test]
fn scale_by_powers_of_two_changes_nothing() {
    check(40, (pulls(), -14..14_i32), |(test, power)| {
        let (one, other) = (scaled(&test, 1.0), scaled(&test, 2.0_f64.powi(power)));
        let without_newtons = |o: &Outcome| o.events.iter().map(plain).collect::<Vec<_>>();
        prop_assert_eq!(without_newtons(&one), without_newtons(&other));
        let coefficients = |o: &Outcome| (o.report.mu_s, o.report.mu);
        prop_assert_eq!(coefficients(&one), coefficients(&other));
        Ok(())
    });
}

/// Other factors change the rounding, and thereby close decisions: when a fit has converged, and
/// whether the loading rate varies. For the published test the events then move by a fraction of
/// their error.
#[test]
fn scale_by_any_factor_changes_the_rounding_only() {
    check(40, (any::<u16>(), 1e-4..1e4_f64), |(seed, factor)| {
        let test = (Pull { duration_s: 60.0, ..scenes::dff8_13() }, u64::from(seed));
        let (one, other) = (scaled(&test, 1.0), scaled(&test, factor));
        prop_assert_eq!(one.events.len(), other.events.len());
        let both = one.events.iter().zip(&other.events).skip(3);
        let pairs = both.flat_map(|(a, b)| [(a.mu_s, b.mu_s), (a.mu, b.mu)]);
        let (mut squares, mut count) = (0.0, 0);
        for (a, b) in pairs {
            let (a, b) = match (a, b) {
                (Some(a), Some(b)) => (a, b),
                // An apparent change that is refused later is refused for every factor.
                (None, None) => continue,
                _ => return Err(TestCaseError::fail("lost")),
            };
            let error = (a.value - b.value) / a.std.max(b.std);
            squares += error * error;
            count += 1;
        }
        prop_assert!(count >= 2 * (one.events.len() - 3) - 2, "{count} pairs");
        prop_assert!(squares <= 0.2 * 0.2 * count as f32, "rms² {squares} / {count}");
        Ok(())
    });
}

#[test]
fn time_shift_moves_the_indices_and_nothing_else() {
    check(40, (pulls(), 1..(1_u32 << 30)), |(test, shift)| {
        let (config, samples) = (scenes::config(&test.0), samples(&test));
        let mut here = feed::replay(&config, samples.iter().copied());
        let later = |s: &RawSample| RawSample { index: s.index + shift, ..*s };
        let there = feed::replay(&config, samples.iter().map(later));
        for event in &mut here.events {
            event.onset.index += shift;
            event.stop.index += shift;
        }
        for stretch in &mut here.stretches {
            stretch.start.index += shift;
            stretch.stop.index += shift;
        }
        if let Some(change) = &mut here.report.change {
            change.onset.index += shift;
        }
        prop_assert_eq!(here, there);
        Ok(())
    });
}
