//! Every line survives formatting and parsing unchanged.

use super::*;
use crate::notebook::{Kind, Notes, Track, WeightFrom};
use crate::settings::{Effects, Stds, Zero};
use crate::weighing::Swing;
use floe_core::{
    Calibration, Cause, Coefficient, Config, Counters, Estimate, InputStd, Pipeline, Quality,
    Quantity, Reason, SampleTime, StretchKind,
};

fn returns(line: &Line<'_>) {
    let text = line.to_text().unwrap();
    assert_eq!(Line::parse(&text).as_ref(), Ok(line), "{text}");
}

#[test]
fn a_change_returns_as_it_was() {
    let onset = SampleTime { index: 964, fraction: 0.404 };
    let ratio = (0.653_039_5, 0.018_978_2);
    for cause in [Cause::Mass, Cause::Friction, Cause::Unknown] {
        let (weight_ratio, weight_ratio_std) = ratio;
        let change = Change { event: 33, onset, cause, weight_ratio, weight_ratio_std };
        returns(&Line::Change(change));
        let config = Config { weight_n: 630.0, ..Config::default() };
        let none = Pipeline::new(&config).unwrap().report();
        returns(&Line::Report(none));
        returns(&Line::Report(Report { change: Some(change), ..none }));
        returns(&Line::Report(Report { found: floe_core::Effects::COMPILED, ..none }));
    }
}

#[test]
fn a_stretch_returns_as_it_was() {
    let [start, stop] =
        [(7, 0.0), (964, 0.404)].map(|(index, fraction)| SampleTime { index, fraction });
    let steady = |moving| StretchKind::Steady { force_over_weight: 0.78, std: 1.0 / 3.0, moving };
    let refused = StretchKind::NotUnderstood(Reason::WoundBack);
    for kind in [steady(None), steady(Some(true)), steady(Some(false)), refused] {
        returns(&Line::Stretch(Stretch { start, stop, kind }));
    }
}

#[test]
fn a_first_answer_returns_as_it_was() {
    let mu_s = Coefficient { value: 1.240_391_2, std: 0.011_4, systematic_std: 0.004 };
    let mu = Coefficient { value: 0.780_4, std: 1.0 / 3.0, systematic_std: 0.0 };
    for mu in [None, Some(mu)] {
        let answer = Provisional { mu_s, mu };
        returns(&Line::About(About { index: 964, answer }));
    }
    let text = "A,964,,,0.78,0.01";
    let text = format!("{text}*{:04X}", checksum(text));
    assert_eq!(Line::parse(&text), Err(LineError::Field));
}

#[test]
fn a_sample_returns_as_it_was() {
    let (flag, phase) = (SampleFlag::Good, Phase::Stick);
    for rate_n_per_s in [None, Some(-361.125)] {
        let force_n = Some(612.5);
        returns(&Line::Sample(LiveSample {
            index: 17,
            force_n,
            flag,
            phase,
            gap: 0,
            rate_n_per_s,
        }));
    }
    // A line of a board without the rate.
    let text = "S,17,612.5,good,stick,0";
    let text = format!("{text}*{:04X}", checksum(text));
    let Ok(Line::Sample(sample)) = Line::parse(&text) else { panic!("{text}") };
    assert_eq!(sample.rate_n_per_s, None);
}

#[test]
fn a_weighing_returns_as_it_was() {
    let swing = Swing { period_s: 2.0, amplitude_rad: 0.087_3, excess: 1.199 };
    let loads = [None, Some(swing)].map(|swing| Ok(Load { value: 630.02, std: 0.05, swing }));
    let all = [Hindrance::Short, Hindrance::Drifts, Hindrance::Moves, Hindrance::OutOfRange];
    for load in loads.into_iter().chain(all.map(Err)) {
        returns(&Line::Weighed(Weighed { duration_s: 40.25, load }));
    }
}

/// No `f32` has a longer text.
const LONG: f32 = f32::from_bits(0x83b2_83b2);

fn longest_report() -> Report {
    let quantity = Quantity { value: LONG, std: LONG };
    let estimate = Estimate {
        mean: LONG,
        std_error: Some(LONG),
        freedom: LONG,
        systematic_std: LONG,
        common_std: LONG,
        spread: Some(LONG),
        events: !0,
    };
    let counters =
        Counters { samples: !0, missing: !0, duplicates: !0, rejected: !0, saturated: !0 };
    Report {
        counters,
        events: !0,
        mu_s: Some(estimate),
        mu: Some(estimate),
        noise_n: Some(LONG),
        loading_rate_n_per_s: Some(quantity),
        omega_rad_per_s: Some(quantity),
        stiffness_n_per_m: Some(LONG),
        recurrence_s: Some(LONG),
        change: Some(Change {
            event: !0,
            onset: SampleTime { index: !0, fraction: LONG },
            cause: Cause::Friction,
            weight_ratio: LONG,
            weight_ratio_std: LONG,
        }),
        zero_n: Some(LONG),
        zero_std_n: LONG,
        zero_drift_n: LONG,
        damping_std: LONG,
        weight_ratio: LONG,
        weight_ratio_std: LONG,
        found: floe_core::Effects::COMPILED,
    }
}

fn longest_event() -> Event {
    let time = SampleTime { index: !0, fraction: LONG };
    let coefficient = Some(Coefficient { value: LONG, std: LONG, systematic_std: LONG });
    Event {
        index: !0,
        onset: time,
        stop: time,
        static_force_n: LONG,
        dynamic_force_n: LONG,
        peak_force_n: LONG,
        restick_force_n: LONG,
        mu_s: coefficient,
        mu: coefficient,
        stick_s: Some(LONG),
        slip_s: LONG,
        loading_rate_n_per_s: LONG,
        omega_rad_per_s: Some(LONG),
        slack: true,
        quality: Quality::Unresolved,
        reason: Some(Reason::Suspect),
    }
}

fn longest_settings() -> Settings {
    let calibration = Calibration {
        tare_counts: i32::MIN,
        counts_per_n: LONG,
        range_counts: (i32::MIN, i32::MIN),
    };
    let config = Config {
        rate_hz: LONG,
        weight_n: LONG,
        mass_kg: None,
        slope_rad: LONG,
        winch_m_per_s: Some(LONG),
        range_n: Some(LONG),
        calibration,
        effects: floe_core::Effects::default(),
        std: InputStd::default(),
    };
    Settings {
        config,
        name: String::try_from("sixteen-characte").unwrap(),
        effects: Effects { enabled: Some(!0 - 1), compiled: Some(!0 - 1) },
        stds: Stds {
            weight_n: Some(LONG),
            slope_rad: Some(LONG),
            zero_n: Some(LONG),
            span: Some(LONG),
            damping: Some(LONG),
            winch_m_per_s: Some(LONG),
        },
        weight_from: Some(WeightFrom::SameCell),
        zero: Zero { before_n: Some(LONG), after_n: Some(LONG) },
        notes: Notes {
            kind: Some(Kind::OverRiding),
            track: Some(Track::Repeated),
            snow_mm: Some(LONG),
            length_m: Some(LONG),
            width_m: Some(LONG),
            height_m: Some(LONG),
            cable_length_m: Some(LONG),
            cable_ae_n: Some(LONG),
        },
    }
}

#[test]
fn what_is_told_through_a_test_returns_as_it_was() {
    returns(&Line::Note("snow on the track, 3 cm; wind"));
    for winch in [Winch::Moving, Winch::Held] {
        returns(&Line::Mark { index: 964, winch });
    }
    returns(&Line::Sync { index: 0, unix_ms: 1_803_982_500_123 });
    for temperature_c in [None, Some(-31.25)] {
        returns(&Line::Climate { index: 960, temperature_c, supply_v: Some(3.7) });
    }
}

/// Lines of older boards lack the fields added since.
#[test]
fn settings_of_an_older_board_are_read() {
    let text = "T,3,DFF8-13,16,630,0.0349,0.016,,0,429.5,-8388608,8388607";
    let text = format!("{text}*{:04X}", checksum(text));
    let Ok(Line::Start { run: 3, settings }) = Line::parse(&text) else { panic!("{text}") };
    assert_eq!(settings.stds, Stds::default());
    assert_eq!(settings.config.winch_m_per_s, Some(0.016));
}

#[test]
fn the_longest_lines_have_room() {
    // Sets every number to the longest text.
    let longest = Decimal(LONG).to_string().len();
    for bits in (0..u32::MAX).step_by(65_537) {
        assert!(Decimal(f32::from_bits(bits)).to_string().len() <= longest, "{bits:x}");
    }
    let report = Line::Report(longest_report());
    returns(&report);
    assert!(report.to_text().unwrap().len() <= LINE_LEN);
    returns(&Line::Event(longest_event()));
    returns(&Line::Start { run: !0, settings: longest_settings() });
    let health = Health { period_s: Some(LONG), jitter_s: Some(LONG), ..Health::default() };
    returns(&Line::Health(Health { samples: !0, overruns: !0, deepest: !0, ..health }));
}
