//! Detection of a change of the block's mass from the swings of the events.
//!
//! While the block slides `ω² = k / M`. The cable does not change from one event to the next (the
//! loading rate `k w` would show it), so the swing `1/ω` is proportional to the root of the mass:
//! `M'/M = (ω/ω')²`, whatever the friction does.
//!
//! An event whose swing is an outlier is a suspect and gives no coefficient; the limit is lower
//! where its force `Fp` deviates as that mass implies. The next event is fitted without a prior of
//! the swing. If its swing is off as well, and its `Fp` is nearer to the new weight's than to the
//! old one's, the mass has changed. The weight is then multiplied by the measured ratio, whose
//! error is common to all later events. Where `Fp` is an outlier and the swing does not determine
//! why, the deviation is the uncertainty of that event's weight. Where single events hardly
//! determine the swing, a change of the forces' level starts a trial (`trial`).

mod swings;
mod trial;

pub(crate) use crate::effects::mass_change::swings::Evidence;

use crate::effects::mass_change::swings::{LEAST, Ratio, Swings};
use crate::stats::fading_trend::FadingTrend;
use crate::stats::prior::Prior;
use crate::stats::running_mean::RunningMean;

/// Standard deviations beyond which the mean swing of a trial is off. Tuned: fewer than for one
/// event, since a trial is only begun where the forces have changed as well.
const FAR_MEAN: f32 = 4.0;

/// Standard deviations beyond which an event's `Fp` is an outlier.
const FAR_FORCE: f32 = 5.0;

/// Number of events from which on single ones are judged by the others; and of swings since a
/// change of the mass from which on these alone show how they scatter.
const FEWEST: u32 = 5;
/// Largest number of events whose swings determine the ratio; later ones may have another cable
/// length.
const MOST: u32 = 16;
/// Suspects in a row, without a mass that explains them, that mean another change (as in
/// `FadingTrend`).
const ODD: u32 = 3;
/// Suspects in a row without a swing of their own that mean another change: more, since each holds
/// less information.
const SILENT: u32 = 8;

/// Result of the test of one event for a change of mass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// No change.
    #[default]
    Same,
    /// It is not known yet whether the mass has changed.
    Suspect,
    /// The mass has changed since the first suspect, or the start of the trial.
    Mass,
    /// The trial shows that the mass is the same.
    SameMass,
    /// The cable or the winch has changed, or the cause cannot be determined.
    Unknown,
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    #[default]
    Steady,
    /// An event was off: the trend of the swing before it, and the number of such events in a row.
    Suspect(FadingTrend, u32),
    /// The forces have changed: number of events since.
    Trial(u32),
}

/// Estimator of the weight ratio, which begins at one. The trend of the swing that its methods take
/// is that since the last change; a suspect begins it anew.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mass {
    state: State,
    /// Number of events since the last change that no mass explains.
    seen: u32,
    /// `Fp` of the recent events, N.
    dynamic_n: RunningMean,
    /// The weight in use over the given one, up to the last change.
    base: Ratio,
    /// Relative uncertainty of the newest event's weight, from an outlier of `Fp` of unknown cause.
    doubt: f32,
    /// The swing before the last change of mass or the trial, and the swings since.
    before: Option<Prior>,
    since: Swings,
}

impl Mass {
    /// During a suspicion, the trend of the swing from before the suspect.
    pub(crate) fn before_suspect(&self) -> Option<&FadingTrend> {
        if let State::Suspect(kept, _) = &self.state { Some(kept) } else { None }
    }

    /// Drops any suspicion or trial; the weight ratio stays.
    pub(crate) fn forget(&mut self) {
        self.start(None);
        self.state = State::Steady;
    }

    /// Tests an event. An event that is [`Verdict::Suspect`] outside a trial is not learnt from.
    pub(crate) fn judge(&mut self, swing: &mut FadingTrend, evidence: &Evidence) -> Verdict {
        let off = self.off(evidence);
        let forces = 1.0 + off;
        // The swing excludes the mass that the force implies: then the friction has changed.
        let usual = self.before_suspect().unwrap_or(swing);
        let is_friction = evidence.excludes(self.expected(usual), forces);
        self.doubt = if is_friction { 0.0 } else { off };
        match self.state {
            State::Trial(_) => Verdict::Suspect,
            State::Steady => self.judge_steady(swing, evidence, forces),
            State::Suspect(kept, odd) => {
                let (verdict, state) = self.judge_suspect(swing, evidence, forces, (&kept, odd));
                self.state = state;
                verdict
            }
        }
    }

    fn judge_steady(
        &mut self,
        swing: &mut FadingTrend,
        evidence: &Evidence,
        forces: f32,
    ) -> Verdict {
        let is_off = || evidence.is_off(self.expected(swing), forces);
        if self.seen < FEWEST || !(evidence.strained || is_off()) {
            return Verdict::Same;
        }
        self.state = State::Suspect(core::mem::take(swing), 1);
        Verdict::Suspect
    }

    /// Tests the event after a suspect.
    fn judge_suspect(
        &mut self,
        swing: &mut FadingTrend,
        evidence: &Evidence,
        forces: f32,
        (kept, odd): (&FadingTrend, u32),
    ) -> (Verdict, State) {
        let before = self.expected(kept);
        if evidence.strained || evidence.is_usual(before, forces) {
            *swing = *kept;
            // An event that the model does not describe is not learnt from either.
            (if evidence.strained { Verdict::Suspect } else { Verdict::Same }, State::Steady)
        } else if evidence.explains(before, self.dynamic_n.mean) {
            self.change_mass(before, evidence.dynamic_n);
            (Verdict::Mass, State::Steady)
        } else if odd >= if evidence.inverse_omega.is_some() { ODD } else { SILENT } {
            self.start(None);
            (Verdict::Unknown, State::Steady)
        } else {
            (Verdict::Suspect, State::Suspect(*kept, odd + 1))
        }
    }

    /// Learns from an event. Returns the verdict of a trial that ends with it.
    pub(crate) fn learn(&mut self, evidence: &Evidence) -> Option<Verdict> {
        self.seen = self.seen.saturating_add(1);
        // The swing of an event that may have another weight says nothing on this one.
        let is_of_this = self.doubt.abs() <= 0.0 || self.is_on_trial();
        if let Some(swing) = evidence.inverse_omega
            && self.before.is_some()
            && self.since.count < MOST
            && is_of_this
        {
            self.since.add(swing, evidence.dynamic_n);
        }
        if let State::Trial(events) = self.state {
            self.state = State::Trial(events + 1);
            let verdict = self.tried(events + 1)?;
            if verdict == Verdict::Unknown {
                self.leave_open(evidence.dynamic_n, self.dynamic_n.mean);
            }
            self.dynamic_n.mean = self.since.dynamic_n_or(self.dynamic_n.mean);
            return Some(verdict);
        }
        // An `Fp` that another weight may have caused does not enter the mean; the first one begins
        // it anew.
        if self.doubt.abs() <= 0.0 || self.seen == 1 {
            self.dynamic_n.add(evidence.dynamic_n, 1.0 / self.seen.clamp(1, 8) as f32);
        }
        None
    }

    /// Relative deviation of an event's `Fp` from the mean, if it is an outlier by more than
    /// [`LEAST`]; else zero.
    fn off(&self, evidence: &Evidence) -> f32 {
        let RunningMean { mean, variance } = self.dynamic_n;
        let off_n = evidence.dynamic_n - mean;
        let is_far = off_n * off_n > FAR_FORCE * FAR_FORCE * variance;
        let off = off_n / mean;
        if self.seen >= FEWEST && is_far && off.abs() > LEAST { off } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(i: usize, inverse_omega: f32, noise: f32, dynamic_n: f32) -> Evidence {
        let value = inverse_omega + noise * ((i * 7 % 5) as f32 - 2.0);
        let inverse_omega = Some((value, 2.5 * noise * noise));
        Evidence { inverse_omega, dynamic_n, same_cable: true, strained: false }
    }

    /// The estimator with its trend of the swing.
    #[derive(Clone, Copy, Debug, Default)]
    struct Block {
        mass: Mass,
        swing: FadingTrend,
    }

    impl Block {
        fn judge(&mut self, evidence: &Evidence) -> Verdict {
            self.mass.judge(&mut self.swing, evidence)
        }

        fn learn(&mut self, evidence: &Evidence) -> Option<Verdict> {
            evidence.inverse_omega.iter().for_each(|it| self.swing.add(it.0, it.1));
            self.mass.learn(evidence)
        }

        fn take(&mut self, evidence: &Evidence) -> Verdict {
            self.swing.forget();
            let verdict = self.judge(evidence);
            if verdict != Verdict::Suspect {
                self.learn(evidence);
            }
            verdict
        }
    }

    /// Swings measured to 0.006 periods, the forces going with the mass.
    fn taken<const N: usize>(swings: [f32; N]) -> (Block, [Verdict; N]) {
        let mut block = Block::default();
        let verdicts = core::array::from_fn(|i| {
            block.take(&measured(i, swings[i], 0.004, 500.0 * swings[i] * swings[i]))
        });
        (block, verdicts)
    }

    #[test]
    fn a_lighter_block_is_told_by_its_second_event() {
        let mut swings = [0.845; 30];
        swings[12..].fill(0.845 * 0.8165);
        let (block, verdicts) = taken(swings);
        assert_eq!((verdicts[12], verdicts[13]), (Verdict::Suspect, Verdict::Mass));
        assert_eq!(verdicts.iter().filter(|&&verdict| verdict == Verdict::Same).count(), 28);
        let (ratio, std) = block.mass.weight_ratio_and_std();
        assert!((ratio / 0.6667 - 1.0).abs() < 2.5 * std && std < 0.01, "{ratio} {std}");
        // Its second event is no outlier of the new weight, and begins the new mean of `Fp`.
        let second = taken::<14>(core::array::from_fn(|i| swings[i])).0;
        let (_, std) = second.mass.weight_ratio_and_std();
        assert!(
            std < 0.02 && (second.mass.dynamic_n.mean / 238.0 - 1.0).abs() < 0.01,
            "{second:?}"
        );
    }

    #[test]
    fn two_changes_multiply() {
        let mut swings = [0.9; 40];
        swings[14..].fill(0.8);
        swings[28..].fill(0.6);
        let (ratio, std) = taken(swings).0.mass.weight_ratio_and_std();
        assert!((ratio * 9.0 / 4.0 - 1.0).abs() < 2.5 * std && std < 0.01, "{ratio} {std}");
    }

    #[test]
    fn one_odd_event_changes_nothing() {
        let mut swings = [0.845; 30];
        swings[12] = 0.6;
        let in_doubt = taken::<13>(core::array::from_fn(|i| swings[i])).0;
        assert!((in_doubt.mass.before_suspect().unwrap().mean().unwrap() - 0.845).abs() < 0.003);
        let (block, verdicts) = taken(swings);
        assert_eq!((verdicts[12], verdicts[13]), (Verdict::Suspect, Verdict::Same));
        assert_eq!(block.mass.weight_ratio_and_std(), (1.0, 0.0));
        assert!((block.swing.mean().unwrap() - 0.845).abs() < 0.003);
        // A swing as before it excludes another weight in the event after it as well.
        let (mut slippery, swing) = (in_doubt, 0.845);
        assert_eq!(slippery.judge(&measured(2, swing, 0.004, 250.0)), Verdict::Same);
        assert_eq!(slippery.mass.weight_ratio_and_std(), (1.0, 0.0));
    }

    #[test]
    fn a_shortening_cable_is_no_change() {
        let (block, verdicts) =
            taken(core::array::from_fn::<f32, 200, _>(|i| 0.845 - 0.001 * i as f32));
        assert!(verdicts.iter().all(|&verdict| verdict == Verdict::Same));
        assert_eq!(block.mass.weight_ratio_and_std(), (1.0, 0.0));
    }

    #[test]
    fn forces_that_stay_contradict_another_mass() {
        let mut block = Block::default();
        let verdicts: [Verdict; 20] = core::array::from_fn(|i| {
            let inverse_omega = if i < 14 { 0.845 } else { 0.4 };
            block.take(&measured(i, inverse_omega, 0.004, 490.0))
        });
        assert!(!verdicts.contains(&Verdict::Mass) && verdicts.contains(&Verdict::Unknown));
        assert_eq!(block.mass.weight_ratio_and_std(), (1.0, 0.0));
    }

    /// The swing of each event has an error of 4 %.
    #[test]
    fn a_trial_tells_a_lighter_block_from_another_friction() {
        for (inverse_omega, expected) in [(0.69, Verdict::Mass), (0.845, Verdict::SameMass)] {
            let mut block = Block::default();
            (0..30).for_each(|i| assert_eq!(block.learn(&measured(i, 0.845, 0.02, 490.0)), None));
            assert!(block.mass.try_weight(&mut block.swing, 490.0));
            let ended = (0..60).find_map(|i| {
                let evidence = measured(i, inverse_omega, 0.02, 327.0);
                assert_eq!(block.judge(&evidence), Verdict::Suspect);
                block.learn(&evidence)
            });
            assert_eq!(ended, Some(expected));
            let (ratio, std) = block.mass.weight_ratio_and_std();
            let truth = if expected == Verdict::Mass { 0.6667 } else { 1.0 };
            assert!((ratio / truth - 1.0).abs() <= 2.5 * std && std < 0.15, "{ratio} {std}");
        }
    }

    /// `Fp` of a block that broke by an eighth is an outlier, and its swing is off by four standard
    /// deviations: its first event is enough. Without a swing the deviation of `Fp` is the
    /// uncertainty of the weight.
    #[test]
    fn forces_that_go_with_the_mass_tell_it_sooner() {
        let ratio = 0.87_f32;
        let (mut block, swing) = (Block::default(), 0.845 * ratio.sqrt());
        (0..12).for_each(|i| {
            assert_eq!(block.take(&measured(i, 0.845, 0.008, 500.0 + i as f32)), Verdict::Same)
        });
        let broken = measured(2, swing, 0.008, 500.0 * ratio);
        let held = Evidence { dynamic_n: 505.0, ..broken };
        assert_eq!({ block }.judge(&held), Verdict::Same);
        let silent = Evidence { inverse_omega: None, ..broken };
        let (mut unsure, mut suspect) = (block, block);
        assert_eq!(suspect.judge(&measured(2, 0.6, 0.004, 505.0)), Verdict::Suspect);
        assert_eq!(suspect.judge(&Evidence { dynamic_n: 505.0, ..silent }), Verdict::Same);
        assert_eq!(unsure.judge(&silent), Verdict::Same);
        assert!((unsure.mass.weight_ratio_and_std().1 - 0.14).abs() < 0.02);
        // A swing that stays the same means a change of friction.
        let slippery = Evidence { dynamic_n: 300.0, ..measured(2, 0.845, 0.008, 0.0) };
        assert_eq!(unsure.judge(&slippery), Verdict::Same);
        assert!(unsure.mass.weight_ratio_and_std().1 < 1e-6);
        assert_eq!(block.judge(&broken), Verdict::Suspect);
    }
}
