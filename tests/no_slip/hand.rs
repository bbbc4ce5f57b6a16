//! A cable tightened, held and released by hand, without any sliding.

use floe::bench::scenes::phase;
use floe_core::Config;

use crate::{HZ, SEEDS, config, noisy, read};

/// Loading rate of the winch, N/s.
const RATE: f64 = 360.0;
/// Time in which a cable is wound up slowly, and length of such a record, s.
const WINDING_S: f64 = 8.0;
const DURATION_S: f64 = 120.0;

/// Repeated action of a hand.
#[derive(Clone, Copy, Debug)]
struct Hand {
    /// Force held, N, and duration, s.
    top_n: f64,
    hold_s: f64,
    /// Duration of the release, and of the following slack, s.
    fall_s: f64,
    slack_s: f64,
}

impl Hand {
    fn force_n(&self, t: f64) -> f64 {
        let up_s = self.top_n / RATE;
        let let_go_s = up_s + self.hold_s;
        let t = t % (let_go_s + self.fall_s + self.slack_s);
        let fallen = ((t - let_go_s) / self.fall_s).clamp(0.0, 1.0);
        self.top_n * (1.0 - fallen) * (t / up_s).min(1.0)
    }
}

/// Holding for 0.5 to 6 s, release at once or within 0.25 s, and tightening at once or after a
/// pause: at most one fall in fifty has a coefficient.
#[test]
fn a_cable_that_was_held_gives_no_coefficient() {
    let (mut seen, mut believed) = (0, 0);
    for (top_n, hold_s) in [(360.0, 6.0), (500.0, 2.5), (500.0, 0.7), (250.0, 1.3)] {
        for (fall_s, slack_s) in [(0.01, 0.0), (0.07, 0.0), (0.17, 0.0), (0.07, 1.9), (0.17, 1.9)] {
            let hand = Hand { top_n, hold_s, fall_s, slack_s };
            let (mut falls, mut coefficients) = (0, 0);
            for seed in 1..=SEEDS {
                let record = noisy(seed, 120.0, |t| hand.force_n(t + phase(seed) / HZ));
                let outcome = read(&config(), record);
                falls += outcome.events.len();
                coefficients += outcome.coefficients();
            }
            println!("{hand:?}: {coefficients} of {falls} falls with coefficients");
            (seen, believed) = (seen + falls, believed + coefficients);
        }
    }
    println!("all: {believed} of {seen}");
    assert!(seen > 10_000 && believed * 50 < seen, "{believed} of {seen}");
}

/// Falls and coefficients of a cable wound up evenly in 8 s and let go from the top, where the speed
/// of the winch is known, over records of [`DURATION_S`].
fn wound_up(fall_s: f64, slack_s: f64) -> (usize, usize) {
    let config = Config { winch_m_per_s: Some(0.0157), ..config() };
    let (mut falls, mut coefficients) = (0, 0);
    for seed in 1..=SEEDS {
        let force_n = |t: f64| {
            let t = (t + phase(seed) / HZ) % (WINDING_S + fall_s + slack_s);
            470.0 * (t / WINDING_S).min(1.0 - (t - WINDING_S) / fall_s).max(0.0)
        };
        let outcome = read(&config, noisy(seed, DURATION_S, force_n));
        falls += outcome.events.len();
        coefficients += outcome.coefficients();
    }
    println!("{fall_s} {slack_s}: {coefficients} of {falls} falls with coefficients");
    (falls, coefficients)
}

/// Let go at once: the cable is loaded far too slowly for a slip that fast.
#[test]
fn a_cable_wound_up_slowly_and_let_go_gives_no_coefficient() {
    for (fall_s, slack_s) in [(0.03, 0.0), (0.06, 0.0), (0.12, 0.0), (0.06, 1.5), (0.12, 1.5)] {
        let (falls, coefficients) = wound_up(fall_s, slack_s);
        assert!(falls > 150 && coefficients * 20 < falls, "{fall_s} {slack_s} {coefficients}");
    }
}

/// Let go in a few samples: the force falls evenly, as in no slip, and such a fall may be no event.
#[test]
fn a_cable_let_go_evenly_gives_no_coefficient() {
    for (fall_s, slack_s) in [(0.2, 1.5), (0.25, 1.5), (0.3, 0.2)] {
        let (_, coefficients) = wound_up(fall_s, slack_s);
        let released = SEEDS as usize * (DURATION_S / (WINDING_S + fall_s + slack_s)) as usize;
        assert!(coefficients * 20 < released, "{fall_s} {slack_s} {coefficients} of {released}");
    }
}

/// Wound up in some seconds and let go from the top at once, without a hold, slack for some seconds:
/// at most one release in twenty has a coefficient, and one in eight if a winch speed is stated that
/// fits the hand's by chance.
#[test]
fn a_cable_wound_up_and_let_go_without_a_hold_gives_no_coefficient() {
    for (top_n, up_s, fall_s, slack_s) in [
        (360.0, 3.0, 0.15, 4.85),
        (200.0, 3.0, 0.15, 4.85),
        (600.0, 4.0, 0.15, 3.85),
        (360.0, 3.0, 0.06, 4.94),
        (360.0, 5.0, 0.2, 3.8),
    ] {
        for winch_m_per_s in [None, Some(0.0157)] {
            let config = Config { winch_m_per_s, ..config() };
            let (mut released, mut coefficients) = (0.0, 0);
            for seed in 1..=SEEDS {
                let period_s = up_s + fall_s + slack_s + phase(seed);
                let force_n = |t: f64| {
                    let t = (t + phase(seed) / HZ) % period_s;
                    top_n * (t / up_s).min(1.0 - (t - up_s) / fall_s).max(0.0)
                };
                coefficients += read(&config, noisy(seed, DURATION_S, force_n)).coefficients();
                released += DURATION_S / period_s;
            }
            let of = format!("{top_n} N in {up_s} s, {fall_s} s, winch {winch_m_per_s:?}");
            println!("{of}: {coefficients} of {released:.0} releases with coefficients");
            let most = if winch_m_per_s.is_some() { released / 8.0 } else { released / 20.0 };
            assert!((coefficients as f64) < most, "{of}: {coefficients} of {released:.0}");
        }
    }
}
