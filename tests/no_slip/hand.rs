//! A cable tightened, held and released by hand, without any sliding.

use floe::bench::scenes::phase;
use floe_core::Config;

use crate::{HZ, SEEDS, config, noisy, read};

/// Loading rate of the winch, N/s.
const RATE: f64 = 360.0;
/// Length of a record, s.
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
                let record = noisy(seed, DURATION_S, |t| hand.force_n(t + phase(seed) / HZ));
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

/// A cable that is wound up evenly and let go from the top, without a hold.
#[derive(Clone, Copy, Debug)]
struct WoundUp {
    top_n: f64,
    /// Duration of the winding, of the release, and of the following slack, s.
    up_s: f64,
    fall_s: f64,
    slack_s: f64,
    /// By how much the slack is longer in some records than in others, s.
    spread_s: f64,
}

impl WoundUp {
    /// In 8 s, far more slowly than by the winch of [`known`].
    fn slowly(fall_s: f64, slack_s: f64) -> Self {
        Self { top_n: 470.0, up_s: 8.0, fall_s, slack_s, spread_s: 0.0 }
    }

    /// Releases, falls and coefficients in records of [`DURATION_S`].
    fn read(self, config: &Config) -> [usize; 3] {
        let Self { top_n, up_s, fall_s, slack_s, spread_s } = self;
        let (mut released, mut falls, mut coefficients) = (0, 0, 0);
        for seed in 1..=SEEDS {
            let period_s = up_s + fall_s + slack_s + spread_s * phase(seed);
            let force_n = |t: f64| {
                let t = (t + phase(seed) / HZ) % period_s;
                top_n * (t / up_s).min(1.0 - (t - up_s) / fall_s).max(0.0)
            };
            let outcome = read(config, noisy(seed, DURATION_S, force_n));
            released += (DURATION_S / period_s) as usize;
            falls += outcome.events.len();
            coefficients += outcome.coefficients();
        }
        let winch = config.winch_m_per_s;
        println!("{self:?}, winch {winch:?}: {coefficients} of {falls} falls, {released} releases");
        [released, falls, coefficients]
    }
}

/// The speed of the winch is known.
fn known() -> Config {
    Config { winch_m_per_s: Some(0.0157), ..config() }
}

/// Let go at once: the cable is loaded far too slowly for a slip that fast.
#[test]
fn a_cable_wound_up_slowly_and_let_go_gives_no_coefficient() {
    for (fall_s, slack_s) in [(0.03, 0.0), (0.06, 0.0), (0.12, 0.0), (0.06, 1.5), (0.12, 1.5)] {
        let [_, falls, coefficients] = WoundUp::slowly(fall_s, slack_s).read(&known());
        assert!(falls > 150 && coefficients * 20 < falls, "{fall_s} {slack_s} {coefficients}");
    }
}

/// Let go in a few samples: the force falls evenly, as in no slip, and such a fall may be no event.
#[test]
fn a_cable_let_go_evenly_gives_no_coefficient() {
    for (fall_s, slack_s) in [(0.2, 1.5), (0.25, 1.5), (0.3, 0.2)] {
        let [released, _, coefficients] = WoundUp::slowly(fall_s, slack_s).read(&known());
        assert!(coefficients * 20 < released, "{fall_s} {slack_s} {coefficients} of {released}");
    }
}

/// Wound up in some seconds and let go at once, slack for some seconds: at most one release in
/// twenty has a coefficient, and one in eight if a winch speed is stated that fits the hand's by
/// chance.
#[test]
fn a_cable_wound_up_and_let_go_without_a_hold_gives_no_coefficient() {
    for (top_n, up_s, fall_s, slack_s) in [
        (360.0, 3.0, 0.15, 4.85),
        (200.0, 3.0, 0.15, 4.85),
        (600.0, 4.0, 0.15, 3.85),
        (360.0, 3.0, 0.06, 4.94),
        (360.0, 5.0, 0.2, 3.8),
    ] {
        for (config, part) in [(config(), 20), (known(), 8)] {
            let cable = WoundUp { top_n, up_s, fall_s, slack_s, spread_s: 1.0 };
            let [released, _, coefficients] = cable.read(&config);
            assert!(coefficients * part < released, "{cable:?}: {coefficients} of {released}");
        }
    }
}
