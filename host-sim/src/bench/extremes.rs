//! Reads the largest and the smallest force of each cycle as `mu_s Mg` and `mu Mg`.

use super::cutter::{Cut, Cutter};
use super::method::{Found, Method, Sample, Setup, Tick};

/// The method.
#[derive(Clone, Copy, Debug)]
pub struct Extremes {
    setup: Setup,
    cutter: Cutter,
}

impl Method for Extremes {
    const NAME: &'static str = "max/min";

    fn new(setup: &Setup) -> Self {
        Self { setup: *setup, cutter: Cutter::new(setup) }
    }

    fn step(&mut self, sample: Sample) -> Tick {
        let cut = if self.cutter.accepts(sample) { self.cutter.step(sample) } else { None };
        let event = match cut {
            Some(Cut::Rest { peak, low }) => Some(self.read(peak, low)),
            Some(Cut::Slip) | None => None,
        };
        Tick { slips: self.cutter.slips(), event }
    }

    fn state_bytes(&self) -> usize {
        size_of::<Self>()
    }
}

impl Extremes {
    fn read(&self, peak: Sample, low: Sample) -> Found {
        let coefficient = |s: Sample| self.setup.value(s.force_n.into(), None);
        Found {
            onset_s: peak.index as f64 / self.setup.rate_hz,
            mu_s: coefficient(peak),
            mu: coefficient(low),
        }
    }
}
