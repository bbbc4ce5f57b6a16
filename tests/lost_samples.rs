//! Lost samples at a slip, and gaps in the rest before one.

use floe::sim::Scene;
use floe_core::{Config, Event, Newtons, RawSample, Reading};
use floe_tests::brute::Pull;
use floe_tests::normal::Normal;
use floe_tests::saw::{Slip, saw};
use floe_tests::score::{Record, off};
use floe_tests::{both, feed, random, scenes};

/// Distances of both coefficients of an event from the truth, in stated combined standard
/// deviations; `None` where it has no true event or not both coefficients.
fn distances(record: &Record, event: &Event) -> Option<[f64; 2]> {
    let onset_s = both::periods(event) / record.rate_hz;
    let near = |time_s: f64| (time_s - onset_s).abs() * record.rate_hz < 6.0;
    let truth = record.truths.iter().find(|it| near(it.onset_s))?;
    Some([off(&event.mu_s?, truth.mu_s), off(&event.mu?, truth.mu)])
}

/// Two to five samples that are lost at a slip, before the test has shown how long a slip takes,
/// give no coefficient that is far off: they hide how the slip began and ended.
#[test]
fn a_few_lost_samples_make_no_event_wrong_and_sure() {
    // The scene, its duration, s, and where samples are lost.
    let cases = [
        ("dff8-13", 12.0, 5..110),
        ("hard/unresolved", 30.0, 340..450),
        ("honesty/short_slips", 30.0, 340..450),
        ("hard/slack", 30.0, 5..110),
        ("linear/light", 30.0, 5..110),
    ];
    let mut judged = 0;
    for (name, duration_s, places) in cases {
        let scene = Scene { duration_s, ..scenes::stored(name) };
        let config = both::config(&scene);
        for seed in 1..=2 {
            let record = Record::of(&scene, seed, |_| 0.0);
            let whole = feed::replay(&config, record.samples.iter().copied()).events;
            for (lost, at) in
                [2, 3, 5].into_iter().flat_map(|n| places.clone().map(move |at| (n, at)))
            {
                let there = |it: &RawSample| !(at..at + lost).contains(&it.index);
                let samples = record.samples.iter().copied().filter(there);
                for event in feed::replay(&config, samples).events {
                    let Some(found) = distances(&record, &event) else { continue };
                    judged += 1;
                    let same = |it: &&Event| it.onset.index.abs_diff(event.onset.index) < 4;
                    let without = whole.iter().find(same).and_then(|it| distances(&record, it));
                    for (found, without) in found.into_iter().zip(without.unwrap_or_default()) {
                        let fine = found.abs() < 5.0 || without.abs() > 3.5;
                        assert!(fine, "{name} {seed}, {lost} lost at {at}: {found} {event:?}");
                    }
                }
            }
        }
    }
    assert!(judged > 3000, "{judged}");
}

/// A rest that holds a gap has no known duration, for it may hold a slip; a gap of a day gives no
/// rest of a day.
#[test]
fn the_event_after_a_gap_has_no_duration_of_its_rest() {
    const DAY: u32 = 86_400 * 16;
    let pull = Pull { duration_s: 40.0, ..scenes::dff8_13() };
    let samples = random::samples(&(pull, 1));
    let mut hidden = 0;
    // Lost samples and, where none are lost, periods in which none were taken.
    for (lost, pause) in [(30, 0), (200, 0), (0, DAY)] {
        for from in 300..330 {
            let later = |s: &RawSample| {
                let index = if s.index < from { s.index } else { s.index + pause };
                RawSample { index, ..*s }
            };
            let there = samples.iter().filter(|s| !(from..from + lost).contains(&s.index));
            let feed::Outcome { events, report, .. } =
                feed::replay(&scenes::config(&pull), there.map(later));
            let until = from + lost + pause;
            let first = events.iter().position(|it| it.onset.index >= until).expect("an event");
            if events[first - 1].stop.index < from {
                hidden += 1;
                assert_eq!(events[first].stick_s, None, "{lost} {pause} {from}");
            }
            let longest = events.iter().filter_map(|it| it.stick_s).fold(0.0, f32::max);
            assert!((1.0..4.0).contains(&longest), "{lost} {pause} {from}: {longest} s");
            let recurrence_s = report.recurrence_s.expect("intervals without a gap");
            assert!((1.6..2.0).contains(&recurrence_s), "{lost} {pause} {from}: {recurrence_s} s");
        }
    }
    println!("{hidden} of 90 gaps lie in a rest");
    assert!(hidden > 30, "{hidden}");
}

/// A slip that a gap hides does not make a sagging cable look like another one: the rest before
/// the next slip is not that of the event before it.
#[test]
fn a_hidden_slip_does_not_bend_a_sagging_cable() {
    let mut scene = Scene { duration_s: 20.0, ..scenes::stored("hard/sag_flop") };
    scene.measurement.flop = None;
    let config = both::config(&scene);
    let (mut sum, mut count) = (0.0, 0.0);
    for seed in 1..=30 {
        let mut record = Record::of(&scene, seed, |_| 0.0);
        let hidden = &record.truths[1];
        let from = (hidden.onset_s * record.rate_hz) as u32 - 4;
        let until = (hidden.stop_s * record.rate_hz) as u32 + 6;
        record.samples.retain(|it| !(from..=until).contains(&it.index));
        let tried = record.read(&config);
        for &(truth, found) in tried.pairs.iter().filter(|pair| (4..8).contains(&pair.0)) {
            let Some(mu) = tried.found[found].mu else { continue };
            sum += f64::from(mu.value) / tried.truths[truth].mu - 1.0;
            count += 1.0;
        }
    }
    let mean = 100.0 * sum / count;
    println!("mean error of mu {mean:.2} % in {count} events");
    assert!(count > 90.0 && mean.abs() < 0.6, "{mean} % in {count} events");
}

/// Slips that follow each other faster than they can be fitted wait. A saturated sample hides the
/// slip that it lies in, also if a later one is saturated by the time that slip is looked at.
#[test]
fn a_saturated_sample_hides_its_slip_while_samples_wait() {
    let config = Config { weight_n: 630.0, range_n: Some(790.0), ..Config::default() };
    let (mut hidden, mut seen) = (0, 0);
    for (seed, rate, omega) in (1..=3).flat_map(|i| [(i, 120.0, 1.2), (i, 100.0, 2.0)]) {
        let mut noise = Normal::new(seed);
        let slip = |_| Slip { static_n: 780.0 + 8.0 * noise.sample(), dynamic_n: 560.0, omega };
        let slips: Vec<Slip> = (0..150).map(slip).collect();
        let (forces, _) = saw(&slips, rate, 60.0);
        let forces: Vec<f64> = forces.iter().map(|it| it + 2.0 * noise.sample()).collect();
        for event in feed::replay(&config, feed::in_a_row(&forces)).events {
            let (from, to) = (event.onset.index as usize, event.stop.index as usize);
            if forces[from - 1..=to].iter().any(|force_n| force_n.abs() >= 790.0) {
                hidden += 1;
                assert_eq!(event.mu_s, None, "{rate} N, {omega}, seed {seed}: {event:?}");
            }
            seen += u32::from(event.mu_s.is_some());
        }
    }
    assert!(hidden > 100 && seen > 100, "{hidden} {seen}");
}

/// The force of a sample, N; zero without one.
fn force_n(sample: &RawSample) -> f32 {
    if let Reading::Force(Newtons(force_n)) = sample.reading { force_n } else { 0.0 }
}

/// A gap that begins while the cable hangs slack hides when it was taken up, and thereby `mu`.
#[test]
fn a_gap_in_the_slack_makes_no_mu_wrong_and_sure() {
    const GAP: u32 = 12;
    let mut judged = 0;
    for name in ["honesty/slack", "hard/slack"] {
        let scene = Scene { duration_s: 45.0, ..scenes::stored(name) };
        let config = both::config(&scene);
        for seed in 1..=3 {
            let record = Record::of(&scene, seed, |_| 0.0);
            let is_slack = |at: usize| force_n(&record.samples[at]).abs() < 10.0;
            for at in (300..record.samples.len()).filter(|at| is_slack(at - 1)) {
                let later = |s: &RawSample| RawSample { index: s.index + GAP, ..*s };
                let after = record.samples[at..].iter().map(later).take(8);
                let samples = record.samples[..at].iter().copied().chain(after);
                let events = feed::replay(&config, samples).events;
                let before = |it: &&Event| it.mu.is_some() && (it.onset.index as usize) < at;
                let Some(event) = events.iter().rfind(before) else { continue };
                let Some([_, mu]) = distances(&record, event) else { continue };
                judged += 1;
                assert!(mu.abs() < 5.0, "{name} {seed}, gap at {at}: {mu} {event:?}");
            }
        }
    }
    assert!(judged > 300, "{judged}");
}

/// A converter that skips every third sample leaves enough of slips of six: they are read, and right.
#[test]
fn slips_between_evenly_lost_samples_are_read() {
    let scene = Scene { duration_s: 240.0, ..scenes::stored("linear/heavy") };
    let config = both::config(&scene);
    let (mut truths, mut read, mut covered) = (0, 0, 0);
    for seed in 1..=4 {
        let record = Record::of(&scene, seed, |_| 0.0);
        let samples = record.samples.iter().copied().filter(|it| it.index % 3 != 2);
        truths += record.truths.len();
        for event in feed::replay(&config, samples).events {
            let Some(off) = distances(&record, &event) else { continue };
            assert!(off.iter().all(|off| off.abs() < 5.0), "{off:?} {event:?}");
            (read, covered) = (read + 1, covered + usize::from(off[0].abs() < 1.96));
        }
    }
    println!("{read} of {truths} read, {covered} cover");
    assert!(read * 10 > truths * 9 && covered * 10 >= read * 9, "{read}, {covered} of {truths}");
}
