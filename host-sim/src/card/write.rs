//! Text forms of a test for other programs.

use std::fmt::Write;

use floe_core::{Effect, Effects};
use floe_firmware::line::{Decimal, Line};
use floe_firmware::notebook::{Kind, Track, WeightFrom, word};
use floe_firmware::record::Part;
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

use crate::log::start::Start;
use crate::log::toa5::UNDATED;
use crate::log::winch_marks;

use super::Test;
use super::text::COLUMN;

/// 2000-01-01 in seconds since 1970.
const YEAR_2000_S: f64 = 946_684_800.0;

/// CSV with all information about the test.
#[must_use]
pub fn csv(test: &Test) -> String {
    let rows = test.samples.iter().map(|s| row(&test.settings, test.part.first_index, s));
    let heads = [said(&test.lines), head(&test.part, &test.settings, &test.lines)];
    heads.into_iter().chain(rows).collect()
}

/// Comments from the board's output during the test: temperature, supply, and notes of the user.
pub(super) fn said(lines: &str) -> String {
    let (mut text, mut cold, mut supply) = (String::new(), Vec::new(), Vec::new());
    for line in lines.lines().filter_map(|line| Line::parse(line).ok()) {
        if let Line::Note(note) = line {
            let _ = writeln!(text, "# note: {note}");
        } else if let Line::Climate { temperature_c, supply_v, .. } = line {
            cold.extend(temperature_c.map(f64::from));
            supply.extend(supply_v.map(f64::from));
        }
    }
    for (key, values, decimals) in [("temperature_c", cold, 2), ("supply_v", supply, 3)] {
        if !values.is_empty() {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let _ = writeln!(text, "# {key}: {mean:.decimals$}");
        }
    }
    text
}

/// Campbell's TOA5. If the board's clock was not set, time begins on 2000-01-01, and the table's
/// name states this.
#[must_use]
pub fn toa5(test: &Test) -> String {
    let table = if test.part.start_ms.is_some() { "pull" } else { UNDATED };
    let start_s = test.part.start_ms.map_or(YEAR_2000_S, |ms| ms as f64 / 1000.0);
    let mut text = format!(
        "\"TOA5\",\"floe\",\"floe\",\"{run}\",\"1\",\"{stem}\",\"1\",\"{table}\"\n\
         \"TIMESTAMP\",\"RECORD\",\"force_n\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\",\"Smp\"\n",
        run = test.part.run,
        stem = test.stem,
    );
    for sample in &test.samples {
        let index = sample.index.wrapping_sub(test.part.first_index);
        let seconds = f64::from(index) / f64::from(test.settings.config.rate_hz);
        let stamp = stamp(start_s + seconds);
        let force = force(&test.settings, sample).unwrap_or_else(|| "\"NAN\"".into());
        let _ = writeln!(text, "\"{stamp}\",{index},{force}");
    }
    text
}

/// Comments and column names of a CSV log, including the marks of the winch in `lines`.
pub(super) fn head(part: &Part, settings: &Settings, lines: &str) -> String {
    let mut text = String::new();
    if !settings.name.is_empty() {
        let _ = writeln!(text, "# test_id: {}", settings.name);
    }
    let config = &settings.config;
    let slope_deg = f64::from(config.slope_rad).to_degrees();
    let numbers = [
        ("rate_hz", Some(config.rate_hz)),
        ("weight_n", Some(config.weight_n)),
        ("winch_m_per_s", config.winch_m_per_s),
        ("range_n", config.range_n),
        ("counts_per_n", Some(config.calibration.counts_per_n)),
    ];
    put_numbers(&mut text, &numbers);
    let _ = writeln!(text, "# slope_deg: {slope_deg}");
    let _ = writeln!(text, "# tare_counts: {}", config.calibration.tare_counts);
    if settings.effects.enabled.is_some() {
        let _ = writeln!(text, "# effects: {}", names(settings.effects.in_use()));
    }
    text += &winch_marks::comment(lines, config.rate_hz);
    put_part(&mut text, part);
    put_around(&mut text, settings);
    let _ = writeln!(text, "time_s,force_n,{COLUMN},state");
    text
}

/// Effects in the form of `--effects`.
fn names(effects: Effects) -> String {
    let names: Vec<&str> = effects.iter().map(Effect::name).collect();
    if names.is_empty() { "none".to_string() } else { names.join(",") }
}

/// Writes the identity of the recording.
fn put_part(text: &mut String, part: &Part) {
    let _ = writeln!(text, "# run: {}", part.run);
    if let Some(id) = part.id {
        let _ = writeln!(text, "# identity: {id:016x}");
    }
    if let Some(start_ms) = part.start_ms {
        let _ = writeln!(text, "# start_unix_ms: {start_ms}");
    }
    if part.number > 0 {
        let gap = part.gap.map_or("unknown".to_string(), |periods| periods.to_string());
        let _ = writeln!(text, "# part: {}", u64::from(part.number) + 1);
        let _ = writeln!(text, "# samples_lost_before: {gap}");
    }
}

/// Writes the uncertainties of the inputs, and the notes.
fn put_around(text: &mut String, settings: &Settings) {
    let Settings { stds, zero, notes, .. } = settings;
    let numbers = [
        ("weight_std_n", stds.weight_n),
        ("slope_std_deg", stds.slope_rad.map(f32::to_degrees)),
        ("zero_std_n", stds.zero_n),
        ("span_std_percent", stds.span.map(|part| 100.0 * part)),
        ("damping_std", stds.damping),
        ("winch_std_m_per_s", stds.winch_m_per_s),
        ("zero_before_n", zero.before_n),
        ("zero_after_n", zero.after_n),
        ("snow_mm", notes.snow_mm),
        ("length_m", notes.length_m),
        ("width_m", notes.width_m),
        ("height_m", notes.height_m),
        ("cable_length_m", notes.cable_length_m),
        ("cable_ae_n", notes.cable_ae_n),
    ];
    put_numbers(text, &numbers);
    let words = [
        ("weight_from", settings.weight_from.map(|it| word(WeightFrom::ALL, &it))),
        ("kind", notes.kind.map(|it| word(Kind::ALL, &it))),
        ("track", notes.track.map(|it| word(Track::ALL, &it))),
    ];
    for (key, word) in words.iter().filter_map(|&(key, word)| Some((key, word?))) {
        let _ = writeln!(text, "# {key}: {word}");
    }
}

fn put_numbers(text: &mut String, numbers: &[(&str, Option<f32>)]) {
    for (key, value) in numbers.iter().filter_map(|&(key, value)| Some((key, value?))) {
        let _ = writeln!(text, "# {key}: {}", Decimal(value));
    }
}

/// A sample as a line: time from the start of the test, force, code, and faults.
pub(super) fn row(settings: &Settings, first_index: u32, sample: &Sample) -> String {
    let index = sample.index.wrapping_sub(first_index);
    let time_s = f64::from(index) / f64::from(settings.config.rate_hz);
    let force = force(settings, sample).unwrap_or_else(|| "NaN".into());
    match sample.reading {
        Ok(code) => format!("{time_s},{force},{},ok\n", code.0),
        Err(fault) => format!("{time_s},{force},NaN,{fault}\n"),
    }
}

/// Force of a code within the converter's range, N.
fn force(settings: &Settings, sample: &Sample) -> Option<String> {
    let code = sample.reading.ok()?;
    let (lowest, highest) = settings.config.calibration.range_counts;
    let inside = lowest < code.0 && code.0 < highest;
    inside.then(|| Decimal(settings.force_n(code)).to_string())
}

/// Time with four decimals of the second, enough for sixteenths.
fn stamp(unix_s: f64) -> String {
    let second = Start { unix_s: unix_s.floor(), is_utc: false }.after(0.0).unwrap_or_default();
    let fraction = (1e4 * (unix_s - unix_s.floor())).round().min(9999.0);
    format!("{}.{fraction:04.0}", second.trim_end_matches(".000").replace('T', " "))
}
