//! Detection of a cable that is slack for too long, because the winch stood or a hand let it go.
//!
//! On a slack cable the time without force determines `Fp` (`model/slack.rs`) to a thousandth, if
//! the winch turns. A pause of the winch makes that time longer and `Fp` too low, and nothing else
//! in the event shows it. So `Fp / Fs` is compared with that of the events before; an outlier is
//! refused, and the third outlier in a row is accepted as a change (`stats/fading_trend.rs`).

use crate::fit::posterior::Posterior;
use crate::stats::fading_trend::FadingTrend;

/// Least standard deviation of `Fp / Fs` between events, relative: two events that happen to be
/// close do not make the third an outlier. A choice: six times as much is found, in scene `slack` a
/// pause of two thirds of the time without force.
const SCATTER: f32 = 0.02;

/// Running mean of `Fp / Fs` over the events with a slack cable.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Slackness(FadingTrend);

impl Slackness {
    /// Updates the mean with an event on a slack cable. Is its `Fp / Fs` an outlier below the mean?
    pub(crate) fn is_long(&mut self, posterior: &Posterior) -> bool {
        let Self(trend) = self;
        let static_n = posterior.cycle.static_n;
        let ratio = posterior.cycle.dynamic_n() / static_n;
        let own = posterior.forces_n2().1 / (static_n * static_n);
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
        Posterior { cycle, variances: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1], ..Posterior::default() }
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
