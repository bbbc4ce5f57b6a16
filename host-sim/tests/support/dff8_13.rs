//! An event of DFF8-13 as in the output of a board.

use floe_core::{Coefficient, Event, Quality, SampleTime};

pub fn event() -> Event {
    let coefficient = |value| Some(Coefficient::random(value, 0.000_74));
    Event {
        index: 6,
        onset: SampleTime { index: 206, fraction: 0.4 },
        stop: SampleTime { index: 209, fraction: 0.1 },
        static_force_n: 781.2,
        dynamic_force_n: 491.4,
        peak_force_n: 781.8,
        restick_force_n: 201.6,
        mu_s: coefficient(1.2404),
        mu: coefficient(0.7798),
        stick_s: Some(1.6),
        slip_s: 0.173,
        loading_rate_n_per_s: 361.1,
        omega_rad_per_s: Some(18.9),
        slack: false,
        quality: Quality::Good,
        reason: None,
    }
}
