//! A raw sample, received: calibrated, counted, flagged.

use crate::pipeline::Pipeline;
use crate::sample::{ForceSample, RawSample, SampleFlag};

impl Pipeline {
    /// Calibrates, counts and flags a sample.
    pub(super) fn receive(&mut self, raw: RawSample) -> ForceSample {
        let index = raw.index;
        let mut sample = ForceSample { index, force_n: None, flag: SampleFlag::Duplicate, gap: 0 };
        if index != self.next || index > RawSample::LAST_INDEX {
            let Some(gap) = self.skip_to(index) else { return sample };
            sample.gap = gap;
        }
        self.next = index + 1;
        self.counters.samples += 1;
        match self.calibrator.force_n(raw.reading) {
            Ok(force_n) => (sample.force_n, sample.flag) = (Some(force_n), SampleFlag::Good),
            Err(flag) => {
                sample.flag = flag;
                self.refuse(index, flag);
            }
        }
        sample
    }

    /// Number of missing indices before one that is not the next; `None` for a duplicate.
    #[cold]
    #[inline(never)]
    fn skip_to(&mut self, index: u32) -> Option<u32> {
        let expected = if self.counters.samples > 0 { self.next } else { index };
        if index < expected || index > RawSample::LAST_INDEX {
            self.counters.duplicates = self.counters.duplicates.saturating_add(1);
            return None;
        }
        let missing = index - expected;
        self.counters.missing = self.counters.missing.saturating_add(missing);
        Some(missing)
    }

    /// Counts a reading that is not a force.
    fn refuse(&mut self, index: u32, flag: SampleFlag) {
        if flag == SampleFlag::Saturated {
            self.counters.saturated += 1;
            self.last_hidden = Some(self.decimator.block(index));
        } else {
            self.counters.rejected += 1;
        }
    }
}
