//! Compares a given or stated rate with the time stamps.

use std::cmp::Ordering;

use crate::error::InputError;
use crate::rounding::significant;

use super::clock::Clock;
use super::metadata::Metadata;
use super::number::Decimal;
use super::rows::{Row, Rows};
use super::stamp::{DAY_S, TimeUnit};
use super::timing::{RATES_HZ, Timing, median};

/// Smallest number of rows that determine a rate.
const ENOUGH: usize = 32;
/// Largest relative difference between the nominal and the actual rate of one clock.
const NEAR: f64 = 0.02;

/// Error for an invalid rate, with the unit in which it would be valid; `unit`: that of the stamps.
#[must_use]
pub fn no_rate(rate_hz: f64, unit: TimeUnit) -> InputError {
    use TimeUnit::{Epoch, Excel, Iso, Microsecond, Millisecond, Minute, Nanosecond, Second};
    match unit {
        Millisecond | Microsecond | Nanosecond | Minute => no_rate_in(unit, rate_hz),
        Second | Iso | Epoch | Excel => no_rate_in_seconds(rate_hz),
    }
}

/// Error for times that count as seconds.
fn no_rate_in_seconds(rate_hz: f64) -> InputError {
    use TimeUnit::{Excel, Microsecond, Millisecond, Minute, Nanosecond, Second};
    let others = [Millisecond, Microsecond, Nanosecond, Minute, Excel];
    let unit = would_be(rate_hz, Second, &others).map_or_else(
        || "--time-unit, or turn it into seconds".to_string(),
        |said| format!("--time-unit; {said}"),
    );
    let is_rate = |unit_s: f64| RATES_HZ.contains(&(rate_hz / unit_s));
    let hours = Some(rate_hz / 3600.0).filter(|_| is_rate(3600.0) && !is_rate(DAY_S));
    let in_hours = hours.map_or_else(String::new, |rate_hz| {
        format!(", in hours {rate_hz:.3}: turn these into seconds")
    });
    let thin = if rate_hz > 1.0 { " then thin the log," } else { "" };
    InputError::new(format!(
        "the time stamps say {rate_hz:.6} samples per second, not 1 to 2000; is time in seconds?{thin} \
         else give {unit}{in_hours}"
    ))
}

/// Error for times in a stated unit.
fn no_rate_in(unit: TimeUnit, rate_hz: f64) -> InputError {
    use TimeUnit::{Microsecond, Millisecond, Minute, Nanosecond, Second};
    let others = [Second, Millisecond, Microsecond, Nanosecond, Minute];
    let said = would_be(rate_hz, unit, &others);
    let would_be = said.map_or_else(String::new, |said| format!("; {said}"));
    let thin = if rate_hz > 1.0 { "thin the log if that is so, else " } else { "" };
    InputError::new(format!(
        "the time stamps in {} say {rate_hz:.6} samples per second, not 1 to 2000{would_be}: {thin}correct \
         the unit where the log or --time-unit says it",
        unit.name()
    ))
}

/// The first unit in which a rate of stamps in `unit` would be valid, and that rate.
fn would_be(rate_hz: f64, unit: TimeUnit, others: &[TimeUnit]) -> Option<String> {
    // A serial date has its zero elsewhere.
    let at_s = |unit: TimeUnit, cell: &[u8]| unit.seconds(cell, Decimal::Any);
    let size_s = |unit: TimeUnit| Some(at_s(unit, b"1")? - at_s(unit, b"0")?);
    let rate_in =
        |other: &TimeUnit| Some((other.name(), rate_hz * size_s(unit)? / size_s(*other)?));
    let mut rates = others.iter().filter_map(rate_in);
    let (name, rate_hz) = rates.find(|(_, rate_hz)| RATES_HZ.contains(rate_hz))?;
    Some(format!("in {name} they would be {rate_hz:.3}"))
}

/// Rejects a given rate with which samples would count as duplicates or gaps. Returns a warning for
/// one with which many would be missing.
///
/// # Errors
/// The rate is far below that of the stamps, or close to it and contradicted by them.
pub fn keeps_up(given: f64, head: &[Row], rows: &Rows) -> Result<Option<String>, InputError> {
    const SURELY: f64 = 1.5;
    let Ok(found) = rows.layout().timing(head, None) else { return Ok(None) };
    let found_hz = found.rate_hz;
    if keeps_its_own(&found, given, head, rows)? {
        return Err(InputError::new(format!(
            "--rate-hz says {given}, and the samples come {found_hz:.4} times a second: in time some \
             would be lost, or taken for missing; leave --rate-hz out"
        )));
    }
    let groups = in_groups(&found, given, head);
    let is_fine = found.shared.is_none() && head.len() >= ENOUGH;
    let is_more = groups == Ordering::Greater || is_fine && found_hz >= SURELY * given;
    if !is_more {
        let is_less = groups == Ordering::Less || is_fine && SURELY * found_hz < given;
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

/// Warning for stamps that are skipped regularly: either they have too few digits, or samples are
/// lost.
#[must_use]
pub fn left_out(timing: &Timing) -> Option<String> {
    // The rounding of an `f64` leaves out nothing.
    const ROUNDING: f64 = 1e-9;
    let step = timing.shared?.step;
    (step < 1.0 - ROUNDING).then(|| {
        format!(
            "of the times one in {:.0} is left out, evenly: taken for the digits of {:.3} samples per \
             second; if samples are lost there, give --rate-hz {}",
            (1.0 - step).recip(),
            timing.rate_hz,
            significant(timing.rate_hz / step)
        )
    })
}

/// Compares the samples per shared stamp with a rate: more than it allows, or fewer in each stamp.
/// Fewer in some stamps are losses.
#[allow(clippy::float_cmp)] // a stamp that is repeated is repeated exactly
fn in_groups(found: &Timing, rate_hz: f64, head: &[Row]) -> Ordering {
    /// Fewest groups, since the first and last may be incomplete.
    const ENOUGH: usize = 4;
    /// Largest deviation from an integer that rounding causes.
    const ROUNDING: f64 = 0.01;
    let Some(shared) = found.shared else { return Ordering::Equal };
    let sizes = || head.chunk_by(|a, b| a.time_s == b.time_s).map(<[Row]>::len);
    let near = NEAR + 2.0 / head.len() as f64;
    if sizes().count() < ENOUGH || (found.rate_hz / rate_hz - 1.0).abs() < near {
        return Ordering::Equal;
    }
    let expected = shared.step * rate_hz / found.rate_hz;
    let is_reached = sizes().any(|size| size as f64 >= (expected - ROUNDING).ceil());
    match found.rate_hz > rate_hz {
        true => Ordering::Greater,
        false if is_reached => Ordering::Equal,
        false => Ordering::Less,
    }
}

/// Whether stamps constantly keep their own rate instead of a near one: with the near one many are
/// far from their samples, with their own fewer than half as many. A clock that was set during the
/// log does not; regularly repeated stamps do.
fn keeps_its_own(
    found: &Timing,
    near_hz: f64,
    head: &[Row],
    rows: &Rows,
) -> Result<bool, InputError> {
    /// One in this number of rows is off where drift begins to cost samples, in contrast to single
    /// late stamps; tuned: more rows let smaller drifts pass.
    const MANY: usize = 20;
    /// Largest relative difference of equal rates.
    const SAME: f64 = 1e-3;
    let is_near = (found.rate_hz / near_hz - 1.0).abs() < NEAR;
    if found.is_hardly_shared() {
        return Ok(is_near && found.rate_hz > near_hz * (1.0 + SAME));
    }
    if !is_near || found.shared.is_some() || head.len() < ENOUGH {
        return Ok(false);
    }
    let closer = |hz: f64| (hz - found.rate_hz).abs() < 0.5 * (near_hz - found.rate_hz).abs();
    if !usual_hz(head).is_some_and(closer) {
        return Ok(false);
    }
    let off = misfits(rows.layout().timing(head, Some(near_hz))?, head);
    Ok(off > (head.len() / MANY) as u64 && off > 2 * misfits(*found, head))
}

/// The median rate over blocks of rows, which excludes jumps of the clock.
fn usual_hz(head: &[Row]) -> Option<f64> {
    const ROWS: usize = 64;
    let later = head.iter().skip(ROWS);
    let spans_s = later.zip(head).map(|(last, first)| last.time_s - first.time_s);
    median(spans_s.collect()).map(|span_s| ROWS as f64 / span_s)
}

/// Number of stamps that are far from their samples.
fn misfits(timing: Timing, head: &[Row]) -> u64 {
    let mut clock = Clock::new(timing);
    for row in head {
        clock.place(row.time_s, row.records, std::iter::empty());
    }
    clock.misfits()
}

/// Rejects a rate in the log's metadata that the stamps contradict. If it is only the nominal rate,
/// returns the actual one with a note.
///
/// # Errors
/// Names both lines.
pub fn of_stamps(head: &[Row], rows: &Rows) -> Result<Option<(f64, String)>, InputError> {
    let metadata = &rows.metadata;
    let (Some(said), Some(line)) = (metadata.rate_hz, metadata.line("rate_hz")) else {
        return Ok(None);
    };
    let Ok(found) = rows.layout().timing(head, None) else { return Ok(None) };
    if keeps_its_own(&found, said, head, rows)? {
        let note = format!(
            "the samples come {:.4} times a second, and are taken so, not as '# rate_hz: {said}' in \
             line {line} says",
            found.rate_hz
        );
        return Ok(Some((found.rate_hz, note)));
    }
    let near = (found.rate_hz / said - 1.0).abs() < NEAR;
    let agree = if found.shared.is_some() {
        in_groups(&found, said, head) == Ordering::Equal
    } else {
        near || head.len() < ENOUGH
    };
    if agree {
        return Ok(None);
    }
    let (first, found) = (head.first().map_or(0, |row| row.line), found.rate_hz);
    Err(InputError::new(format!(
        "line {line}: '# rate_hz: {said}', and the times from line {first} on come {found:.3} times \
         a second; correct one of them, or give --rate-hz R"
    )))
}

/// Rejects a rate outside 1 to 2000 Hz: the given one, or else that of the log.
///
/// # Errors
/// Names the rate, and its line in the log.
pub fn refuse_rate(given: Option<f64>, metadata: &Metadata) -> Result<(), InputError> {
    let refused = given.or(metadata.rate_hz).filter(|rate| !RATES_HZ.contains(rate));
    let Some(wrong) = refused else { return Ok(()) };
    let error = InputError::new(format!("a rate of {wrong} Hz is not within 1 to 2000"));
    Err(match metadata.line("rate_hz").filter(|_| given.is_none()) {
        Some(line) => error.within(format_args!("line {line}: '# rate_hz:'")),
        None => error,
    })
}
