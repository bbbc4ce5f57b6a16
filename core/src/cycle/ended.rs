//! The end of a stick line, by a slip or a long gap.

use crate::cycle::slip_record::SeenSlip;
use crate::detector::{Detector, Stick};
use crate::sample::ForcePoint;

/// The end of a stick line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub(super) stick: Stick,
    pub(super) by: By,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum By {
    Slip(SeenSlip),
    /// A gap or the end of the test, at an index.
    Loss(u32),
}

impl Ended {
    /// Ended by a slip with this highest and lowest sample; `last_hidden` is the newest saturated
    /// index.
    pub(super) fn by_slip(
        detector: &Detector,
        (peak, low): (ForcePoint, ForcePoint),
        last_hidden: Option<u32>,
    ) -> Self {
        let (last, rest_weight) = (detector.last.index, detector.rest_weight());
        let by = By::Slip(SeenSlip { peak, low, last, rest_weight, last_hidden });
        Self { stick: detector.ended, by }
    }

    /// Ended by a gap, or by the end of the test, at an index.
    pub(super) fn by_loss(stick: &Stick, index: u32) -> Self {
        Self { stick: *stick, by: By::Loss(index) }
    }

    /// Index of the highest sample before the slip, or of the loss.
    pub(super) fn end(&self) -> u32 {
        match self.by {
            By::Slip(SeenSlip { peak, .. }) => peak.index,
            By::Loss(index) => index,
        }
    }
}
