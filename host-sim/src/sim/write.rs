//! Simulated logs as files: CSV, and the mixed arrays of a Campbell CR10.

use std::io::{self, Write};

use time::{Date, Duration};

use crate::error::printable_line;
use crate::rounding::trimmed;

use super::decimal::{Backwards, Fixed};
use super::run::Sample;
use super::scene::{Scene, Start};

/// Array ID of the simulated CR10 logs.
pub const CR10_ARRAY_ID: u32 = 101;

/// First line of a simulated CSV log up to its colon.
pub const SYNTHETIC: &str = "# SYNTHETIC:";

/// The remark of a simulator on its results, in a log and in JSON.
#[must_use]
pub fn said_of(seed: u64) -> String {
    format!("computed, not measured; seed {seed}")
}

/// Writes the head of a CSV log: metadata and column names.
///
/// `command`: the command that generates the log.
///
/// # Errors
/// Errors of the writer.
pub fn csv_head(out: &mut impl Write, scene: &Scene, seed: u64, command: &str) -> io::Result<()> {
    writeln!(out, "{SYNTHETIC} {}", said_of(seed))?;
    writeln!(out, "# made_by: {}", printable_line(command))?;
    if let Some(id) = &scene.test_id {
        writeln!(out, "# test_id: {id}")?;
    }
    writeln!(out, "# rate_hz: {}", scene.rate_hz)?;
    writeln!(out, "# weight_n: {}", scene.weight_n)?;
    writeln!(out, "# slope_deg: {}", scene.slope_deg)?;
    writeln!(out, "# winch_m_per_s: {}", scene.winch_m_per_s)?;
    writeln!(out, "# cable_length_m: {}", scene.cable_length_m)?;
    if let Some(snow) = &scene.snow {
        writeln!(out, "# snow_mm: {}", snow.depth_mm)?;
    }
    if scene.measurement.range_n > 0.0 {
        // The range above the dead load.
        writeln!(out, "# range_n: {}", scene.measurement.range_n - scene.measurement.tare_n)?;
    }
    writeln!(out, "time_s,force_n")
}

/// Decimals of the forces in a CSV log: a resolution of a millionth of the weight or finer.
#[must_use]
pub fn force_decimals(scene: &Scene) -> usize {
    (6.0 - scene.weight_n.log10()).ceil().clamp(0.0, 12.0) as usize
}

/// Writes one sample as a CSV line, the force with `force_decimals` decimals, the time to a
/// microsecond.
///
/// # Errors
/// Errors of the writer.
pub fn csv_line(out: &mut impl Write, force_decimals: usize, sample: &Sample) -> io::Result<()> {
    let Sample { time_s, force_n, .. } = *sample;
    let Some((time, force)) = Fixed::new(time_s, 6).zip(Fixed::new(force_n, force_decimals)) else {
        let time = format!("{time_s:.6}");
        return writeln!(out, "{},{force_n:.force_decimals$}", trimmed(&time));
    };
    let mut line = Backwards::new();
    line.push(b'\n');
    line.push_fixed(force);
    line.push(b',');
    line.push_fixed(time.trimmed());
    out.write_all(line.bytes())
}

/// Writes one sample as a mixed array: ID, year, day of the year, hhmm, seconds in steps of 0.125
/// s, force in N with five digits.
///
/// # Errors
/// Errors of the writer.
pub fn cr10_line(out: &mut impl Write, start: Start, sample: &Sample) -> io::Result<()> {
    let eighths = (sample.time_s * 8.0 + 1e-6).floor() as u64;
    let minutes = eighths / 480 + u64::from(start.hour * 60 + start.minute);
    let (year, day) = calendar(start, minutes / 1440);
    let hhmm = minutes / 60 % 24 * 100 + minutes % 60;
    let seconds = format!("{:.3}", (eighths % 480) as f64 / 8.0);
    writeln!(
        out,
        "{CR10_ARRAY_ID},{year},{day},{hhmm},{},{}",
        cr10_number(&seconds),
        cr10_number(&five_digits(sample.force_n)),
    )
}

/// Year and day of the year, `days` after the start, which the scene's check has found to be a date.
fn calendar(start: Start, days: u64) -> (i32, u16) {
    let first = Date::from_ordinal_date(start.year, start.day as u16).unwrap_or(Date::MIN);
    first.saturating_add(Duration::days(days as i64)).to_ordinal_date()
}

/// A value in the CR10's high resolution: five digits, at most 99999.
fn five_digits(value: f64) -> String {
    let value = value.clamp(-99_999.0, 99_999.0);
    let decimals = (0..=4_usize)
        .rev()
        .find(|&d| (value.abs() * 10_f64.powi(d as i32)).round() < 100_000.0)
        .unwrap_or(0);
    format!("{value:.decimals$}")
}

/// A number in the form of the CR10: no zero before the point, none at the end.
fn cr10_number(text: &str) -> String {
    let text = trimmed(text);
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", text),
    };
    match digits.strip_prefix("0.") {
        Some(fraction) => format!("{sign}.{fraction}"),
        None if digits == "0" => "0".to_owned(),
        None => text.to_owned(),
    }
}
