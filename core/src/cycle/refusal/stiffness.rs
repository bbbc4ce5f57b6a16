//! Ratio of the cable's stiffness from the winch to that from the slips. Where it is not one, the
//! fitted slip is not the slip that the block made.

use crate::coefficient::Site;
use crate::num::math;

/// Ratio of the stiffnesses above which no error of weight, winch or model explains it: of the
/// scenes that can be read none reaches 1.2.
const STIFFER: f32 = 2.0;
/// Ratio of the stiffnesses below which no error of weight or winch speed explains it: both are
/// known better than to a half.
const SOFTER: f32 = 2.0 / 3.0;
/// Limits of the root of the ratio within which the ratio counts as one: within about 20 %.
const CLOSE: (f32, f32) = (0.9, 1.11);
/// Standard errors by which the root has to be beyond a limit, where the true ratio is far beyond.
/// Tuned: at four, seven times as many events of `aliased_fast` and `aliased_stiff` are believed.
const LIKELY: f32 = 2.0;

/// Confidence limits of the root of the ratio of two stiffnesses, `k = F'/w` over `k = ω² M`. NaN
/// where the speed of the winch is unknown: all comparisons are then false.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootStiffnessRatio {
    least: f32,
    most: f32,
}

impl RootStiffnessRatio {
    /// From the loading rate, N per period, and the swing, periods, each with its variance.
    pub(crate) fn new(site: &Site, rate: (f32, f32), swing: (f32, f32)) -> Self {
        let root = swing.0 * math::sqrt(rate.0 / site.momentum);
        // The relative error of a root is half that of its argument.
        let unsure = 0.25 * rate.1 / (rate.0 * rate.0) + swing.1 / (swing.0 * swing.0);
        let by = LIKELY * root * math::sqrt(unsure);
        Self { least: root - by, most: root + by }
    }

    /// Is the stiffness from the winch significantly larger than that from the slips? Then the
    /// slips may be aliases, made of single samples of many faster slips: time stretched by a factor
    /// lowers `k = F'/w` by the factor and `k = ω² M` by its square, and the true slips recur that
    /// much faster: at least once a sample, or their samples would not make smooth lines. A ratio
    /// that is surely less than `periods`, the time to the next slip, has another cause: real slips
    /// last longer than inertia tells. The two stiffnesses may be wrong by [`SOFTER`].
    pub(crate) fn is_folded(self, periods: f32) -> bool {
        let (least, most) = (self.least * self.least, self.most * self.most);
        self.least > 0.0 && least > STIFFER && most > SOFTER * periods
    }

    /// Is the ratio significantly close to one? Then the slips are neither aliases nor an
    /// oscillation of the cell.
    pub(crate) fn is_one(self) -> bool {
        self.least > CLOSE.0 && self.most < CLOSE.1
    }

    /// Is the loading rate significantly too low for the swing? A winch of known speed loads the
    /// cable at `ω² M w`; at two thirds of that the fit has found another slip than the one in the
    /// samples, which happens with few of them, or a hand has let the cable go.
    pub(crate) fn is_low(self) -> bool {
        self.most * self.most < SOFTER
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DFF8-13: `k w` of 360 N/s, a swing of a 19th of a second.
    #[test]
    fn time_that_is_stretched_is_seen_if_the_winch_is_known() {
        let (hz, rate_n_per_s, omega) = (16.0, 360.0, 18.93_f32);
        let mass_kg = 630.0 / 9.806_65;
        let winch_m_per_s = rate_n_per_s / (omega * omega * mass_kg);
        let limits = |winch_m_per_s: f32, stretched: f32, std: f32| {
            let site = Site {
                weight_n: 630.0,
                momentum: mass_kg * winch_m_per_s * hz,
                slope: (0.0, 1.0),
                rate_hz: hz,
            };
            let (rate, swing) = (rate_n_per_s / hz / stretched, stretched * hz / omega);
            let variance = |value: f32| std * std * value * value;
            RootStiffnessRatio::new(&site, (rate, variance(rate)), (swing, variance(swing)))
        };
        for (stretched, std, folded, is_one) in [
            (1.0, 0.001, false, true),
            (1.0, 0.04, false, true),
            (1.0, 0.06, false, false),
            (2.5, 0.001, false, false),
            (19.0, 0.001, false, false),
            (20.0, 0.001, true, false),
            (15.0, 0.01, false, false),
            (15.0, 0.1, true, false),
            (29.0, 0.25, true, false),
            (29.0, 0.4, false, false),
        ] {
            let seen = limits(winch_m_per_s, stretched, std);
            let got = (seen.is_folded(29.0), seen.is_one());
            assert_eq!(got, (folded, is_one), "{stretched} ± {std}");
            let unknown = limits(f32::NAN, stretched, std);
            assert!(!unknown.is_folded(29.0) && !unknown.is_one() && !unknown.is_low());
        }
    }
}
