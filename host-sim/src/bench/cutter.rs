//! Finds the turning points of the force, for the simple methods.
//!
//! A fall from the highest sample by more than a fraction of the usual drop is a slip; a rise from
//! the lowest sample by a smaller fraction ends it.

use super::method::{Sample, Setup};

/// Smallest fall of the first slip, as a fraction of the weight.
const FIRST_FALL: f32 = 0.03;
/// Smallest fall of a slip, as a fraction of the usual drop.
const FALL: f32 = 0.4;
/// Rise that ends a slip, as a fraction of its drop.
const RISE: f32 = 0.12;
/// Weight of the newest drop in the running mean of the drops.
const NEWEST: f32 = 0.25;

/// Result of a turning point, or of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// A slip begins.
    Slip,
    /// A slip has ended.
    Rest {
        /// Highest sample before the slip.
        peak: Sample,
        /// Lowest sample after the peak.
        low: Sample,
    },
}

/// Finds the turning points.
#[derive(Clone, Copy, Debug)]
pub struct Cutter {
    setup: Setup,
    started: bool,
    slips: bool,
    last_index: u32,
    highest: Sample,
    lowest: Sample,
    usual_drop_n: Option<f32>,
    /// Smallest fall and rise, N, if they are given.
    fixed_n: Option<(f32, f32)>,
}

impl Cutter {
    /// State before the first sample.
    #[must_use]
    pub fn new(setup: &Setup) -> Self {
        Self {
            setup: *setup,
            started: false,
            slips: false,
            last_index: 0,
            highest: Sample::default(),
            lowest: Sample::default(),
            usual_drop_n: None,
            fixed_n: None,
        }
    }

    /// State before the first sample, with the smallest fall that starts a slip and the smallest
    /// rise that ends it, N.
    #[must_use]
    pub fn with_least(setup: &Setup, fall_n: f32, rise_n: f32) -> Self {
        Self { fixed_n: Some((fall_n, rise_n)), ..Self::new(setup) }
    }

    /// Whether a slip is in progress.
    #[must_use]
    pub fn slips(&self) -> bool {
        self.slips
    }

    /// Whether a sample is usable: its index is new and its force within range.
    #[must_use]
    pub fn accepts(&self, sample: Sample) -> bool {
        (!self.started || sample.index > self.last_index) && self.setup.is_force(sample.force_n)
    }

    /// Takes an accepted sample.
    pub fn step(&mut self, sample: Sample) -> Option<Cut> {
        self.last_index = sample.index;
        if !self.started {
            (self.started, self.highest, self.lowest) = (true, sample, sample);
        }
        if self.slips { self.slip_step(sample) } else { self.rest_step(sample) }
    }

    fn least_fall_n(&self) -> f32 {
        match (self.fixed_n, self.usual_drop_n) {
            (Some((fall_n, _)), _) => fall_n,
            (None, Some(drop_n)) => FALL * drop_n,
            (None, None) => FIRST_FALL * self.setup.weight_n as f32,
        }
    }

    fn rest_step(&mut self, sample: Sample) -> Option<Cut> {
        if sample.force_n > self.highest.force_n {
            self.highest = sample;
        }
        if self.highest.force_n - sample.force_n < self.least_fall_n() {
            return None;
        }
        (self.slips, self.lowest) = (true, sample);
        Some(Cut::Slip)
    }

    fn slip_step(&mut self, sample: Sample) -> Option<Cut> {
        if sample.force_n < self.lowest.force_n {
            self.lowest = sample;
        }
        let (peak, low) = (self.highest, self.lowest);
        let drop_n = peak.force_n - low.force_n;
        let least_rise_n = self.fixed_n.map_or(0.0, |(_, rise_n)| rise_n).max(RISE * drop_n);
        if sample.force_n - low.force_n < least_rise_n {
            return None;
        }
        let usual_n = self.usual_drop_n.unwrap_or(drop_n);
        self.usual_drop_n = Some(usual_n + NEWEST * (drop_n - usual_n));
        (self.slips, self.highest) = (false, sample);
        Some(Cut::Rest { peak, low })
    }
}
