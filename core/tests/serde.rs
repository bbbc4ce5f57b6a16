//! What the `serde` feature promises: what is written reads back as it was.
#![cfg(feature = "serde")]

use floe_core::{
    Calibration, Coefficient, Config, Counts, Event, Fault, Newtons, Pipeline, Quality, RawSample,
    Reading, Reason, Report, SampleTime,
};

fn round_trip<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> (T, String) {
    let text = serde_json::to_string(value).unwrap();
    (serde_json::from_str(&text).unwrap(), text)
}

#[test]
fn results_and_settings_read_back_as_they_were() {
    let event = Event {
        index: 3,
        onset: SampleTime { index: u32::MAX, fraction: 0.25 },
        stop: SampleTime { index: 9, fraction: 0.0 },
        static_force_n: 781.2,
        dynamic_force_n: 491.4,
        peak_force_n: 781.8,
        restick_force_n: 201.6,
        mu_s: Some(Coefficient { value: 1.24, std: 0.001, systematic_std: 0.004 }),
        mu: None,
        stick_s: Some(1.6),
        slip_s: 0.173,
        loading_rate_n_per_s: 361.1,
        omega_rad_per_s: None,
        slack: false,
        quality: Quality::Unresolved,
        reason: Some(Reason::TooShort),
    };
    let (back, text) = round_trip(&event);
    assert_eq!(back, event);
    assert!(text.contains(r#""quality":"unresolved","reason":"too_short""#), "{text}");
    let config = Config {
        weight_n: 630.0,
        winch_m_per_s: Some(0.0157),
        calibration: Calibration { counts_per_n: -812.5, ..Calibration::default() },
        ..Config::default()
    };
    assert_eq!(round_trip(&config).0, config);
    for reading in [
        Reading::Counts(Counts(-5)),
        Reading::Force(Newtons(1.5)),
        Reading::Bad(Fault::Disconnected),
    ] {
        let sample = RawSample { index: 7, reading };
        assert_eq!(round_trip(&sample).0, sample);
    }
}

#[test]
fn a_report_of_nothing_is_a_report() {
    let pipeline = Pipeline::new(&Config { weight_n: 1.0, ..Config::default() }).unwrap();
    let (back, _): (Report, _) = round_trip(&pipeline.report());
    assert_eq!(back, pipeline.report());
}

#[test]
fn a_configuration_that_is_read_is_still_checked() {
    let mut said = serde_json::to_value(Config::default()).unwrap();
    said["weight_n"] = (-1.0).into();
    let config: Config = serde_json::from_value(said).unwrap();
    assert!(Pipeline::new(&config).is_err());
}
