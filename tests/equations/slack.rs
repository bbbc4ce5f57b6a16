//! The core's force of a cable that goes slack.

use super::*;

/// Blocks whose cable goes slack: for long, briefly, and for a moment while the block slides on (a
/// fast winch, `d < Fp < a`).
fn slack_cases() -> Vec<Pull> {
    let mut cases = Vec::new();
    for (mu_s, mu) in [(1.5, 0.3), (1.0, 0.4), (0.85, 0.42), (0.8, 0.41), (0.78, 0.4)] {
        for (weight_n, stiffness_n_per_m) in
            [(300.0, 230e3), (630.0, 23e3), (3000.0, 23e3), (630.0, 2.3e3)]
        {
            for winch_m_per_s in [0.001, 360.0 / 23e3, 0.1, 0.4] {
                for slope_rad in [-0.1, 0.0, 0.1] {
                    let mut pull = Pull {
                        weight_n,
                        stiffness_n_per_m,
                        winch_m_per_s,
                        mu_s,
                        mu,
                        slope_rad,
                        gravity_m_per_s2: GRAVITY_M_PER_S2,
                        ..Pull::default()
                    };
                    pull.step_s = 0.02 / omega(&pull);
                    cases.push(pull);
                }
            }
        }
    }
    cases
}

#[test]
fn core_force_of_a_cable_that_goes_slack() {
    let (mut rested, mut caught) = (0, 0);
    for pull in slack_cases() {
        let mut block = Block::resting(&pull, start_n(&pull));
        let (mut states, mut events) = (Vec::new(), Vec::new());
        while events.is_empty() || !block.state.sliding {
            events.extend(block.step(&pull, pull.step_s));
            states.push(block.state);
        }
        let (event, cycle) = (events[0], closed(&pull));
        assert_eq!(event.slack, cycle.shape().is_slack(), "{pull:?}");
        if !event.slack {
            continue;
        }
        let onset_s = event.onset_s;
        let force_n = SINGLE * event.peak_n;
        agree("re-stick force", cycle.restick_n().into(), event.restick_n, 4.0 * force_n, &pull);
        let slide_s = event.stop_s - onset_s;
        let since_s = slide_s.max(1.0 / omega(&pull));
        agree("slide", cycle.slide_time().into(), slide_s, 4.0 * SINGLE * since_s, &pull);
        let shape = cycle.shape();
        // A rounded time matters where the slack lasts long.
        let steepest = omega(&pull) * f64::from(cycle.amplitude_n());
        for state in states.iter().filter(|s| s.time_s > onset_s) {
            let since_s = state.time_s - onset_s;
            let rate = if since_s < slide_s { steepest } else { cycle.rate.into() };
            let tolerance = 8.0 * force_n + 4.0 * SINGLE * rate * since_s;
            let got = shape.force(since_s as f32).0;
            agree("force", got.into(), pull.force_n(state), tolerance, &pull);
        }
        if event.restick_n > 0.0 {
            caught += 1;
        } else {
            rested += 1;
        }
    }
    println!("{rested} rest on a slack cable, {caught} are caught sliding");
    assert!(rested >= 100 && caught >= 10, "{rested} {caught}");
}
