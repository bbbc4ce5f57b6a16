//! Arbitrary samples cause no panic, give finite numbers only, and are all counted.

use floe_core::{
    Config, Counts, Event, Fault, Newtons, Pipeline, RawSample, Reading, Report, Step,
};
use floe_tests::brute::Pull;
use floe_tests::feed;
use floe_tests::random::{check, pulls, samples};
use floe_tests::scenes;
use proptest::prelude::*;

/// Readings of every kind.
fn readings() -> impl Strategy<Value = Reading> {
    let any_force = any::<u32>().prop_map(f32::from_bits);
    let faults = [Fault::Sentinel, Fault::Timeout, Fault::Corrupt, Fault::Disconnected];
    prop_oneof![
        4 => (-1e3..1e3_f32).prop_map(|f| Reading::Force(Newtons(f))),
        1 => any_force.prop_map(|f| Reading::Force(Newtons(f))),
        1 => prop::sample::select(vec![f32::MAX, f32::MIN, f32::INFINITY, f32::NAN, 1e-45, -0.0])
            .prop_map(|f| Reading::Force(Newtons(f))),
        1 => any::<i32>().prop_map(|c| Reading::Counts(Counts(c))),
        1 => prop::sample::select(faults.to_vec()).prop_map(Reading::Bad),
    ]
}

/// Changes of the index from one sample to the next.
fn index_moves() -> impl Strategy<Value = (u32, bool)> {
    let far = prop_oneof![any::<u32>(), Just(u32::MAX), Just(RawSample::LAST_INDEX), Just(0)];
    prop_oneof![
        60 => (1..2_u32).prop_map(|by| (by, false)),
        5 => (0..12_u32).prop_map(|by| (by, false)),
        1 => far.prop_map(|to| (to, true)),
    ]
}

fn wild_samples() -> impl Strategy<Value = Vec<RawSample>> {
    proptest::collection::vec((index_moves(), readings()), 0..400).prop_map(|moves| {
        let mut last = 0_u32;
        let mut next = |(by, jump): (u32, bool)| {
            last = if jump { by } else { last.saturating_add(by) };
            last
        };
        moves.into_iter().map(|(m, reading)| RawSample { index: next(m), reading }).collect()
    })
}

/// A pull in which some samples are replaced and the following indices shifted.
fn disturbed_samples() -> impl Strategy<Value = Vec<RawSample>> {
    let trouble = (0..960_usize, index_moves(), proptest::option::of(readings()));
    (pulls(), proptest::collection::vec(trouble, 0..12)).prop_map(|(test, troubles)| {
        let mut samples = samples(&test);
        for (at, (by, jump), reading) in troubles {
            let Some(first) = samples.get(at).copied() else { continue };
            let shift = if jump { by.wrapping_sub(first.index) } else { by - by.min(1) };
            samples[at..].iter_mut().for_each(|s| s.index = s.index.wrapping_add(shift));
            samples[at].reading = reading.unwrap_or(first.reading);
        }
        samples
    })
}

fn numbers_of_an_event(event: &Event) -> Vec<f32> {
    let mut numbers = vec![
        event.onset.fraction,
        event.stop.fraction,
        event.static_force_n,
        event.dynamic_force_n,
        event.peak_force_n,
        event.restick_force_n,
        event.slip_s,
        event.loading_rate_n_per_s,
    ];
    numbers.extend(event.stick_s.into_iter().chain(event.omega_rad_per_s));
    let coefficients = [event.mu_s, event.mu].into_iter().flatten();
    numbers.extend(coefficients.flat_map(|c| [c.value, c.std, c.systematic_std]));
    numbers
}

fn numbers_of_a_report(report: &Report) -> Vec<f32> {
    let estimates = [report.mu_s, report.mu].into_iter().flatten();
    let mut numbers: Vec<f32> = estimates
        .flat_map(|e| {
            let (low, high) = e.ci95().unzip();
            [Some(e.mean), e.std_error, e.spread, Some(e.systematic_std), low, high]
        })
        .chain([report.loading_rate_n_per_s, report.omega_rad_per_s].map(|q| q.map(|q| q.value)))
        .chain([report.loading_rate_n_per_s, report.omega_rad_per_s].map(|q| q.map(|q| q.std)))
        .chain([report.noise_n, Some(report.zero_std_n), Some(report.zero_drift_n)])
        .chain([report.stiffness_n_per_m, report.recurrence_s, report.zero_n])
        .flatten()
        .collect();
    numbers.push(0.0);
    numbers
}

fn all_finite(what: &impl std::fmt::Debug, numbers: &[f32]) -> Result<(), TestCaseError> {
    prop_assert!(numbers.iter().all(|x| x.is_finite()), "{what:?}");
    Ok(())
}

/// Checks that every result is finite, every sample counted, and every slip longer than nothing.
fn holds_for(config: &Config, samples: &[RawSample]) -> Result<(), TestCaseError> {
    let mut pipeline = Pipeline::new(config).unwrap();
    let mut events = 0;
    for sample in samples {
        let Step { sample, rate, event, .. } = pipeline.step(*sample);
        all_finite(&sample, sample.force_n.as_slice())?;
        all_finite(&rate, &rate.map_or(vec![], |r| vec![r.force_n, r.rate_n_per_s]))?;
        all_finite(&event, &event.map_or(vec![], |e| numbers_of_an_event(&e)))?;
        prop_assert!(event.is_none_or(|it| it.slip_s > 0.0), "{:?}", event);
        events += u32::from(event.is_some());
    }
    let report = pipeline.report();
    all_finite(&report, &numbers_of_a_report(&report))?;
    for event in feed::finish(&mut pipeline) {
        prop_assert!(event.slip_s > 0.0, "{:?}", event);
        all_finite(&event, &numbers_of_an_event(&event))?;
        events += 1;
    }
    let report = pipeline.report();
    all_finite(&report, &numbers_of_a_report(&report))?;
    let counters = report.counters;
    prop_assert_eq!(counters.samples + counters.duplicates, samples.len() as u32);
    prop_assert!(counters.rejected + counters.saturated <= counters.samples);
    prop_assert_eq!(report.events, events);
    Ok(())
}

fn block() -> Config {
    Config { weight_n: 630.0, ..Config::default() }
}

#[test]
fn wild_streams_neither_panic_nor_give_what_is_not_a_number() {
    check(2000, wild_samples(), |samples| holds_for(&block(), &samples));
}

#[test]
fn disturbed_pulls_neither_panic_nor_give_what_is_not_a_number() {
    check(500, disturbed_samples(), |samples| holds_for(&block(), &samples));
}

/// Force of magnitude one as a function of the sample's index.
type Pattern = fn(u32) -> f32;

const PATTERNS: [(&str, Pattern); 8] = [
    ("constant", |_| 1.0),
    ("step", |i| if i < 500 { 0.5 } else { 1.0 }),
    ("alternating", |i| if i % 2 == 0 { 1.0 } else { -1.0 }),
    ("ramp", |i| i as f32 / 1000.0),
    ("saw", |i| (i % 31) as f32 / 31.0),
    ("saw with a tooth of two samples", |i| if i % 2 == 0 { 1.0 } else { 0.1 }),
    ("pulses", |i| if i % 17 == 0 { 1.0 } else { 0.0 }),
    ("growing saw", |i| (i % 31) as f32 * (i as f32 * 0.01).exp2()),
];

/// Magnitudes from forces whose squares underflow to the end of the range and beyond, with and
/// without a constant load.
#[test]
fn patterns_of_any_size_give_numbers() {
    let scales = [1e-38, 1e-30, 1e-20, 1e-15, 1e-10, 1e-5, 1.0, 1e5, 1e8, 9e8, 1e11, 1e12];
    for (name, pattern) in PATTERNS {
        for scale in scales {
            for tare_n in [0.0, 1e7] {
                for rate_hz in [1.0, 16.0, 2000.0] {
                    let force_n = |i| f64::from(tare_n + scale * pattern(i));
                    let samples: Vec<_> = (0..1500).map(|i| feed::force(i, force_n(i))).collect();
                    for weight_n in [scale, 630.0] {
                        let config = Config { weight_n, rate_hz, ..block() };
                        let outcome = holds_for(&config, &samples);
                        assert!(outcome.is_ok(), "{name} × {scale} + {tare_n}: {outcome:?}");
                    }
                }
            }
        }
    }
}

/// After a gap of years the next step still takes a short time.
#[test]
fn a_gap_of_any_length_is_passed_at_once() {
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let test = (Pull { duration_s: 10.0, ..scenes::dff8_13() }, 1);
        let samples = samples(&test);
        // The gap begins at every sample: while the block rests, slips, or has just stopped.
        for end in 60..samples.len() {
            let far = (0..3).map(|i| feed::force((1 << 30) + i, 500.0));
            feed::replay(&block(), samples[..end].iter().copied().chain(far));
        }
        sender.send(()).unwrap();
    });
    let outcome = receiver.recv_timeout(std::time::Duration::from_secs(10));
    assert!(outcome.is_ok(), "a step takes for ever");
}

/// Indices at the end of their range cause no panic.
#[test]
fn the_end_of_all_indices_is_no_panic() {
    for last in [RawSample::LAST_INDEX, RawSample::LAST_INDEX + 20, u32::MAX] {
        let samples = (last - 40..=last).map(|index| feed::force(index, 500.0));
        let outcome = feed::replay(&block(), samples);
        assert_eq!(outcome.events, []);
        let beyond = last.saturating_sub(RawSample::LAST_INDEX).min(41);
        assert_eq!(outcome.report.counters.duplicates, beyond, "{last}");
    }
}
