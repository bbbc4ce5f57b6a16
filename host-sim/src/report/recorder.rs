//! Samples kept for the figures.

use floe_core::{SampleFlag, Step};

use super::clips::Clips;
use super::envelope::{Bucket, Envelope};

/// Keeps the samples for the figures, in bounded memory whatever the length of
/// the log (about 5 MB at most, 0.3 MB for an hour at 16 Hz).
///
/// The whole log is kept as smallest and largest force per bucket, and
/// stretches of it, spread evenly, at full resolution (a log of up to an hour
/// at 16 Hz completely).
#[derive(Clone, Debug)]
pub struct Recorder {
    first_index: Option<u32>,
    period_s: f64,
    pub(super) envelope: Envelope,
    pub(super) clips: Clips,
}

impl Recorder {
    /// For a log of `rate_hz` samples per second (above zero).
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        Self {
            first_index: None,
            period_s: 1.0 / rate_hz,
            envelope: Envelope::new(),
            clips: Clips::new(rate_hz),
        }
    }

    /// Takes a processed sample and its time in the log, s. To be called for every sample, in
    /// order.
    pub fn push(&mut self, time_s: f64, step: &Step) {
        let sample = &step.sample;
        let first = *self.first_index.get_or_insert(sample.index);
        let offset = |index: u32| index.checked_sub(first).map(u64::from);
        if let Some(spike) = step.spike.and_then(offset) {
            self.envelope.forget(spike);
            self.clips.forget(spike);
        }
        let Some(offset) = offset(sample.index).filter(|_| sample.flag != SampleFlag::Duplicate)
        else {
            return;
        };
        let good = sample.flag == SampleFlag::Good && time_s.is_finite();
        let force_n = sample.force_n.filter(|force| good && force.is_finite());
        self.envelope.push(offset, time_s, force_n);
        self.clips.push(offset, time_s, force_n);
    }

    /// Time between samples, s.
    pub(super) fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Time of the first sample and of the end of the last one, s.
    pub(super) fn span_s(&self) -> Option<(f64, f64)> {
        let with_time = || self.envelope.buckets().iter().filter(|b| b.start_s.is_finite());
        let (first, last) = (with_time().next()?, with_time().next_back()?);
        let samples = last.used.saturating_add(last.lost).max(1);
        Some((first.start_s, last.start_s + f64::from(samples) * self.period_s))
    }

    /// Times, s, of the buckets in which a sample is missing or has no force. The last one may be
    /// incomplete because the log ends.
    pub(super) fn lost_s(&self) -> impl Iterator<Item = f64> {
        let (buckets, width) = (self.envelope.buckets(), self.envelope.width());
        let start_s = self.span_s().map_or(0.0, |span| span.0);
        let step_s = width as f64 * self.period_s;
        let is_lost = move |i: usize, bucket: &Bucket| {
            bucket.lost > 0 || i + 1 < buckets.len() && u64::from(bucket.used) < width
        };
        let lost = buckets.iter().enumerate().filter(move |(i, bucket)| is_lost(*i, bucket));
        lost.map(move |(i, _)| start_s + i as f64 * step_s)
    }

    /// Stretches in which no bucket has a force: from and to, s.
    pub(super) fn gaps_s(&self) -> Vec<(f64, f64)> {
        let start_s = self.span_s().map_or(0.0, |span| span.0);
        let time_s = |i: usize| start_s + (i as u64 * self.envelope.width()) as f64 * self.period_s;
        let mut next = 0;
        let mut gaps = Vec::new();
        for run in self.envelope.buckets().chunk_by(|a, b| (a.used == 0) == (b.used == 0)) {
            let from = next;
            next += run.len();
            if run.iter().all(|bucket| bucket.used == 0) {
                gaps.push((time_s(from), time_s(next)));
            }
        }
        gaps
    }

    /// Smallest and largest force, N.
    pub(super) fn range_n(&self) -> Option<(f64, f64)> {
        let used = self.envelope.buckets().iter().filter(|b| b.used > 0);
        let wider = |a: (f32, f32), b: (f32, f32)| (a.0.min(b.0), a.1.max(b.1));
        let (low, high) = used.map(|b| (b.min_n, b.max_n)).reduce(wider)?;
        Some((low.into(), high.into()))
    }
}

#[cfg(test)]
mod tests {
    use floe_core::ForceSample;

    use super::*;

    fn step(index: u32, force_n: f32, flag: SampleFlag, spike: Option<u32>) -> Step {
        let sample = ForceSample { index, force_n: Some(force_n), flag, gap: 0 };
        Step { spike, ..Step::of(sample) }
    }

    #[test]
    fn only_good_samples_are_drawn() {
        let mut recorder = Recorder::new(1.0);
        recorder.push(7.0, &step(70, 1.0, SampleFlag::Good, None));
        recorder.push(8.0, &step(71, 900.0, SampleFlag::Good, None));
        recorder.push(9.0, &step(72, 2.0, SampleFlag::Good, Some(71)));
        recorder.push(9.0, &step(72, 800.0, SampleFlag::Duplicate, None));
        recorder.push(10.0, &step(73, 700.0, SampleFlag::Saturated, None));
        recorder.push(0.0, &step(3, 600.0, SampleFlag::Good, None));
        recorder.push(11.0, &step(74, f32::NAN, SampleFlag::Good, None));
        assert_eq!(recorder.range_n(), Some((1.0, 2.0)));
        assert_eq!(recorder.span_s(), Some((7.0, 12.0)));
        let lost: u32 = recorder.envelope.buckets().iter().map(|b| b.lost).sum();
        assert_eq!(lost, 3);
    }

    #[test]
    fn nothing_recorded_is_nothing() {
        let recorder = Recorder::new(16.0);
        assert_eq!((recorder.span_s(), recorder.range_n()), (None, None));
    }
}
