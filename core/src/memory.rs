//! How much of the stick line's past still tells its future.
//!
//! A steady winch and a taut cable make straight lines: all samples count. Ripple,
//! sag or creep bend them: only the nearest samples do. The memory is one of a
//! ladder of lengths. Beside the line in use a trial line with the next shorter or
//! longer memory forecasts the same samples, and the better one is kept. Steps are
//! taken once an event; a straight line pays nothing but the trial.

/// Memories, sampling periods; the longest is as good as endless.
const LADDER: [f32; 7] = [4096.0, 64.0, 24.0, 10.0, 5.0, 3.0, 2.0];
/// Part by which a trial has to be better.
const MARGIN: f32 = 0.03;
/// Fewest forecasts that decide.
const FEWEST: f32 = 24.0;

/// The memory in use and the one on trial.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    step: usize,
    /// The trial is the shorter one.
    shorter: bool,
    /// Sums of squared forecast errors: in use, on trial.
    squares: (f32, f32),
    count: f32,
}

impl Memory {
    /// Endless, with a shorter one on trial.
    #[must_use]
    pub const fn new() -> Self {
        Self { step: 0, shorter: true, squares: (0.0, 0.0), count: 0.0 }
    }

    /// Factor by which past weights fade with every sample of the line in use.
    #[must_use]
    pub fn fade(&self) -> f32 {
        1.0 - 1.0 / length(self.step)
    }

    /// The same for the trial line.
    #[must_use]
    pub fn trial_fade(&self) -> f32 {
        1.0 - 1.0 / length(self.trial())
    }

    /// Is all of the past in use?
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.step == 0
    }

    /// Takes the forecast errors of both lines for one sample, N.
    pub fn compare(&mut self, in_use: f32, trial: f32) {
        self.squares.0 += in_use * in_use;
        self.squares.1 += trial * trial;
        self.count += 1.0;
    }

    /// Decides at the end of a stick line; the lines start anew afterwards.
    pub fn decide(&mut self) {
        if self.count < FEWEST {
            return;
        }
        if self.squares.1 < (1.0 - MARGIN) * self.squares.0 {
            self.step = self.trial();
        } else if self.count < 4.0 * FEWEST {
            // Not decided yet: go on with the same trial.
            return;
        } else {
            self.shorter = !self.shorter;
        }
        self.shorter = (self.shorter || self.step == 0) && self.step + 1 < LADDER.len();
        (self.squares, self.count) = ((0.0, 0.0), 0.0);
    }

    fn trial(&self) -> usize {
        if self.shorter { self.step + 1 } else { self.step.saturating_sub(1) }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

fn length(step: usize) -> f32 {
    LADDER.get(step).copied().unwrap_or(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors as a memory of `best` periods would minimise them.
    fn settle(best: f32) -> f32 {
        let mut memory = Memory::new();
        for _ in 0..60 {
            let error = |length: f32| 1.0 + 0.2 * (length / best).ln().abs();
            (0..26).for_each(|_| {
                memory.compare(error(length(memory.step)), error(length(memory.trial())))
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
    fn equal_lines_stay_as_they_are() {
        let mut memory = Memory::new();
        (0..1000).for_each(|i| {
            memory.compare(1.0, 1.0);
            if i % 20 == 0 {
                memory.decide();
            }
        });
        assert!(memory.is_endless());
    }
}
