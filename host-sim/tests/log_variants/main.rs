//! One log in more than a hundred forms, as loggers, spreadsheets and people write it: recognised and
//! read like the plain one, or refused with the remedy. The table is `docs/logs.md`;
//! `FLOE_TABLE=write cargo test -p floe --test log_variants` writes it.

mod columns;
mod doubtful;
mod loggers;
mod misread;
mod people;
mod ports;
mod texts;
mod units;

use std::fmt::Write;

use floe::log::inspection::{Inspection, inspect};
use floe::log::{Log, LogOptions, Sample};
use floe_core::Reading;

/// Samples of the plain log, 16 a second.
const SAMPLES: u32 = 200;
/// Spring day on which the log with dates was recorded, seconds since 1970.
const NOON: f64 = 1_330_516_800.0;

fn seconds(i: u32) -> f64 {
    f64::from(i) / 16.0
}

fn force_n(i: u32) -> f64 {
    100.0 + f64::from(i * 37 % 101) * 4.25
}

/// A header, and a row from the time and the force of every sample.
fn table(header: &str, row: impl Fn(f64, f64) -> String) -> String {
    let rows = (0..SAMPLES).map(|i| row(seconds(i), force_n(i)) + "\n");
    header.to_string() + &rows.collect::<String>()
}

fn plain() -> String {
    table("time_s,force_n\n", |t, f| format!("{t},{f}"))
}

fn comma(value: f64) -> String {
    value.to_string().replace('.', ",")
}

/// `12:00:00.0625` at noon plus `t`.
fn clock(t: f64) -> String {
    let whole = t.floor();
    format!("12:{:02}:{:07.4}", (whole / 60.0) as u32, t - (whole / 60.0).floor() * 60.0)
}

fn iso(t: f64) -> String {
    format!("2012-02-29T{}Z", clock(t))
}

/// Expected result of a form.
enum Expected {
    /// Read like the plain log.
    Same,
    /// Read, with these words in a warning.
    Noted(&'static str),
    /// Refused with all these words.
    Refused(&'static [&'static str]),
}
use Expected::{Noted, Refused, Same};

struct Form {
    name: &'static str,
    content: Vec<u8>,
    options: LogOptions,
    expected: Expected,
}

fn form(name: &'static str, content: impl Into<Vec<u8>>, expected: Expected) -> Form {
    Form { name, content: content.into(), options: LogOptions::default(), expected }
}

impl Form {
    fn with(mut self, set: impl FnOnce(&mut LogOptions)) -> Self {
        set(&mut self.options);
        self
    }
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once('\u{FEFF}')
        .chain(text.chars())
        .collect::<String>()
        .encode_utf16()
        .flat_map(bytes)
        .collect()
}

fn toa5(units: &str) -> String {
    let head =
        format!("\"TOA5\",\"CR3000\",\"1\"\n\"TIMESTAMP\",\"Pull\"\n{units}\n\"\",\"Smp\"\n");
    table(&head, |t, f| format!("\"2012-02-29 {}\",{}", clock(t), f * 1e-3))
}

fn forms() -> Vec<Form> {
    [
        texts::text_forms(),
        texts::time_forms(),
        columns::force_forms(),
        columns::unit_forms(),
        columns::whole_forms(),
        people::dates(),
        people::cells(),
        people::names(),
        people::wholes(),
        doubtful::forces(),
        doubtful::lines(),
        doubtful::said(),
        doubtful::more(),
        misread::columns(),
        misread::metadata(),
        misread::numbers(),
        misread::lines(),
        misread::ends(),
        loggers::cells(),
        loggers::stamps(),
        loggers::above(),
        loggers::names(),
        loggers::forces(),
        loggers::times(),
        loggers::lines(),
        ports::stamps(),
        ports::first_lines(),
        units::forces(),
        units::times(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn read(form: &Form) -> Result<(Vec<Sample>, Inspection), String> {
    let open = || {
        let input = std::io::Cursor::new(form.content.clone());
        Log::from_reader(Box::new(input), &form.options).map_err(|e| e.to_string())
    };
    let found = inspect("a log", &mut open()?).map_err(|e| e.to_string())?;
    let mut log = open()?;
    let next = || log.next_sample().map_err(|e| e.to_string()).transpose();
    Ok((std::iter::from_fn(next).collect::<Result<_, String>>()?, found))
}

fn force(sample: &Sample) -> Option<f64> {
    match sample.raw.reading {
        Reading::Force(force) => Some(f64::from(force.0)),
        Reading::Counts(_) | Reading::Bad(_) => None,
    }
}

/// Difference of a form from the plain log; `None` if there is none.
fn difference(samples: &[Sample]) -> Option<String> {
    if samples.len() != SAMPLES as usize {
        return Some(format!("{} samples", samples.len()));
    }
    let start = samples[0].time_s;
    (0..SAMPLES).zip(samples).find_map(|(i, sample)| {
        let force = force(sample)?;
        let right = sample.raw.index == i
            && (sample.time_s - start - seconds(i)).abs() < 1e-4
            && (force / force_n(i) - 1.0).abs() < 1e-6;
        (!right).then(|| format!("sample {i}: {sample:?}"))
    })
}

fn recognised(found: &Inspection) -> String {
    let separator = match found.delimiter {
        None => "none".to_string(),
        Some('\t') => "tab".to_string(),
        Some(' ') => "blanks".to_string(),
        Some('|') => "bar".to_string(),
        Some(other) => format!("`{other}`"),
    };
    let time = found.time_unit.map_or("none".to_string(), |unit| {
        let columns: Vec<String> = found.time_columns.iter().map(usize::to_string).collect();
        format!("{unit} ({})", columns.join(", "))
    });
    format!(
        "{} | {separator} | {} | {time} | {} ({})",
        found.format,
        found.first_row_line.map_or("-".to_string(), |line| line.to_string()),
        found.force_unit,
        found.force_column
    )
}

/// Row of the table for a form; an error if the result is not the expected one.
fn check(form: &Form) -> Result<String, String> {
    let name = form.name;
    let wrong = |what: String| Err(format!("{name}: {what}"));
    let row = match (&form.expected, read(form)) {
        (Same | Noted(_), Err(message)) => return wrong(message),
        (Refused(_), Ok((_, found))) => return wrong(format!("is read: {found:?}")),
        (Refused(parts), Err(message)) => {
            if message.contains('\n') || !parts.iter().all(|part| message.contains(part)) {
                return wrong(format!("{parts:?} are not in: {message}"));
            }
            format!("refused | | | | | {}", message.replace('|', "\\|"))
        }
        (Same, Ok((samples, found))) => {
            let noted = found.warnings.join("; ");
            if let Some(what) = difference(&samples).or(Some(noted).filter(|n| !n.is_empty())) {
                return wrong(what);
            }
            format!("{} | the same", recognised(&found))
        }
        (Noted(words), Ok((samples, found))) => {
            let noted = found.warnings.join("; ");
            if !noted.contains(words) || samples.len() as u32 + 1 < SAMPLES {
                return wrong(format!("'{words}' is not in: {noted}"));
            }
            let counts = format!("{} missing, {} bad", found.missing, found.bad);
            let what = if noted.is_empty() { counts } else { noted };
            format!("{} | {what}", recognised(&found))
        }
    };
    Ok(format!("| {name} | {row} |\n"))
}

#[test]
fn forms_of_one_log() {
    let forms = forms();
    assert!(forms.len() >= 60, "{}", forms.len());
    let mut page = String::from(
        "| the log | format | separator | rows from line | time (column) | force (column) | result |\n\
         |---|---|---|---|---|---|---|\n",
    );
    let rows: Vec<Result<String, String>> = forms.iter().map(check).collect();
    let wrong: Vec<&String> = rows.iter().filter_map(|row| row.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    page.extend(rows.into_iter().flatten());
    let _ = writeln!(page, "\n{} forms.", forms.len());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/logs.md");
    let old = std::fs::read_to_string(path).unwrap_or_default();
    let mark = "<!-- table -->\n";
    let (text, table) = old.split_once(mark).expect("the page has a place for the table");
    if std::env::var("FLOE_TABLE").is_ok_and(|what| what == "write") {
        std::fs::write(path, format!("{text}{mark}{page}")).unwrap();
    } else {
        assert_eq!(table, page, "docs/logs.md: FLOE_TABLE=write writes it anew");
    }
}
