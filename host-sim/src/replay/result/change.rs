//! Where the block or its friction changed.

use floe_core::{Cause, Change};
use serde::Serialize;

use super::numbers::short;

/// A change of the block or of its friction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangeSummary {
    /// Index of the first event after the change.
    pub event: u32,
    /// Onset of that event, in the log's own time.
    pub onset_s: f64,
    /// `mass`, `friction` or `unknown`.
    pub cause: &'static str,
    /// Weight for the coefficients from that event on, over the given weight.
    #[serde(with = "short")]
    pub weight_ratio: f64,
    /// One standard deviation of the ratio; the coefficients' own standard deviations include it.
    #[serde(with = "short")]
    pub weight_ratio_std: f64,
}

impl ChangeSummary {
    /// A change with its time in the log's seconds.
    #[must_use]
    pub fn new(change: &Change, onset_s: f64) -> Self {
        Self {
            event: change.event,
            onset_s,
            cause: match change.cause {
                Cause::Mass => "mass",
                Cause::Friction => "friction",
                Cause::Unknown => "unknown",
            },
            weight_ratio: change.weight_ratio.into(),
            weight_ratio_std: change.weight_ratio_std.into(),
        }
    }

    /// One sentence for a person; `weight_n`: the given weight.
    #[must_use]
    pub fn sentence(&self, weight_n: f64) -> String {
        let weight = weight_n * self.weight_ratio;
        let (onset_s, event) = (self.onset_s, self.event);
        let what = match self.cause {
            "mass" => format!(
                "the block's weight changed to {:.3} ± {:.3} of the given one, {weight:.1} N; \
                 the coefficients from there on use it",
                self.weight_ratio, self.weight_ratio_std
            ),
            "friction" => "the friction changed; the block's weight did not".to_string(),
            _ => format!(
                "the forces or the cable changed; if the block did, weigh it: the coefficients \
                 from there on use {weight:.1} N"
            ),
        };
        format!("at {onset_s:.2} s (event {event}) {what}")
    }
}
