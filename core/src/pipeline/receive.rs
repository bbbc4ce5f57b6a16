//! A raw sample, received: calibrated, counted, flagged.

use crate::pipeline::Pipeline;
use crate::sample::{ForceSample, RawSample, SampleFlag};

/// Indices beyond this one count as duplicates: no test gets there, in a billion years.
const LAST_INDEX: u64 = u64::MAX / 2;

impl Pipeline {
    /// Calibrates, counts and flags a sample.
    pub(super) fn receive(&mut self, raw: RawSample) -> ForceSample {
        let index = raw.index;
        let mut sample = ForceSample { index, force_n: None, flag: SampleFlag::Duplicate, gap: 0 };
        if index != self.next || index > LAST_INDEX {
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

    /// Indices that are missing before one that is not the next; `None` if it was there already.
    #[cold]
    #[inline(never)]
    fn skip_to(&mut self, index: u64) -> Option<u32> {
        let expected = if self.counters.samples > 0 { self.next } else { index };
        if index < expected || index > LAST_INDEX {
            self.counters.duplicates += 1;
            return None;
        }
        let missing = index - expected;
        self.counters.missing = self.counters.missing.saturating_add(missing);
        Some(u32::try_from(missing).unwrap_or(u32::MAX))
    }

    /// Counts a reading that is not a force.
    fn refuse(&mut self, index: u64, flag: SampleFlag) {
        if flag == SampleFlag::Saturated {
            self.counters.saturated += 1;
            self.last_hidden = Some(self.decimator.block(index));
        } else {
            self.counters.rejected += 1;
        }
    }
}
