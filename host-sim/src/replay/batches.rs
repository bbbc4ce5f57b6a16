//! Reads ahead on a second thread, in batches.

use std::sync::mpsc::{SyncSender, sync_channel};

use crate::error::InputError;
use crate::log::{Log, Sample};

/// Bytes handed over at once: enough that the cost of the hand-over is negligible.
const BATCH: usize = 96 << 10;
/// Batches read ahead; bounds the memory.
const AHEAD: usize = 4;

/// Number of values in a batch.
pub const fn room<T>() -> usize {
    BATCH / size_of::<T>()
}

/// Passes every sample of a log to `take` while a second thread reads on.
///
/// # Errors
/// A line of the log cannot be used; the samples before it have been passed on.
pub fn for_each_sample(log: &mut Log, mut take: impl FnMut(Sample)) -> Result<(), InputError> {
    let take = |sample| {
        take(sample);
        Ok(())
    };
    for_each(|batch| fill(log, batch), take)
}

fn fill(log: &mut Log, batch: &mut Vec<Sample>) -> Result<(), InputError> {
    while batch.len() < room::<Sample>() {
        let Some(sample) = log.next_sample()? else { break };
        batch.push(sample);
    }
    Ok(())
}

/// Passes everything that `fill` puts into batches, the last of which has room left, to `take`,
/// while a second thread fills the next; a single batch needs no thread.
///
/// # Errors
/// Of `fill`, after what came before has been passed on; or of `take`.
pub fn for_each<T: Send, E: Send>(
    mut fill: impl FnMut(&mut Vec<T>) -> Result<(), E> + Send,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let mut first = Vec::with_capacity(room::<T>());
    let end = fill(&mut first);
    let goes_on = first.len() == room::<T>();
    first.into_iter().try_for_each(&mut take)?;
    end?;
    if !goes_on {
        return Ok(());
    }
    std::thread::scope(|scope| {
        let (sender, batches) = sync_channel::<Result<Vec<T>, E>>(AHEAD);
        scope.spawn(move || send_all(fill, &sender));
        batches.into_iter().try_for_each(|batch| batch?.into_iter().try_for_each(&mut take))
    })
}

fn send_all<T, E>(
    mut fill: impl FnMut(&mut Vec<T>) -> Result<(), E>,
    sender: &SyncSender<Result<Vec<T>, E>>,
) {
    loop {
        let mut batch = Vec::with_capacity(room::<T>());
        let end = fill(&mut batch);
        // After an error the receiver is gone and nothing is left to do.
        let goes_on = batch.len() == room::<T>() && end.is_ok();
        if sender.send(Ok(batch)).is_err() || !goes_on {
            if let Err(error) = end {
                let _ = sender.send(Err(error));
            }
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::LogOptions;

    const BATCH: usize = room::<Sample>();

    fn taken(rows: usize, tail: &str) -> (usize, Result<(), InputError>) {
        let row = |i: usize| format!("{},{i}\n", i as f64 / 16.0);
        let text = "t,force_n\n".to_string() + &(0..rows).map(row).collect::<String>() + tail;
        let input = std::io::Cursor::new(text.into_bytes());
        let mut log = Log::from_reader(Box::new(input), &LogOptions::default()).unwrap();
        let mut count = 0;
        let result = for_each_sample(&mut log, |sample| {
            assert_eq!(sample.raw.index, count as u32);
            count += 1;
        });
        (count, result)
    }

    #[test]
    fn every_sample_comes_once_and_in_order() {
        for rows in [1, BATCH - 1, BATCH, BATCH + 1, 3 * BATCH, 10 * BATCH + 7] {
            assert_eq!(taken(rows, ""), (rows, Ok(())));
        }
    }

    #[test]
    fn an_error_comes_after_the_samples_before_it() {
        for rows in [BATCH + 10, 2 * BATCH, 9 * BATCH] {
            let (count, result) = taken(rows, "oops,1\n0,0\n");
            assert_eq!(count, rows);
            let place = format!("line {}: ", rows + 2);
            assert!(result.unwrap_err().to_string().starts_with(&place));
        }
    }
}
