//! How much of the stick line's past still tells its future.
//!
//! A steady winch and a taut cable make straight lines: all samples count. Ripple,
//! sag or creep bend them: only the nearest samples do. The memory is one of a
//! ladder of lengths. Beside the line in use a trial line with another memory
//! forecasts the same samples; the trial takes over when it is significantly
//! better, and makes room for the next one when it is not. Steps are taken at the
//! end of a stick line. Once all of the ladder has been tried in vain only one stick
//! line of eight has a trial.

/// Memories, sampling periods; the longest is as good as endless.
const LADDER: [f32; 7] = [4096.0, 64.0, 24.0, 10.0, 5.0, 3.0, 2.0];
/// The first of them.
const ENDLESS: usize = 0;
/// Standard errors by which a trial has to be better.
const SIGNIFICANT: f32 = 4.0;
/// Fewest and most forecasts that decide.
const FORECASTS: (u32, u32) = (24, 200);
/// A block that never slips: more forecasts would only cost the sums their digits.
const ENOUGH: u32 = 4096;

/// Factors by which the past fades with every sample.
const FADES: [f32; LADDER.len()] = {
    let mut fades = [0.0; LADDER.len()];
    let mut step = 0;
    while step < LADDER.len() {
        fades[step] = 1.0 - 1.0 / LADDER[step];
        step += 1;
    }
    fades
};
/// Stick lines to one with a trial, where none was better.
const SELDOM: u32 = 8;

/// The memory in use and the one on trial.
#[derive(Clone, Copy, Debug)]
pub struct Forgetting {
    step: usize,
    trial: usize,
    /// Sum of (squared error in use − squared error on trial), and of its squares.
    gain: f32,
    gain_squares: f32,
    count: u32,
    /// Trials in a row that were not better, and stick lines so far.
    in_vain: usize,
    lines: u32,
}

impl Forgetting {
    /// Endless, with a shorter one on trial.
    #[must_use]
    pub const fn new() -> Self {
        let (gain, gain_squares, count) = (0.0, 0.0, 0);
        Self { step: 0, trial: 1, gain, gain_squares, count, in_vain: 0, lines: 0 }
    }

    /// Factor by which past weights fade with every sample of the line in use.
    #[must_use]
    pub fn fade(&self) -> f32 {
        fade(self.step)
    }

    /// The same for the trial line.
    #[must_use]
    pub fn trial_fade(&self) -> f32 {
        fade(self.trial)
    }

    /// Does this stick line have a trial?
    #[must_use]
    pub fn has_trial(&self) -> bool {
        self.in_vain < LADDER.len() || self.lines.is_multiple_of(SELDOM)
    }

    /// Is all of the past in use?
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.step == ENDLESS
    }

    /// Takes the forecast errors of both lines for one sample, N.
    pub fn compare(&mut self, in_use_n: f32, trial_n: f32) {
        if self.count == ENOUGH {
            return;
        }
        let gain = in_use_n * in_use_n - trial_n * trial_n;
        self.gain += gain;
        self.gain_squares += gain * gain;
        self.count += 1;
    }

    /// Is the trial better beyond doubt? Endless memory need not be, only no worse: of very
    /// many trials one shorter memory wins by chance.
    #[must_use]
    pub fn has_won(&self) -> bool {
        let error = crate::num::math::rough_sqrt(self.gain_squares);
        let as_good = self.trial == ENDLESS && self.count >= FORECASTS.1 && self.gain >= 0.0;
        as_good || (self.count >= FORECASTS.0 && self.gain > SIGNIFICANT * error)
    }

    /// Decides at the end of a stick line; the lines start anew afterwards.
    pub fn decide(&mut self) {
        self.lines = self.lines.wrapping_add(1);
        if self.count < FORECASTS.0 {
            return;
        }
        let error = crate::num::math::rough_sqrt(self.gain_squares);
        if self.has_won() {
            (self.step, self.in_vain) = (self.trial, 0);
        } else if self.count < FORECASTS.1 && self.gain > self.least_gain() * error {
            // Promising: wait for more, with every line.
            self.in_vain = 0;
            return;
        } else {
            self.in_vain = self.in_vain.saturating_add(1);
        }
        self.trial = (self.trial + 1) % LADDER.len();
        if self.trial == self.step {
            self.trial = (self.trial + 1) % LADDER.len();
        }
        (self.gain, self.gain_squares, self.count) = (0.0, 0.0, 0);
    }

    /// Standard errors of gain with which a trial goes on.
    fn least_gain(&self) -> f32 {
        if self.trial == ENDLESS { -SIGNIFICANT } else { 1.0 }
    }
}

impl Default for Forgetting {
    fn default() -> Self {
        Self::new()
    }
}

fn fade(step: usize) -> f32 {
    FADES.get(step).copied().unwrap_or(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(step: usize) -> f32 {
        LADDER[step]
    }

    /// Errors as a memory of `best` periods would minimise them.
    fn settle(best: f32) -> f32 {
        let mut memory = Forgetting::new();
        for _ in 0..60 {
            let error = |length: f32| 1.0 + 0.2 * (length / best).ln().abs();
            (0..26).for_each(|_| {
                memory.compare(error(length(memory.step)), error(length(memory.trial)));
            });
            memory.decide();
        }
        length(memory.step)
    }

    #[test]
    fn settles_on_the_best_of_the_ladder() {
        for best in LADDER {
            assert!((settle(best) - best).abs() < 1e-3, "{best}");
        }
    }

    #[test]
    fn what_won_by_chance_goes_again() {
        let mut memory = Forgetting::new();
        (0..24).for_each(|_| memory.compare(2.0, 1.0));
        memory.decide();
        assert!(!memory.is_endless());
        (0..4000).for_each(|i| {
            memory.compare(1.0, if i % 2 == 0 { 1.1 } else { 0.88 });
            if i % 20 == 0 {
                memory.decide();
            }
        });
        assert!(memory.is_endless());
    }

    #[test]
    fn equal_lines_stay_as_they_are() {
        let mut memory = Forgetting::new();
        (0..1000).for_each(|i| {
            memory.compare(1.0, 1.0);
            if i % 20 == 0 {
                memory.decide();
            }
        });
        assert!(memory.is_endless());
    }
}
