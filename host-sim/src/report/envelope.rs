//! The whole log in a fixed number of buckets, each with its smallest and
//! largest force.

/// Largest number of buckets; a long log has at least half as many.
const CAPACITY: usize = 4096;

/// A stretch of the log.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bucket {
    /// Time of the first sample, s; NaN while there is none.
    pub start_s: f64,
    /// Smallest force, N.
    pub min_n: f32,
    /// Largest force, N.
    pub max_n: f32,
    /// Samples with a force.
    pub used: u32,
    /// Samples without a force: rejected, saturated, spikes.
    pub lost: u32,
}

impl Bucket {
    const EMPTY: Self = Self {
        start_s: f64::NAN,
        min_n: f32::INFINITY,
        max_n: f32::NEG_INFINITY,
        used: 0,
        lost: 0,
    };

    fn add(&mut self, time_s: f64, force_n: Option<f32>) {
        self.start_s = self.start_s.min(time_s); // NaN.min(t) is t
        match force_n {
            Some(force) => {
                self.min_n = self.min_n.min(force);
                self.max_n = self.max_n.max(force);
                self.used = self.used.saturating_add(1);
            }
            None => self.lost = self.lost.saturating_add(1),
        }
    }

    /// The union of two neighbouring buckets.
    pub fn merged(self, next: Self) -> Self {
        Self {
            start_s: self.start_s.min(next.start_s),
            min_n: self.min_n.min(next.min_n),
            max_n: self.max_n.max(next.max_n),
            used: self.used.saturating_add(next.used),
            lost: self.lost.saturating_add(next.lost),
        }
    }
}

/// The state before the newest force, in case it turns out to be a spike.
#[derive(Clone, Copy, Debug)]
struct Undo {
    offset: u64,
    position: usize,
    bucket: Bucket,
}

/// Smallest and largest force over time, in constant memory: when the buckets
/// are used up, neighbours merge and every bucket is twice as wide.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    buckets: Vec<Bucket>,
    width: u64,
    undo: Option<Undo>,
}

impl Envelope {
    pub fn new() -> Self {
        Self { buckets: Vec::new(), width: 1, undo: None }
    }

    /// Adds the sample `offset` periods after the first one.
    pub fn push(&mut self, offset: u64, time_s: f64, force_n: Option<f32>) {
        while offset / self.width >= CAPACITY as u64 {
            self.fold();
        }
        let position = (offset / self.width) as usize; // below CAPACITY
        if position >= self.buckets.len() {
            self.buckets.resize(position + 1, Bucket::EMPTY);
        }
        if let Some(bucket) = self.buckets.get_mut(position) {
            if force_n.is_some() {
                self.undo = Some(Undo { offset, position, bucket: *bucket });
            }
            bucket.add(time_s, force_n);
        }
    }

    /// Removes the newest force, which turned out to be a spike.
    pub fn forget(&mut self, offset: u64) {
        let Some(undo) = self.undo.take_if(|undo| undo.offset == offset) else { return };
        if let Some(bucket) = self.buckets.get_mut(undo.position) {
            let (start_s, lost) = (bucket.start_s, bucket.lost.saturating_add(1));
            *bucket = Bucket { start_s, lost, ..undo.bucket };
        }
    }

    fn fold(&mut self) {
        self.width *= 2;
        self.undo = None;
        self.buckets = self
            .buckets
            .chunks(2)
            .map(|pair| pair.iter().copied().reduce(Bucket::merged).unwrap_or(Bucket::EMPTY))
            .collect();
    }

    /// The buckets in order of time; an empty one is a gap.
    pub fn buckets(&self) -> &[Bucket] {
        &self.buckets
    }

    /// Sampling periods in a bucket.
    pub fn width(&self) -> u64 {
        self.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(samples: u64) -> Envelope {
        let mut envelope = Envelope::new();
        for i in 0..samples {
            envelope.push(i, i as f64, Some(i as f32));
        }
        envelope
    }

    #[test]
    fn buckets_double_and_keep_every_sample() {
        let samples = 3 * CAPACITY as u64 + 7;
        let envelope = filled(samples);
        assert_eq!(envelope.width(), 4);
        assert!(envelope.buckets().len() <= CAPACITY);
        let used: u64 = envelope.buckets().iter().map(|b| u64::from(b.used)).sum();
        assert_eq!(used, samples);
        let second = envelope.buckets()[1];
        assert_eq!((second.start_s, second.min_n, second.max_n), (4.0, 4.0, 7.0));
    }

    #[test]
    fn a_far_index_costs_no_memory() {
        let mut envelope = filled(10);
        envelope.push(u64::MAX, 1e18, Some(1.0));
        assert!(envelope.buckets().len() <= CAPACITY);
        assert_eq!(envelope.buckets()[0].used, 10);
    }

    #[test]
    fn a_spike_leaves_no_trace_but_a_count() {
        let mut envelope = filled(5);
        envelope.push(5, 5.0, Some(1e6));
        envelope.push(6, 6.0, None); // says nothing about the one before
        envelope.forget(5);
        let last = envelope.buckets()[5];
        assert_eq!((last.used, last.lost, last.start_s), (0, 1, 5.0));
        envelope.forget(3);
        assert_eq!(envelope.buckets()[3].used, 1, "only the newest sample can be taken back");
    }
}
