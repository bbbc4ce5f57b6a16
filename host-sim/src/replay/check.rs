//! The check of the two stiffnesses: of the winch speed and of omega with the weight.

/// Standard errors up to which the two agree.
const STANDARD_ERRORS: f64 = 3.0;
/// Relative difference up to which nothing is asked: a cable that sags and flops, which `sag_flop`
/// shows, may explain it.
const SMALL: f64 = 0.07;
/// Relative difference up to which slips that are no ellipses may explain it, whatever the stated
/// standard deviation of omega: of 24 records each of `scenes/honesty`, with right inputs, those of
/// `rocking` (friction that swings by 5 %) are off by up to .118, of `lag_30` (a cell that lags by
/// 30 ms) by up to .112; `jitter_10` (time stamps off by 10 ms) more often than not by less than
/// .12, and beyond .13 within three of its standard errors.
const OF_SLIPS: f64 = 0.13;

/// Verdict of the ratio of the two stiffnesses on the inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// They agree within their standard errors.
    Agrees,
    /// They differ by more, but too little to ask about.
    Differs,
    /// Weight or winch speed may be wrong; the slips may explain it too.
    Doubtful,
    /// Weight or winch speed is wrong, or the slips are far from the model.
    Contradicts,
}

impl Check {
    /// The verdict on a ratio with its standard deviation.
    #[must_use]
    pub fn of(ratio: f64, std: f64) -> Self {
        match (ratio - 1.0).abs() {
            off if off <= STANDARD_ERRORS * std => Self::Agrees,
            off if off <= SMALL => Self::Differs,
            off if off <= OF_SLIPS => Self::Doubtful,
            _ => Self::Contradicts,
        }
    }

    /// Whether a reader is asked about it.
    #[must_use]
    pub fn is_asked(self) -> bool {
        matches!(self, Self::Doubtful | Self::Contradicts)
    }

    /// The remark beside the ratio.
    #[must_use]
    pub fn remark(self) -> &'static str {
        match self {
            Self::Agrees => "of the two: checks both",
            Self::Differs | Self::Doubtful => {
                "of the two: differ by more than their ±; slips that are no ellipses do that"
            }
            Self::Contradicts => "of the two: they disagree",
        }
    }

    /// What may be wrong, for a sentence; `None` where nothing is asked.
    #[must_use]
    pub fn suspects(self) -> Option<&'static str> {
        match self {
            Self::Agrees | Self::Differs => None,
            Self::Doubtful => Some(
                "weight or winch speed may be wrong by that much, or the slips shift omega, as time \
                 stamps off by 10 ms, a cell that lags by 30 ms or a block that rocks do",
            ),
            Self::Contradicts => Some(
                "weight or winch speed is wrong, or friction changes along the slip, or the sampling \
                 is too slow",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_accusation_needs_more_than_slips_explain_and_more_than_its_errors() {
        for (ratio, std, check) in [
            (1.02, 0.011, Check::Agrees),
            (1.05, 0.011, Check::Differs),
            (0.905, 0.013, Check::Doubtful),
            (1.118, 0.012, Check::Doubtful),
            (1.163, 0.062, Check::Agrees),
            (1.25, 0.012, Check::Contradicts),
            (0.8, 0.012, Check::Contradicts),
        ] {
            assert_eq!(Check::of(ratio, std), check, "{ratio} ± {std}");
            assert_eq!(check.is_asked(), check.suspects().is_some());
        }
    }
}
