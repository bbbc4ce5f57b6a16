//! For how long the cable hangs slack: a winch that stands meanwhile, or a hand that lets go, makes it
//! longer.
//!
//! On a slack cable the time without force tells `Fp` (`model/slack.rs`), to a thousandth, if the
//! winch turns; a winch that stands makes that as much lower as its pause is long, and nothing else
//! in the event shows it. So `Fp / Fs` has to be near those of the events before; of three in a row
//! that are not, the third is how things are now (`stats/fading_trend.rs`).

use crate::fit::posterior::Posterior;
use crate::stats::fading_trend::FadingTrend;

/// Least scatter of `Fp / Fs` from event to event, parts of it: two events that happen to lie near each
/// other do not make the third far off. A choice: six times as much is found, in scene `slack` a pause
/// of two thirds of the time without force.
const SCATTER: f32 = 0.02;

/// `Fp / Fs` of the events with a slack cable.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slackness(FadingTrend);

impl Slackness {
    /// Takes an event with a slack cable: was that slack for far longer than usual?
    pub(crate) fn is_long(&mut self, posterior: &Posterior) -> bool {
        let Self(trend) = self;
        let static_n = posterior.cycle.static_n;
        let ratio = posterior.cycle.dynamic_n() / static_n;
        let own = posterior.dynamic_n2 / (static_n * static_n);
        let scatter = SCATTER * ratio;
        trend.forget();
        let usual = trend.mean();
        trend.add(ratio, own + scatter * scatter);
        trend.is_off() && usual.is_some_and(|usual| ratio < usual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::CycleParams;
    use crate::tests::Random;

    /// An event of `Fs` 630 N, 252 N of `Fp` times a factor.
    fn event(factor: f32) -> Posterior {
        let (static_n, dynamic_n) = (630.0, 252.0 * factor);
        let cycle =
            CycleParams { static_n, half_drop_n: static_n - dynamic_n, ..CycleParams::default() };
        Posterior { cycle, dynamic_n2: 0.1, ..Posterior::default() }
    }

    #[test]
    fn a_pause_is_told_from_friction_that_scatters() {
        for scatter in [0.0, 0.01, 0.05] {
            let (mut slackness, mut random) = (Slackness::default(), Random(5));
            let mut usual = || event(1.0 + scatter * random.normal());
            let long = (0..200).filter(|_| slackness.is_long(&usual())).count();
            assert_eq!(long, 0, "{scatter}");
            assert!(slackness.is_long(&event(0.6)) && !slackness.is_long(&usual()), "{scatter}");
        }
    }

    /// Friction may fall; and a cable that is slack for less time was not let go.
    #[test]
    fn of_three_in_a_row_the_third_is_usual() {
        let mut slackness = Slackness::default();
        assert!((0..5).all(|_| !slackness.is_long(&event(1.0))));
        assert!((0..2).all(|_| slackness.is_long(&event(0.6))));
        assert!((0..5).all(|_| !slackness.is_long(&event(0.6))));
        assert!(!slackness.is_long(&event(1.0)));
    }
}
