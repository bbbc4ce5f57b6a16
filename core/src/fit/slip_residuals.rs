//! Residuals of one slip's samples, as the estimator of their scatter takes them
//! (`effects/scatter.rs`).

/// Squared rate of the force at the part `part` of a slip's time, relative to its largest value and
/// without the winch's own rate: `(4 x (1 − x))²`, close to `sin² πx`; zero outside the slip.
#[must_use]
pub(crate) fn steepness(part: f32) -> f32 {
    let root = 4.0 * part * (1.0 - part);
    if root > 0.0 { root * root } else { 0.0 }
}

/// Sums over the samples of one slip at its fit: `Σ g r²` in units of the noise variance, `Σ g f`,
/// and `Σ g R² g`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlipResiduals {
    pub squares: f32,
    pub free: f32,
    pub shown: f32,
    /// The swing from this slip alone.
    pub swing: OwnSwing,
}

impl SlipResiduals {
    /// Adds a sample: its steepness, its squared residual in units of the noise variance, and its
    /// remaining degree of freedom.
    pub(crate) fn add(&mut self, steepness: f32, square: f32, left: f32) {
        self.squares += steepness * square;
        self.free += steepness * left;
        self.shown += steepness * steepness * left * left;
    }

    /// Adds the squared difference of this slip's swing from the mean of those before.
    pub(crate) fn add_swings(&mut self, before: &OwnSwing) {
        // Independent part of the differences: each shares slips with the next one.
        const INDEPENDENT: f32 = 2.0 / 3.0;
        let swing = self.swing;
        let off = swing.value - before.value;
        let part = INDEPENDENT / (swing.variance + before.variance);
        self.squares += part * off * off;
        self.free += INDEPENDENT;
        self.shown += INDEPENDENT * swing.by_scatter;
    }

    /// Adds a pair of samples: the product of their steepnesses, and the part of either's error
    /// that the fit moves to the other's residual.
    pub(crate) fn add_pair(&mut self, steepness: f32, part: f32) {
        self.shown += 2.0 * steepness * part * part;
    }
}

/// The swing from the samples of one slip alone, periods; all zero where they do not determine it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OwnSwing {
    /// `1/ω`.
    pub value: f32,
    /// Its variance by the noise.
    pub variance: f32,
    /// Variance that a scatter of `λ` = 1 adds, relative to `variance`.
    pub by_scatter: f32,
}

impl OwnSwing {
    /// Is it a finite value with a variance?
    pub(crate) fn is_determined(&self) -> bool {
        self.variance > 0.0 && (self.value + self.variance + self.by_scatter).is_finite()
    }
}
