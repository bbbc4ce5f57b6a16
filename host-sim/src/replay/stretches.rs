//! Stretches of a log that belong to no event.

use floe_core::{Config, Stretch, StretchKind};
use serde::Serialize;

use crate::rounding::{digits, narrow, plus_minus};

/// All such stretches of a log, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stretches {
    /// Where the force was constant.
    pub steady: Vec<SteadySummary>,
    /// Where the force fell without a slip.
    pub not_understood: Vec<NotUnderstood>,
}

/// A constant force: a held cable and a block that slides evenly look the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteadySummary {
    /// In the log's own time.
    pub start_s: f64,
    /// In the log's own time.
    pub stop_s: f64,
    /// Mean force over the weight.
    pub force_over_weight: f64,
    /// One standard deviation of that mean.
    pub std: f64,
    /// Whether the block moved, as the winch turned or not; `null`: not known, as when the cable
    /// was slack.
    pub moving: Option<bool>,
    /// The coefficient, if the block slid, and its combined standard deviation.
    #[serde(skip)]
    pub sliding: (f32, f32),
}

/// Falls of the force that are no slips.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotUnderstood {
    /// In the log's own time.
    pub start_s: f64,
    /// In the log's own time.
    pub stop_s: f64,
    /// The reason in words.
    pub reason: String,
}

impl Stretches {
    /// Adds a stretch; its times are in the log's seconds.
    pub fn add(&mut self, stretch: &Stretch, config: &Config, start_s: f64, stop_s: f64) {
        match stretch.kind {
            StretchKind::Steady { force_over_weight, std, moving } => {
                let sliding = floe_core::of_constant_force(config, (force_over_weight, std));
                let [force_over_weight, std] = [force_over_weight, std].map(shortest);
                // A slack cable moves no block, even if the winch turns.
                let slides = |moves: &bool| !(*moves && is_nothing(force_over_weight, std));
                let moving = moving.filter(slides);
                let steady =
                    SteadySummary { start_s, stop_s, force_over_weight, std, moving, sliding };
                self.steady.push(steady);
            }
            StretchKind::NotUnderstood(reason) => {
                let reason = reason.to_string();
                self.not_understood.push(NotUnderstood { start_s, stop_s, reason });
            }
        }
    }
}

impl SteadySummary {
    /// One sentence for a person.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Self { start_s, stop_s, force_over_weight, std, moving, sliding } = self;
        let decimals = digits(*std).max(4);
        let what = match moving {
            _ if is_nothing(*force_over_weight, *std) => {
                "no force: the cable was slack, or nothing hung on the cell".to_string()
            }
            None => "held or sliding: the force alone cannot tell".to_string(),
            Some(false) => "the winch stood: the cable was held".to_string(),
            Some(true) => {
                let (mu, std) = *sliding;
                format!("mu {}, if the winch turned then", plus_minus(mu.into(), std.into()))
            }
        };
        format!(
            "{start_s:.2} to {stop_s:.2} s: constant force, F/W {force_over_weight:.decimals$} ± \
             {std:.decimals$}; {what}"
        )
    }
}

impl NotUnderstood {
    /// One sentence for a person.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!("{:.2} to {:.2} s: {}", self.start_s, self.stop_s, self.reason)
    }
}

/// A short text for a display.
#[must_use]
pub fn told(stretch: &Stretch) -> String {
    match stretch.kind {
        StretchKind::Steady { force_over_weight, std, moving } => {
            let what = match moving {
                _ if is_nothing(force_over_weight.into(), std.into()) => "no force",
                None => "held or sliding",
                Some(false) => "held",
                Some(true) => "mu, if the winch turned",
            };
            let std = narrow(std.into());
            format!("constant force, F/W {force_over_weight:.4} ± {std}: {what}")
        }
        StretchKind::NotUnderstood(reason) => format!("no slip: {reason}"),
    }
}

/// Whether a mean force is within three standard deviations of zero.
fn is_nothing(force_over_weight: f64, std: f64) -> bool {
    force_over_weight.abs() <= 3.0 * std
}

/// The `f64` with the same shortest decimal digits as the `f32`.
fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::{Reason, SampleTime};

    fn stretch(kind: StretchKind) -> Stretch {
        let time = SampleTime { index: 0, fraction: 0.0 };
        Stretch { start: time, stop: time, kind }
    }

    fn steady(force_over_weight: f64, std: f64, moving: Option<bool>) -> SteadySummary {
        let (start_s, stop_s, sliding) = (0.0, 9.0, (force_over_weight as f32, 2e-3));
        SteadySummary { start_s, stop_s, force_over_weight, std, moving, sliding }
    }

    #[test]
    fn each_is_said_as_the_interface_has_it() {
        let mut all = Stretches::default();
        let steady = StretchKind::Steady { force_over_weight: 0.78, std: 0.000_5, moving: None };
        all.add(&stretch(steady), &Config::default(), 2.0, 22.5);
        let back = stretch(StretchKind::NotUnderstood(Reason::WoundBack));
        all.add(&back, &Config::default(), 30.0, 31.5);
        let json = serde_json::to_string(&all).unwrap();
        assert_eq!(
            json,
            r#"{"steady":[{"start_s":2.0,"stop_s":22.5,"force_over_weight":0.78,"std":0.0005,"moving":null}],"#
                .to_owned()
                + r#""not_understood":[{"start_s":30.0,"stop_s":31.5,"reason":"the force falls evenly: the winch turned back"}]}"#
        );
    }

    #[test]
    fn a_slack_cable_moves_no_block() {
        let moving = |force_over_weight, moving| {
            let steady = StretchKind::Steady { force_over_weight, std: 1e-4, moving };
            let mut all = Stretches::default();
            all.add(&stretch(steady), &Config::default(), 0.0, 9.0);
            all.steady[0].moving
        };
        assert_eq!(moving(2e-5, Some(true)), None);
        assert_eq!(moving(2e-5, Some(false)), Some(false));
        assert_eq!(moving(0.78, Some(true)), Some(true));
    }

    #[test]
    fn only_a_winch_that_turns_makes_it_a_coefficient() {
        let said = |moving| steady(0.4022, 1e-3, moving).sentence();
        assert!(said(None).contains("held or sliding: the force alone cannot tell"));
        let sliding = said(Some(true));
        assert!(sliding.ends_with("; mu 0.4022 ± 0.0020, if the winch turned then"), "{sliding}");
        assert!(!said(Some(false)).contains("mu"));
    }

    #[test]
    fn a_slack_cable_is_no_block_that_slides() {
        let said = steady(-2e-5, 1e-4, Some(true)).sentence();
        assert!(said.contains("the cable was slack") && !said.contains("mu"), "{said}");
        let said = steady(4e-4, 1e-4, Some(true)).sentence();
        assert!(said.contains("mu 0.0004 ± 0.0020, if"), "{said}");
    }
}
