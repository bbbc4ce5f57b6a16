//! Decides which records belong to one recording.
//!
//! A test has a unique identity. Logs of version 1 have none; there the number of the test, its
//! first index and its settings must agree. In both, an index that steps back, or a clock that does
//! not agree with the index, begins another recording.

use std::hash::{DefaultHasher, Hash, Hasher};

use floe_firmware::record::{Part, Record};
use floe_firmware::sample::Sample;

/// Values common to all records of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    run: u32,
    id: Option<u64>,
    number: u32,
    first_index: u32,
    /// Hash of the settings, for records without an identity.
    settings: u64,
}

impl Key {
    /// Key of a record's recording.
    pub fn new(record: &Record) -> Self {
        let Part { run, id, number, first_index, .. } = record.part;
        let settings = if id.is_some() { 0 } else { hash(&format!("{:?}", record.settings)) };
        Self { run, id, number, first_index, settings }
    }
}

/// Hash for comparisons within one run of the program.
pub fn hash(content: &(impl Hash + ?Sized)) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

/// Last sample of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    index: u32,
    stamp: u32,
    /// Ticks of the clock per sampling period.
    ticks: f64,
}

/// Relation of the next samples to a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// They continue it, possibly after a gap.
    Follows,
    /// They are at or before its last index.
    StepsBack,
    /// Their clock differs, because the board was restarted in between.
    OtherClock,
}

impl Reached {
    /// Last sample of a record; `None` without samples.
    pub fn end_of(record: &Record) -> Option<Self> {
        let last = record.samples.last()?;
        let ticks = f64::from(record.clock_hz) / f64::from(record.settings.config.rate_hz);
        Some(Self { index: last.index, stamp: last.stamp, ticks })
    }

    /// Whether a sample can follow.
    pub fn next(&self, sample: &Sample) -> Next {
        /// Relative error larger than that of any oscillator.
        const DRIFT: f64 = 1e-3;
        /// Delay of a tick, in periods, larger than any within a recording.
        const PERIODS: f64 = 0.4;
        let ahead = sample.index.wrapping_sub(self.index);
        if ahead == 0 || ahead > u32::MAX / 2 {
            return Next::StepsBack;
        }
        let ahead = f64::from(ahead);
        let passed = f64::from(sample.stamp.wrapping_sub(self.stamp));
        let wrap = f64::from(u32::MAX) + 1.0;
        let off = (ahead * self.ticks - passed).rem_euclid(wrap);
        let off = off.min(wrap - off);
        let same = off <= self.ticks * (PERIODS + DRIFT * ahead);
        if same { Next::Follows } else { Next::OtherClock }
    }
}

/// Whether the samples of a record are in order.
pub fn is_in_order(record: &Record) -> bool {
    let ahead = |pair: &[Sample]| match pair {
        [a, b] => b.index.wrapping_sub(a.index).wrapping_sub(1) < u32::MAX / 2,
        _ => true,
    };
    record.samples.windows(2).all(ahead)
}
