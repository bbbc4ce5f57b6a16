//! Stretches of a log that belong to no event.

use floe_core::{Config, InputStd, Stretch, StretchKind};
use serde::Serialize;

use super::result::ChangeSummary;
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
    /// Mean force over the weight in use at that time.
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
    /// Adds a stretch; its times are in the log's seconds. Its weight is the given one until
    /// [`Stretches::with_changes`].
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

    /// The stretches with the weight that is in use after each change of the test, in order. A
    /// stretch that begins before the first slip after a change has the weight before it.
    #[must_use]
    pub fn with_changes(mut self, changes: &[ChangeSummary], config: &Config) -> Self {
        for steady in &mut self.steady {
            let before = |it: &&ChangeSummary| it.onset_s <= steady.start_s;
            if let Some(change) = changes.iter().rfind(before) {
                steady.set_weight(change, config);
            }
        }
        self
    }
}

impl SteadySummary {
    /// Replaces the given weight by the one that is in use after a change.
    fn set_weight(&mut self, change: &ChangeSummary, config: &Config) {
        let [ratio, ratio_std] = [change.weight_ratio, change.weight_ratio_std].map(|it| it as f32);
        let [mean, std] =
            [self.force_over_weight, self.std].map(|over_given| over_given as f32 / ratio);
        // The ratio is a factor of the weight: their relative variances add.
        let weight = config.std.weight.hypot(ratio_std / ratio);
        let config = Config {
            weight_n: ratio * config.weight_n,
            std: InputStd { weight, ..config.std },
            ..*config
        };
        self.sliding = floe_core::of_constant_force(&config, (mean, std));
        [self.force_over_weight, self.std] = [mean, std].map(shortest);
    }

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

    fn change(onset_s: f64, weight_ratio: f64, weight_ratio_std: f64) -> ChangeSummary {
        ChangeSummary { event: 0, onset_s, cause: "mass", weight_ratio, weight_ratio_std }
    }

    /// A stretch has the weight of its own time, and `mu` the uncertainty of that weight.
    #[test]
    fn a_broken_block_has_its_own_weight() {
        let std = InputStd { weight: 0.01, ..InputStd::EXACT };
        let config = Config { weight_n: 630.0, std, ..Config::default() };
        let kind =
            StretchKind::Steady { force_over_weight: 0.56, std: 0.000_7, moving: Some(true) };
        let mut all = Stretches::default();
        for start_s in [10.0, 40.0, 90.0] {
            all.add(&stretch(kind), &config, start_s, start_s + 9.0);
        }
        let changes = [change(30.0, 0.7, 0.014), change(60.0, 0.35, 0.007)];
        let steady = all.with_changes(&changes, &config).steady;
        for (it, ratio) in steady.iter().zip([1.0, 0.7, 0.35]) {
            let ((mu, std), truth) = (it.sliding, 0.56 / ratio);
            assert!((it.force_over_weight - truth).abs() < 1e-6, "{it:?}");
            assert!((it.std - 0.000_7 / ratio).abs() < 1e-6, "{it:?}");
            assert!((f64::from(mu) - truth).abs() < 1e-6, "{it:?}");
            let weight = if ratio < 1.0 { 0.01_f64.hypot(0.02) } else { 0.01 };
            let combined = (0.000_7 / ratio).hypot(truth * weight);
            assert!((f64::from(std) - combined).abs() < 1e-5, "{it:?} {combined}");
        }
        assert_eq!(steady.len(), 3);
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
