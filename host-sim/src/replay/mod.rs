//! A recorded log through the core: `floe replay`.

use floe_core::signal::calibrate::Calibrator;
use floe_core::{Config, Event, Pipeline, Step};

use crate::error::InputError;
use crate::log::{Log, Sample};

pub mod abridged;
pub mod batches;
pub mod budget;
pub mod check;
pub mod counts;
pub mod doubts;
pub mod event_rows;
pub mod events;
mod gathered;
pub mod given;
pub mod held;
pub mod input;
pub mod known;
mod level;
pub mod quantities;
pub mod rails;
mod recurrence;
pub mod result;
pub mod samples;
mod slide;
pub mod stretches;
pub mod table;
pub mod test;
pub mod timeline;
mod unsaid_zero;

use gathered::Gathered;
use result::ReplayResult;
use test::Around;

/// Runs a whole log through the core; a long one is read on a second thread, in constant memory.
///
/// `path` is only named in the result. `observe` sees every sample's time, in the
/// log's own seconds, and what the core made of it.
///
/// # Errors
/// A line of the log that cannot be used.
pub fn replay(
    path: &str,
    log: &mut Log,
    config: &Config,
    observe: impl FnMut(f64, &Step),
) -> Result<ReplayResult, InputError> {
    let around = Around { keeps_means: true, ..Around::default() };
    replay_with(path, log, config, around, observe)
}

/// The same with what the caller says beside the configuration. A zero of the load cell to
/// take off needs the whole log in memory.
///
/// # Errors
/// A line of the log that cannot be used.
pub fn replay_with(
    path: &str,
    log: &mut Log,
    config: &Config,
    around: Around,
    mut observe: impl FnMut(f64, &Step),
) -> Result<ReplayResult, InputError> {
    let Around { known, keeps_means } = around;
    let zero = known.zero(log);
    // A zero is taken off what is within the range, which is that of the cell.
    let range_n = config.range_n.filter(|_| zero.is_nothing());
    let pipeline = Pipeline::new(&Config { range_n, ..*config }).map_err(InputError::new)?;
    let mut gathered = Gathered::new(config, pipeline, log, keeps_means);
    let mut take = |sample: Sample, read_n| {
        gathered.take(sample, read_n, |step| observe(sample.time_s, step));
    };
    if zero.is_nothing() {
        batches::for_each_sample(log, |sample| take(sample, None))?;
    } else {
        let mut samples = Vec::new();
        batches::for_each_sample(log, |sample| samples.push(sample))?;
        let calibrator = Calibrator::new(config);
        let read = |sample: &Sample| calibrator.force_n(sample.raw.reading).ok();
        let read_n: Vec<Option<f32>> = samples.iter().map(read).collect();
        zero.take_off(&mut samples, config);
        samples.into_iter().zip(read_n).for_each(|(sample, read_n)| take(sample, read_n));
    }
    gathered.result(path, log, &known)
}

/// A new event without the losses of the cable. The whole test determines them; they are added at the
/// end, with [`floe_core::Losses::put_on`].
#[must_use]
pub fn without_losses(pipeline: &Pipeline, event: Event) -> Event {
    let [mu_s, mu] = pipeline.losses().taken_off([event.mu_s, event.mu]);
    Event { mu_s, mu, ..event }
}
