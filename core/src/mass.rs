//! Does the swing still tell the same mass?
//!
//! While the block slides `ω² = k / M`. The cable does not change from one event to
//! the next (the loading rate `k w` would show it), so the swing `1/ω` goes with the
//! square root of the mass: `M'/M = (ω/ω')²`, whatever the friction does. One event
//! far off is a suspect and gives no coefficient; when the next one, fitted without
//! what was known of the swing, is off as well, the mass has changed, and the weight
//! is corrected by the measured ratio. Its uncertainty is common to all later events.

use crate::fit::Prior;
use crate::shared::Shared;

/// Standard deviations by which the swing has to be off.
const FAR: f32 = 6.0;
/// A smaller change of the mass is not claimed: sag and wear change the stiffness
/// like that.
const LEAST: f32 = 0.05;
/// Events that must have told their swing before.
const FEWEST: u32 = 5;
/// Events whose swings make the ratio; later ones may have another cable length.
const MOST: u32 = 16;

/// What an event's swing says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing new.
    Same,
    /// Off, and not confirmed yet.
    Suspect,
    /// Off for the second time: since the suspect the mass has changed, or else the
    /// cable or the winch.
    Changed {
        /// It was the mass.
        mass: bool,
    },
}

/// The weight in use over the one that was given.
#[derive(Clone, Copy, Debug)]
struct Ratio {
    value: f32,
    /// Relative variance.
    variance: f32,
}

/// Weighted mean of the swings since the last change.
#[derive(Clone, Copy, Debug, Default)]
struct Since {
    count: u32,
    mean: f32,
    weight: f32,
}

impl Since {
    fn add(&mut self, value: f32, variance: f32) {
        let weight = 1.0 / variance;
        self.weight += weight;
        self.mean += weight / self.weight * (value - self.mean);
        self.count += 1;
    }
}

/// Follows the swing, and the mass with it.
#[derive(Clone, Copy, Debug)]
pub struct Mass {
    /// What the next event may expect.
    swing: Shared,
    /// The same without the suspect, while there is one.
    kept: Option<Shared>,
    /// Events that told `swing`.
    seen: u32,
    /// The weight in use over the given one, up to the last change.
    base: Ratio,
    /// The swing before the last change of mass, and the swings since.
    before: Option<Prior>,
    since: Since,
}

impl Mass {
    /// Before the first event: the weight is the given one.
    #[must_use]
    pub fn new() -> Self {
        Self {
            swing: Shared::default(),
            kept: None,
            seen: 0,
            base: Ratio { value: 1.0, variance: 0.0 },
            before: None,
            since: Since::default(),
        }
    }

    /// What the events since the last change tell of the swing.
    #[must_use]
    pub fn swing(&self) -> &Shared {
        &self.swing
    }

    /// Judges an event's own swing and its variance, periods; the cable is the same
    /// as before if the loading rate is. What fits may be learnt, see [`Mass::learn`].
    pub fn judge(&mut self, swing: f32, variance: f32, same_cable: bool) -> Verdict {
        match self.kept {
            None if self.seen >= FEWEST && is_off(swing, variance, self.swing.prior(1.0)) => {
                self.kept = Some(core::mem::take(&mut self.swing));
                Verdict::Suspect
            }
            Some(kept) if is_off(swing, variance, kept.prior(1.0)) => {
                self.change(same_cable.then(|| kept.prior(1.0)));
                Verdict::Changed { mass: same_cable }
            }
            Some(kept) => {
                (self.swing, self.kept) = (kept, None);
                Verdict::Same
            }
            None => Verdict::Same,
        }
    }

    /// Learns the swing of an event that is no suspect.
    pub fn learn(&mut self, swing: f32, variance: f32) {
        self.seen = self.seen.saturating_add(1);
        self.swing.add(swing, variance);
        if self.before.is_some() && self.since.count < MOST {
            self.since.add(swing, variance);
        }
    }

    /// The weight over the given one, and its relative standard deviation.
    #[must_use]
    pub fn weight_ratio(&self) -> (f32, f32) {
        let Ratio { value, variance } = self.ratio();
        (value, crate::math::sqrt(variance))
    }

    fn ratio(&self) -> Ratio {
        let Some(before) = self.before.filter(|_| self.since.count > 0) else { return self.base };
        let swing = self.since.mean / before.mean;
        let since = 1.0 / (self.since.weight * self.since.mean * self.since.mean);
        let variance = since + 1.0 / (before.weight * before.mean * before.mean);
        Ratio {
            value: self.base.value * swing * swing,
            variance: self.base.variance + 4.0 * variance,
        }
    }

    fn change(&mut self, before: Option<Prior>) {
        self.base = self.ratio();
        (self.before, self.kept, self.seen) = (before, None, 0);
        self.since = Since::default();
    }
}

impl Default for Mass {
    fn default() -> Self {
        Self::new()
    }
}

/// Is a swing off by more than its noise, and by more than a cable may vary?
fn is_off(swing: f32, variance: f32, expected: Prior) -> bool {
    if expected.weight <= 0.0 {
        return false;
    }
    let (off, ratio) = (swing - expected.mean, swing / expected.mean);
    off * off > FAR * FAR * (variance + 1.0 / expected.weight)
        && (ratio * ratio - 1.0).abs() > LEAST
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Swings measured to 0.006 periods.
    fn taken<const N: usize>(swings: [f32; N]) -> (Mass, [Verdict; N]) {
        let mut mass = Mass::new();
        let mut count = 0;
        let told = swings.map(|swing| {
            count += 1;
            let measured = swing + 0.004 * ((count * 7 % 5) as f32 - 2.0);
            let verdict = mass.judge(measured, 4e-5, true);
            if verdict != Verdict::Suspect {
                mass.learn(measured, 4e-5);
            }
            verdict
        });
        (mass, told)
    }

    #[test]
    fn a_lighter_block_is_told_by_its_second_event() {
        let mut swings = [0.845; 30];
        swings[12..].fill(0.845 * 0.8165);
        let (mass, told) = taken(swings);
        assert_eq!((told[12], told[13]), (Verdict::Suspect, Verdict::Changed { mass: true }));
        assert_eq!(told.iter().filter(|&&verdict| verdict == Verdict::Same).count(), 28);
        let (ratio, std) = mass.weight_ratio();
        assert!((ratio / 0.6667 - 1.0).abs() < 2.5 * std && std < 0.01, "{ratio} {std}");
    }

    #[test]
    fn two_changes_multiply() {
        let mut swings = [0.9; 40];
        swings[14..].fill(0.8);
        swings[28..].fill(0.6);
        let (ratio, std) = taken(swings).0.weight_ratio();
        assert!((ratio * 9.0 / 4.0 - 1.0).abs() < 2.5 * std && std < 0.01, "{ratio} {std}");
    }

    #[test]
    fn one_odd_event_changes_nothing() {
        let mut swings = [0.845; 30];
        swings[12] = 0.6;
        let (mass, told) = taken(swings);
        assert_eq!((told[12], told[13]), (Verdict::Suspect, Verdict::Same));
        assert_eq!(mass.weight_ratio(), (1.0, 0.0));
        assert!((mass.swing().mean().unwrap() - 0.845).abs() < 0.003);
    }

    #[test]
    fn a_shortening_cable_is_no_change() {
        let (mass, told) = taken(core::array::from_fn::<f32, 200, _>(|i| 0.845 - 0.001 * i as f32));
        assert!(told.iter().all(|&verdict| verdict == Verdict::Same));
        assert_eq!(mass.weight_ratio(), (1.0, 0.0));
    }
}
