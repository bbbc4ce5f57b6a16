//! A rate that is given or said, against the time stamps.

use crate::error::InputError;

use super::rows::{Row, Rows};

/// Rows that show a rate.
const ENOUGH: usize = 32;

/// Refuses a given rate with which many samples would be taken for duplicates. Gives what to
/// say of one with which many would be missing.
///
/// # Errors
/// It is far below the rate of the stamps.
pub fn keeps_up(given: f64, head: &[Row], rows: &Rows) -> Result<Option<String>, InputError> {
    const SURELY: f64 = 1.5;
    let Ok(found) = rows.layout().timing(head, None) else { return Ok(None) };
    let found_hz = found.rate_hz;
    if found.shared.is_some() || head.len() < ENOUGH || found_hz < SURELY * given {
        let is_less = found.shared.is_none() && head.len() >= ENOUGH && SURELY * found_hz < given;
        return Ok(is_less.then(|| {
            format!(
                "the samples come {found_hz:.3} times a second, and --rate-hz says {given}: those in \
                 between count as missing; is --rate-hz right?"
            )
        }));
    }
    Err(InputError::new(format!(
        "--rate-hz says {given}, and the samples come {found_hz:.3} times a second: those in between \
         would be lost; leave --rate-hz out"
    )))
}

/// Refuses a rate in the log's metadata that its stamps contradict.
///
/// # Errors
/// Names both lines.
pub fn agrees_with_stamps(head: &[Row], rows: &Rows) -> Result<(), InputError> {
    const NEAR: f64 = 0.02;
    let metadata = &rows.metadata;
    let (Some(said), Some(line)) = (metadata.rate_hz, metadata.line("rate_hz")) else {
        return Ok(());
    };
    let Ok(found) = rows.layout().timing(head, None) else { return Ok(()) };
    let near = (found.rate_hz / said - 1.0).abs() < NEAR;
    if near || found.shared.is_some() || head.len() < ENOUGH {
        return Ok(());
    }
    let (first, found) = (head.first().map_or(0, |row| row.line), found.rate_hz);
    Err(InputError::new(format!(
        "line {line}: '# rate_hz: {said}', and the times from line {first} on come {found:.3} times \
         a second; correct one of them, or give --rate-hz R"
    )))
}
