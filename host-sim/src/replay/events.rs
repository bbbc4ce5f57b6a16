//! The events of a log, however many: all of them in a file without a name, and as many as
//! figures need in memory.

use std::collections::VecDeque;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

use serde::ser::{Error, SerializeSeq};
use serde::{Serialize, Serializer};
use tempfile::SpooledTempFile;

use super::batches;
use super::counts::Counts;
use super::quantities::Quantities;
use super::recurrence::Recurrence;
use super::result::{CoefficientSummary, EventSummary};
use crate::log::start::Start;

/// Size, bytes, up to which the file is kept in memory.
const IN_MEMORY: usize = 1 << 20;
/// Events of a long log that are kept from its beginning and from its end.
const ENDS: usize = 256;
/// Most events that are kept in between.
const MOST: usize = 1 << 13;
/// Consecutive events of a row; rows are kept whole, since the figure of an event shows its
/// neighbours.
const ROW: usize = 8;
/// More than the bytes of an event.
const LONGEST: usize = 1024;
/// Bytes that are read back at once.
const PIECE: usize = 1 << 16;

/// Both means as they were known with an event.
pub type Means = [CoefficientSummary; 2];

/// The events in order. As a slice those that are kept: all of some 8000, of more the
/// first, the last, and rows spread evenly over those in between. Written as JSON all.
#[derive(Clone, Debug)]
pub struct Events {
    pub(crate) kept: Vec<EventSummary>,
    /// Of the last ones of a long log some are empty.
    pub(crate) means: Vec<Means>,
    last: VecDeque<(EventSummary, Means)>,
    /// Of this number of rows one is kept.
    stride: usize,
    left_out: usize,
    left_out_odd: usize,
    pub(crate) counts: Counts,
    all: Arc<Mutex<BufWriter<SpooledTempFile>>>,
    quantities: Quantities,
    pub(super) recurrence: Recurrence,
    pub(super) start: Option<Start>,
}

impl Default for Events {
    fn default() -> Self {
        Self {
            kept: Vec::new(),
            means: Vec::new(),
            last: VecDeque::new(),
            stride: 1,
            left_out: 0,
            left_out_odd: 0,
            counts: Counts::default(),
            all: Arc::new(Mutex::new(BufWriter::new(SpooledTempFile::new(IN_MEMORY)))),
            quantities: Quantities::default(),
            recurrence: Recurrence::default(),
            start: None,
        }
    }
}

impl Deref for Events {
    type Target = [EventSummary];

    fn deref(&self) -> &[EventSummary] {
        &self.kept
    }
}

impl Events {
    /// Takes the next one; `means` are asked where they are kept.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn push(&mut self, event: EventSummary, means: impl FnOnce() -> Means) -> io::Result<()> {
        let mut scratch = [0; LONGEST];
        let bytes = postcard::to_slice(&event, &mut scratch).map_err(io::Error::other)?;
        self.all.lock().unwrap_or_else(PoisonError::into_inner).write_all(bytes)?;
        self.counts.add(&event);
        self.recurrence.event(&event);
        let means = if is_wanted(&event, self.stride) { means() } else { Means::default() };
        self.last.push_back((event, means));
        if self.last.len() > ENDS {
            self.keep_oldest();
        }
        Ok(())
    }

    /// The one that is no longer among the last.
    fn keep_oldest(&mut self) {
        let Some((event, means)) = self.last.pop_front() else { return };
        if !is_wanted(&event, self.stride) {
            return self.leave_out(&event);
        }
        self.kept.push(event);
        self.means.push(means);
        if self.kept.len() > MOST {
            self.thin();
        }
    }

    fn leave_out(&mut self, event: &EventSummary) {
        self.left_out += 1;
        self.left_out_odd += usize::from(event.is_odd());
    }

    /// Every second row goes.
    fn thin(&mut self) {
        self.stride *= 2;
        let both = std::mem::take(&mut self.kept).into_iter().zip(std::mem::take(&mut self.means));
        for (event, means) in both {
            if is_wanted(&event, self.stride) {
                self.kept.push(event);
                self.means.push(means);
            } else {
                self.leave_out(&event);
            }
        }
    }

    /// Ends with the means after the last event. `quantities` complete every event with what needs
    /// the whole test.
    pub fn finish(&mut self, quantities: Quantities, last: Means) {
        let (events, means): (Vec<_>, Vec<_>) = std::mem::take(&mut self.last).into_iter().unzip();
        self.kept.extend(events);
        self.means.extend(means);
        self.means.last_mut().into_iter().for_each(|means| *means = last);
        self.quantities = quantities;
        let mut kept = std::mem::take(&mut self.kept);
        kept.iter_mut().for_each(|event| self.complete(event));
        self.kept = kept;
    }

    fn complete(&self, event: &mut EventSummary) {
        self.quantities.complete(event);
        event.onset_time = self.start.as_ref().and_then(|start| start.after(event.onset_s));
    }

    /// How many there are.
    #[must_use]
    pub fn found(&self) -> usize {
        self.kept.len() + self.left_out
    }

    /// How many of them have a remark.
    #[must_use]
    pub fn odd(&self) -> usize {
        self.kept.iter().filter(|event| event.is_odd()).count() + self.left_out_odd
    }

    /// Goes through all of them, in order.
    ///
    /// # Errors
    /// The file cannot be read, or what `take` said.
    pub fn for_each(&self, take: impl FnMut(EventSummary) -> io::Result<()>) -> io::Result<()> {
        self.for_each_with(|event| self.complete(event), take)
    }

    /// Every event as it was kept, without what needs the whole test.
    pub(super) fn for_each_as_kept(
        &self,
        take: impl FnMut(EventSummary) -> io::Result<()>,
    ) -> io::Result<()> {
        self.for_each_with(|_| {}, take)
    }

    /// Reads events and completes them, ahead of `take`.
    fn for_each_with(
        &self,
        complete: impl Fn(&mut EventSummary) + Sync,
        take: impl FnMut(EventSummary) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut all = self.all.lock().unwrap_or_else(PoisonError::into_inner);
        all.flush()?;
        let file = all.get_mut();
        file.rewind()?;
        let (mut bytes, mut left) = (Bytes::new(file), 0..self.found());
        let fill = |batch: &mut Vec<EventSummary>| {
            for _ in left.by_ref().take(batches::room::<EventSummary>()) {
                let mut event = bytes.next_event()?;
                complete(&mut event);
                batch.push(event);
            }
            Ok(())
        };
        batches::for_each(fill, take)
    }
}

/// Events out of a file, read in large pieces.
struct Bytes<R> {
    file: R,
    buffer: Vec<u8>,
    /// Number of bytes of the buffer that are used.
    used: usize,
}

impl<R: Read> Bytes<R> {
    fn new(file: R) -> Self {
        Self { file, buffer: Vec::with_capacity(LONGEST + PIECE), used: 0 }
    }

    fn next_event(&mut self) -> io::Result<EventSummary> {
        if self.buffer.len() - self.used < LONGEST {
            self.buffer.drain(..self.used);
            self.used = 0;
            self.file.by_ref().take(PIECE as u64).read_to_end(&mut self.buffer)?;
        }
        let unused = self.buffer.get(self.used..).unwrap_or_default();
        let (event, rest) = postcard::take_from_bytes(unused).map_err(io::Error::other)?;
        self.used = self.buffer.len() - rest.len();
        Ok(event)
    }
}

/// Whether an event is kept where one row of `stride` is.
fn is_wanted(event: &EventSummary, stride: usize) -> bool {
    let place = event.index as usize;
    place < ENDS || (place / ROW).is_multiple_of(stride)
}

impl Serialize for Events {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut all = serializer.serialize_seq(Some(self.found()))?;
        let mut refused = None;
        let done = self.for_each(|event| {
            all.serialize_element(&event).map_err(|error| {
                refused = Some(error);
                io::Error::other("refused")
            })
        });
        match (refused, done) {
            (Some(error), _) => Err(error),
            (None, Err(error)) => Err(S::Error::custom(error)),
            (None, Ok(())) => all.end(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::table::tests::event;

    fn events(count: u32) -> Events {
        let mut events = Events::default();
        for index in 0..count {
            events.push(EventSummary { index, ..event() }, Means::default).unwrap();
        }
        events.finish(Quantities::default(), Means::default());
        events
    }

    #[test]
    fn all_come_back_as_they_were() {
        let events = events(3 * ENDS as u32);
        let mut place = 0;
        let same = |event: EventSummary| {
            let text = |event: &EventSummary| serde_json::to_string(event).unwrap();
            assert_eq!(text(&event), text(&events[place]));
            place += 1;
            Ok(())
        };
        events.for_each(same).unwrap();
        assert_eq!((place, events.found(), events.len()), (3 * ENDS, 3 * ENDS, 3 * ENDS));
    }

    #[test]
    fn what_is_not_counted_is_counted_by_its_reason() {
        let mut events = Events::default();
        for (mu, reason) in
            [(Some(0.78), None), (None, Some("a")), (None, Some("b")), (None, Some("b"))]
        {
            let reason = reason.map(str::to_string);
            events.push(EventSummary { mu, reason, ..event() }, Means::default).unwrap();
        }
        let refused: Vec<String> = events.counts.refused().collect();
        assert_eq!(refused, ["2 not counted: b", "1 not counted: a"]);
    }

    #[test]
    fn of_many_the_ends_and_rows_in_between_are_kept() {
        let count = 5 * MOST;
        let events = events(count as u32);
        assert_eq!(events.found(), count);
        assert!((MOST / 2..=MOST + ENDS).contains(&events.len()), "{}", events.len());
        assert_eq!(events.means.len(), events.len());
        let places: Vec<usize> = events.iter().map(|event| event.index as usize).collect();
        assert!(places.is_sorted());
        assert_eq!(places[..ENDS], (0..ENDS).collect::<Vec<_>>());
        assert_eq!(places[places.len() - ENDS..], (count - ENDS..count).collect::<Vec<_>>());
        let mut all = 0;
        events
            .for_each(|event| {
                assert_eq!(event.index, all);
                all += 1;
                Ok(())
            })
            .unwrap();
        assert_eq!(all as usize, count);
    }
}
