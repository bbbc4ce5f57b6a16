//! Forces written by hand, with the exact output of the detector.
//!
//! The block rests for 30 samples while the force rises by 20 N per sample from 200 N to 780 N,
//! then the force falls to 210 N within a few samples. The expected output follows from the rules
//! in `detector`. A slip from the upper half of the usual range is reported at its first sample
//! clearly below the line, one from the lower half at the first sample that has fallen by half the
//! usual drop; a re-stick is reported two samples after the lowest one.

use floe_core::Effects;
use floe_core::detector::Detector;
use floe_core::{
    Calibration, Config, Counts, Phase, Pipeline, Quality, RawSample, Reading, Reason,
};
use floe_tests::feed;

mod script;

use script::Script;

/// Three usual cycles; slips begin after samples 29, 62 and 95.
fn three_cycles(noise_n: f64) -> Script {
    Script::noisy(noise_n).stick().slip().stick().slip().stick().slip().line(200.0, 20.0, 10)
}

const THREE: [&str; 6] = [
    "30 onset",
    "34 restick 29 32",
    "63 onset",
    "67 restick 62 65",
    "96 onset",
    "100 restick 95 98",
];

#[test]
fn three_slips_with_and_without_noise() {
    for noise_n in [0.0, 1e-3, 0.5, 2.0, 4.0] {
        three_cycles(noise_n).becomes(&THREE);
    }
}

/// Postponed samples are processed later, three at a time, with the same result; after 240
/// postponed samples no more are postponed.
#[test]
fn samples_wait_for_room_and_none_is_lost() {
    let script = three_cycles(2.0).line(400.0, 10.0, 200);
    let seen = |transitions: Vec<String>| -> Vec<String> {
        transitions.iter().map(|it| it.split_once(' ').expect("an index").1.to_owned()).collect()
    };
    let at_once = seen(script.transitions());
    let later = script.transitions_with(|index| (64..90).contains(&index));
    assert_eq!(later[3], "91 restick 62 65");
    assert_eq!(seen(later), at_once);
    // The first three at sample 304, the fourth after as many samples were postponed again.
    let never = script.transitions_with(|index| index >= 64);
    assert_eq!(never[3], "307 restick 62 65");
    assert!(at_once.starts_with(&seen(never)));
}

#[test]
fn the_phase_follows() {
    let mut detector = Detector::new(16.0, Effects::default());
    assert_eq!(detector.phase(), Phase::Unknown);
    let phases: Vec<Phase> = three_cycles(2.0)
        .samples()
        .map(|(index, force_n)| {
            detector.step(index, force_n as f32, false);
            detector.phase()
        })
        .collect();
    let slips: Vec<usize> = (0..phases.len()).filter(|&i| phases[i] == Phase::Slip).collect();
    assert_eq!(slips, [30, 31, 32, 33, 63, 64, 65, 66, 96, 97, 98, 99]);
    assert!(!phases.contains(&Phase::Unknown));
}

/// The cable is slack on a tared cell before the winch starts.
#[test]
fn tare_flat_then_rise() {
    for noise_n in [0.0, 2.0] {
        let start = Script::noisy(noise_n).line(0.0, 0.0, 25).line(0.0, 20.0, 40);
        start.clone().becomes(&[]);
        let slip = start.push([640.0, 370.0, 180.0]).line(200.0, 20.0, 10);
        slip.becomes(&["65 onset", "69 restick 64 67"]);
    }
}

/// A record that begins within a slip gives no event for it, and the noise is known later. The
/// onset of the next slip is reported within three samples.
#[test]
fn start_inside_a_slip() {
    let started = Script::noisy(2.0).push([640.0, 370.0, 180.0]).stick().slip();
    // The slip at the start gives the first estimate of the noise, which counts little with so few
    // samples: the next slip is reported when the samples are processed again.
    let script = started.stick().slip().line(200.0, 20.0, 9);
    script.becomes(&["42 onset", "43 restick 32 35", "66 onset", "70 restick 65 68"]);
}

#[test]
fn single_slip() {
    let script = Script::noisy(2.0).stick().slip().line(200.0, 20.0, 40);
    script.becomes(&["30 onset", "34 restick 29 32"]);
    assert_eq!(script.events().len(), 1);
}

/// A light block on a stiff cable: one sample between two lines.
#[test]
fn one_sample_slip() {
    let script = Script::noisy(2.0).stick().line(200.0, 20.0, 30).line(200.0, 20.0, 10);
    script.becomes(&["30 onset", "32 restick 29 30", "60 onset", "62 restick 59 60"]);
}

/// Two usual cycles.
fn two_cycles() -> Script {
    Script::noisy(2.0).stick().slip().stick().slip().line(200.0, 20.0, 10)
}

/// Only a part of the contact slips, by a tenth of the usual drop or more. Such a slip is reported
/// in the upper half of the usual range; half-way up it could be flop.
#[test]
fn partial_slips() {
    for drop_n in [60.0, 170.0] {
        let low_n = 660.0 - drop_n;
        let first = Script::noisy(2.0).stick().slip().line(200.0, 20.0, 24);
        let partial = first.push([660.0 - 0.6 * drop_n, low_n]).line(low_n + 20.0, 20.0, 12);
        let second = partial.push([600.0, 350.0, 180.0]).line(200.0, 20.0, 10);
        second.becomes(
            &[&THREE[..2], &["57 onset", "59 restick 56 58", "71 onset", "75 restick 70 73"]]
                .concat(),
        );
    }
    let first = Script::noisy(2.0).stick().slip().line(200.0, 20.0, 10);
    first.push([340.0, 320.0]).line(340.0, 20.0, 22).becomes(&THREE[..2]);
}

/// A re-stick requires that the force stays below the old line; if the force returns, the slip is
/// cancelled.
#[test]
fn two_sample_spikes_down() {
    two_cycles().becomes(&THREE[..4]);
    let down = two_cycles().at(45, 100.0).at(46, 100.0);
    let none = ["45 onset", "47 cancelled"];
    down.becomes(&[&THREE[..2], &none, &THREE[2..4]].concat());
}

/// Two samples above the line are not a peak: the following slip is reported with its true maximum.
#[test]
fn two_sample_spikes_up() {
    two_cycles().at(45, 1500.0).at(46, 1500.0).becomes(&THREE[..4]);
}

/// Two samples above the line in a long stick do not hide the slip at its end.
#[test]
fn two_sample_spikes_up_long_before_a_slip() {
    let first = Script::noisy(2.0).stick().slip();
    let script = first.line(200.0, 2.0, 290).push([640.0, 370.0, 180.0]).line(200.0, 20.0, 10);
    let usual = ["30 onset", "34 restick 29 32", "323 onset", "327 restick 322 325"];
    script.becomes(&usual);
    script.at(100, 1500.0).at(101, 1500.0).becomes(&usual);
}

/// A creeping block leaves its line before it slips, so the highest sample is not on the line.
#[test]
fn a_low_sample_of_a_creeping_block() {
    let creeping = Script::noisy(2.0).stick().slip().line(200.0, 20.0, 26);
    let script = creeping.push([714.0, 724.0, 732.0, 632.0, 744.0, 754.0, 764.0]).slip();
    let script = script.line(200.0, 20.0, 10);
    script.becomes(&[
        "30 onset",
        "34 restick 29 32",
        "62 onset",
        "63 cancelled",
        "66 onset",
        "70 restick 65 68",
    ]);
}

/// A single distant sample is a spike, never an event.
#[test]
fn one_sample_spikes_never_reach_the_detector() {
    let config = Config { weight_n: 630.0, ..Config::default() };
    for force_n in [-7000.0, 0.0, 1500.0, 8e6] {
        let script = three_cycles(2.0).at(50, force_n);
        let mut pipeline = Pipeline::new(&config).unwrap();
        let mut spikes = Vec::new();
        for (index, force_n) in script.samples() {
            spikes.extend(pipeline.step(feed::force(index, force_n)).spike);
        }
        assert_eq!(spikes, [50], "{force_n}");
        assert_eq!(pipeline.report().counters.rejected, 1);
        assert_eq!(script.events().len(), 3, "{force_n}");
    }
}

/// The cable drops on the ice and bounces while the block rests.
#[test]
fn flop_after_a_slip() {
    let flop = |script: Script| {
        let swing = [90.0, -60.0, 45.0, -30.0, 20.0, -12.0, 6.0, -3.0];
        let rise = |i: usize| 200.0 + 20.0 * i as f64;
        script.push((0..30).map(|i| rise(i) + swing.get(i).unwrap_or(&0.0)))
    };
    let script = flop(Script::noisy(2.0).stick().slip()).slip();
    let script = flop(script).slip().line(200.0, 20.0, 10);
    // The first upswing is a rise that ends the slip at once.
    let once = ["30 onset", "33 restick 29 32", "63 onset", "66 restick 62 65"];
    script.becomes(&[&once, &THREE[4..]].concat());
}

#[test]
fn gap_inside_a_stick() {
    for missing in [1, 3, 7] {
        let rest = 30 - 12 - missing as u32;
        let from_n = 200.0 + 20.0 * (12 + missing) as f64;
        let stick = Script::noisy(2.0).stick().slip().line(200.0, 20.0, 12).gap(missing);
        let script = stick.line(from_n, 20.0, rest).slip().line(200.0, 20.0, 10);
        script.becomes(&THREE[..4]);
    }
}

/// A slip with its lowest sample or the first sample of its fall missing is still one slip.
#[test]
fn gap_inside_a_slip() {
    let cycle = || Script::noisy(2.0).stick().slip().stick();
    let first = cycle().gap(1).push([370.0, 180.0]).line(200.0, 20.0, 10);
    first.becomes(&[THREE[0], THREE[1], "64 onset", "67 restick 62 65"]);
    let last = cycle().push([640.0]).gap(2).line(200.0, 20.0, 10);
    last.becomes(&[THREE[0], THREE[1], "63 onset", "68 restick 62 66"]);
    let whole = cycle().gap(4).line(200.0, 20.0, 10);
    whole.becomes(&[THREE[0], THREE[1], "67 onset", "70 restick 62 67"]);
}

/// A slip within a long gap is detected, but has no coefficient.
#[test]
fn a_hidden_slip_has_no_coefficient() {
    let cycle = Script::noisy(2.0).stick().slip().stick().slip().stick();
    let events = cycle.gap(5).line(200.0, 20.0, 30).events();
    assert_eq!(events.len(), 3);
    let last = &events[2];
    assert_eq!((last.mu_s, last.mu), (None, None));
    assert_eq!((last.quality, last.reason), (Quality::Clipped, Some(Reason::Hidden)));
}

#[test]
fn long_gap() {
    let before = || Script::noisy(2.0).stick().slip().line(200.0, 20.0, 12);
    // A gap of eight periods between samples is accepted, one of nine is not.
    before().gap(7).line(580.0, 20.0, 10).becomes(&THREE[..2]);
    before().gap(8).line(600.0, 20.0, 10).becomes(&[THREE[0], THREE[1], "53 lost"]);
    let after = before().gap(500).stick().slip().line(200.0, 20.0, 9);
    after.becomes(&[THREE[0], THREE[1], "545 lost", "575 onset", "579 restick 574 577"]);
    // In the middle of a slip as well.
    let slipping = Script::noisy(2.0).stick().push([640.0, 370.0]).gap(20).stick();
    slipping.becomes(&["30 onset", "52 lost"]);
}

/// A winch so fast that the block hardly rests: there is no stick line.
#[test]
fn no_flat_top() {
    let wave = |i: u32| 500.0 - 290.0 * (f64::from(i) * std::f64::consts::TAU / 7.0).cos();
    let script = Script::noisy(2.0).push((0..140).map(wave));
    let told = script.transitions();
    let resticks = told.iter().filter(|t| t.contains("restick"));
    let peaks: Vec<usize> =
        resticks.map(|t| t.split(' ').nth(2).unwrap().parse().unwrap()).collect();
    // The highest samples of a wave are its samples 3 and 4.
    assert!(peaks.iter().all(|peak| [3, 4].contains(&(peak % 7))), "{peaks:?}");
    // The noise is known after 2.6 s, and the first waves are then processed again; the last one is
    // not complete.
    let waves: Vec<usize> = peaks.iter().map(|peak| peak / 7).collect();
    assert_eq!(waves, (0..19).collect::<Vec<_>>());
}

/// The force falls to zero and stays there until the winch has taken up the slack.
#[test]
fn slack() {
    let cycle = |script: Script| {
        let fallen = script.stick().push([600.0, 250.0, 0.0]);
        fallen.line(0.0, 0.0, 12).line(0.0, 20.0, 10)
    };
    let still = cycle(cycle(Script::default()));
    still.becomes(&["30 onset", "34 restick 29 32", "85 onset", "89 restick 84 87"]);
    // With noise any slack sample may be the lowest. The first one as low within the noise counts,
    // and the wait for the end of the fall is half as long as it seemed.
    let noisy = cycle(cycle(Script::noisy(0.5)));
    noisy.becomes(&["30 onset", "37 restick 29 32", "85 onset", "92 restick 84 87"]);
}

/// Steps of the zero or of the cable's force: a step up, or a small one down, is no slip.
#[test]
fn steps() {
    for height_n in [-60.0, -10.0, 10.0, 200.0] {
        let first = Script::noisy(2.0).stick().slip();
        let stick = first.line(200.0, 20.0, 12).line(440.0 + height_n, 20.0, 18);
        let script = stick.push([640.0 + height_n, 370.0, 180.0]).line(200.0, 20.0, 10);
        script.becomes(&THREE[..4]);
    }
}

#[test]
fn nothing_moves() {
    for forces in [
        Script::default().line(0.0, 0.0, 400),
        Script::default().line(500.0, 0.0, 400),
        Script::default().line(-3.0, 0.0, 400),
        Script::noisy(2.0).line(0.0, 0.0, 400),
        Script::noisy(2.0).line(200.0, 20.0, 400),
        Script::noisy(2.0).line(8000.0, -20.0, 400),
        Script::default().line(0.0, 0.0, 1),
        Script::default(),
    ] {
        forces.becomes(&[]);
        assert_eq!(forces.events(), []);
    }
}

/// A cell with reversed polarity gives the same result through its calibration.
#[test]
fn negative_polarity() {
    let read = |counts_per_n: f32| {
        let calibration = Calibration { tare_counts: 1234, counts_per_n, ..Calibration::default() };
        let config = Config { weight_n: 630.0, calibration, ..Config::default() };
        let counts = |(index, force_n): (u32, f64)| RawSample {
            index,
            reading: Reading::Counts(Counts(
                1234 + (force_n * f64::from(counts_per_n)).round() as i32,
            )),
        };
        feed::replay(&config, three_cycles(2.0).samples().map(counts))
    };
    let (positive, negative) = (read(800.0), read(-800.0));
    assert_eq!(positive.events.len(), 3);
    assert_eq!(positive, negative);
}
