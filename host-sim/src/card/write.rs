//! A test as the text of other programs.

use std::fmt::Write;

use floe_firmware::line::Decimal;
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

use super::Test;
use super::text::COLUMN;

/// CSV with everything that is known about the test.
#[must_use]
pub fn csv(test: &Test) -> String {
    let rows = test.samples.iter().map(|s| row(&test.settings, test.first_index, s));
    std::iter::once(head(&test.settings)).chain(rows).collect()
}

/// Campbell's TOA5. The board has no calendar: time begins on 2000-01-01.
#[must_use]
pub fn toa5(test: &Test) -> String {
    let mut text = format!(
        "\"TOA5\",\"floe\",\"floe\",\"{run}\",\"1\",\"{stem}\",\"1\",\"pull\"\n\
         \"TIMESTAMP\",\"RECORD\",\"force_n\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\",\"Smp\"\n",
        run = test.run,
        stem = test.stem(),
    );
    for sample in &test.samples {
        let index = sample.index.wrapping_sub(test.first_index);
        let stamp = stamp(f64::from(index) / f64::from(test.settings.config.rate_hz));
        let force = force(&test.settings, sample).unwrap_or_else(|| "\"NAN\"".into());
        let _ = writeln!(text, "\"{stamp}\",{index},{force}");
    }
    text
}

/// What the board said during the test.
#[must_use]
pub fn lines(test: &Test) -> &str {
    &test.lines
}

/// Comments and column names of a CSV log.
pub(super) fn head(settings: &Settings) -> String {
    let config = &settings.config;
    let mut text = String::new();
    if !settings.name.is_empty() {
        let _ = writeln!(text, "# test_id: {}", settings.name);
    }
    let slope_deg = f64::from(config.slope_rad).to_degrees();
    let numbers = [
        ("rate_hz", Some(config.rate_hz)),
        ("weight_n", Some(config.weight_n)),
        ("winch_m_per_s", config.winch_m_per_s),
        ("range_n", config.range_n),
        ("counts_per_n", Some(config.calibration.counts_per_n)),
    ];
    for (key, value) in numbers {
        if let Some(value) = value {
            let _ = writeln!(text, "# {key}: {}", Decimal(value));
        }
    }
    let _ = writeln!(text, "# slope_deg: {slope_deg}");
    let _ = writeln!(text, "# tare_counts: {}", config.calibration.tare_counts);
    let _ = writeln!(text, "time_s,force_n,{COLUMN},state");
    text
}

/// A sample as a line: its time from the start of the test, force, code, and what
/// is wrong with it.
pub(super) fn row(settings: &Settings, first_index: u32, sample: &Sample) -> String {
    let index = sample.index.wrapping_sub(first_index);
    let time_s = f64::from(index) / f64::from(settings.config.rate_hz);
    let force = force(settings, sample).unwrap_or_else(|| "NaN".into());
    match sample.reading {
        Ok(code) => format!("{time_s},{force},{},ok\n", code.0),
        Err(fault) => format!("{time_s},{force},NaN,{fault}\n"),
    }
}

/// Force of a code inside the converter's range, N.
fn force(settings: &Settings, sample: &Sample) -> Option<String> {
    let code = sample.reading.ok()?;
    let (lowest, highest) = settings.config.calibration.range_counts;
    let inside = lowest < code.0 && code.0 < highest;
    inside.then(|| Decimal(settings.force_n(code)).to_string())
}

fn stamp(seconds: f64) -> String {
    let (day, rest) = ((seconds / 86_400.0) as u32, seconds % 86_400.0);
    let (hour, rest) = ((rest / 3600.0) as u32, rest % 3600.0);
    let (minute, second) = ((rest / 60.0) as u32, rest % 60.0);
    format!("2000-01-{:02} {hour:02}:{minute:02}:{second:07.4}", day + 1)
}
