//! Are the samples' errors independent of each other?
//!
//! A winch that ripples, a converter with 1/f noise or a cable that swings leave
//! neighbouring samples with like errors; then many samples tell less than their
//! number. The innovations of the stick line are uncorrelated if the errors are;
//! their correlation `ρ` at a lag of one sample tells how many samples are worth one:
//! `(1 + ρ)/(1 − ρ)`, as for an autoregressive error of first order.

/// Running correlation of neighbouring innovations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Whiteness {
    last: Option<f32>,
    /// Sums of products of neighbours and of squares, of a fading past, and their number.
    products: f32,
    squares: f32,
    count: f32,
}

/// Samples over which the past is forgotten.
const MEMORY: f32 = 2000.0;
/// Standard errors beyond which a correlation counts.
const SIGNIFICANT: f32 = 4.0;
/// No correlation is believed beyond this.
const LARGEST: f32 = 0.9;

impl Whiteness {
    /// Takes the innovation of the sample after the last one, with its weight.
    pub fn add(&mut self, innovation: f32, weight: f32) {
        let innovation = weight * innovation;
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        let last = self.last.replace(innovation);
        let Some(last) = last else { return };
        self.products = FADE * self.products + last * innovation;
        self.squares = FADE * self.squares + innovation * innovation;
        self.count = FADE * self.count + weight;
    }

    /// The next sample has no neighbour before it.
    pub fn interrupt(&mut self) {
        self.last = None;
    }

    /// Samples that tell as much as one with an error of its own: one for white noise.
    #[must_use]
    pub fn inflation(&self) -> f32 {
        let sure = self.products * self.products * self.count
            > SIGNIFICANT * SIGNIFICANT * self.squares * self.squares;
        if self.products <= 0.0 || !sure {
            return 1.0;
        }
        let correlation = (self.products / self.squares).min(LARGEST);
        (1.0 + correlation) / (1.0 - correlation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inflation(correlation: f32) -> f32 {
        let (mut whiteness, mut state, mut error) = (Whiteness::default(), 1_u32, 0.0);
        for _ in 0..4000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            error = correlation * error + (state >> 8) as f32 / 16_777_216.0 - 0.5;
            whiteness.add(error, 1.0);
        }
        whiteness.inflation()
    }

    #[test]
    fn white_noise_counts_in_full_and_a_slow_error_for_less() {
        assert!((inflation(0.0) - 1.0).abs() < f32::EPSILON);
        assert!((inflation(0.8) / 9.0 - 1.0).abs() < 0.2, "{}", inflation(0.8));
        assert!((inflation(-0.5) - 1.0).abs() < f32::EPSILON);
    }

    #[test]
    fn nothing_is_believed_of_a_few_samples() {
        let mut whiteness = Whiteness::default();
        (0..10).for_each(|_| whiteness.add(1.0, 1.0));
        assert!((whiteness.inflation() - 1.0).abs() < f32::EPSILON);
    }
}
