//! `floe inspect`: shows how a log is recognized, before any computation.

use std::path::Path;

use clap::builder::NonEmptyStringValueParser;

use crate::error::{InputError, printable_line};
use crate::log::inspection::{Inspection, inspect};
use crate::log::{Log, LogOptions};
use crate::replay::test::TestOptions;
use crate::rounding::{counted, decimals, significant};

use super::input::{STANDARD, open};
use super::json::Json;
use super::output;

/// Show what is recognised in a log, before anything is computed
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe inspect pull.csv
  floe inspect export.txt --delimiter ';' --time-column Uhrzeit --column Kraft --unit kN")]
pub struct Args {
    /// The log: a file, or - for standard input
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    log: Option<String>,
    #[command(flatten)]
    options: LogOptions,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let (path, json) = args.json.with_log(args.log.as_deref())?;
    let name = if path == STANDARD { "standard input" } else { &path };
    let outputs: Vec<&Path> = json.file().into_iter().collect();
    let older = output::check(&outputs, &[Path::new(&path)])?;
    let options = args.options.settled_by(&TestOptions::default());
    let found = open(&path, false)
        .and_then(|input| Log::from_reader(input, &options))
        .and_then(|mut log| inspect(&path, &mut log))
        .map_err(|error| error.within(name))?;
    json.print(&found, || text(&found))?;
    older.tell();
    Ok(())
}

fn text(found: &Inspection) -> String {
    let mut lines = vec![
        ("log", printable_line(&found.path).into_owned()),
        ("format", form(found)),
        ("lines", places(found)),
        ("time", time(found)),
        ("force", format!("{}, in {}", column(found, found.force_column), found.force_unit)),
    ];
    lines.retain(|(_, text)| !text.is_empty());
    let metadata: Vec<String> = found
        .metadata
        .iter()
        .map(|said| {
            let line = said.line.map(|line| format!(" (line {line})")).unwrap_or_default();
            format!("{}: {}{line}", said.key, said.value)
        })
        .collect();
    lines.extend(metadata.into_iter().map(|text| ("says", text)));
    lines.push(("samples", samples(found)));
    if let (Some(lowest), Some(highest)) = (found.lowest, found.highest) {
        let unit = if found.force_unit == "counts" { "counts" } else { "N" };
        let spread = Some(highest - lowest).filter(|spread| *spread > 0.0);
        let decimals = decimals(spread.unwrap_or(highest));
        lines.push(("range", format!("{lowest:.decimals$} to {highest:.decimals$} {unit}")));
    }
    lines.extend(found.warnings.iter().map(|warning| ("note", warning.clone())));
    lines.iter().map(|(name, text)| format!("{name:<9}{text}\n")).collect()
}

fn form(found: &Inspection) -> String {
    let Some(delimiter) = found.delimiter else {
        return format!("{}, sectors of a logger's card", found.format);
    };
    let separator = match delimiter {
        _ if found.columns.len() == 1
            || found.time_columns.is_empty() && found.columns.is_empty() =>
        {
            "one cell a line".to_string()
        }
        '\t' => "cells between tabs".to_string(),
        ' ' => "cells between blanks".to_string(),
        other => format!("cells between '{other}'"),
    };
    let decimal = found.decimal.map(|mark| format!(", decimal mark '{mark}'")).unwrap_or_default();
    format!("{}, {separator}{decimal}", found.format)
}

fn places(found: &Inspection) -> String {
    let Some(first) = found.first_row_line else { return String::new() };
    let names = found.header_line.map_or("no header".to_string(), |n| format!("names in line {n}"));
    let units = found.units_line.map(|n| format!(", units in line {n}")).unwrap_or_default();
    format!("{names}{units}, rows from line {first} on")
}

fn time(found: &Inspection) -> String {
    let rate = significant(found.rate_hz);
    let columns: Vec<String> = found.time_columns.iter().map(|&at| column(found, at)).collect();
    let Some(unit) = found.time_unit else {
        return match columns.first() {
            Some(number) => format!("{number}, the number of the row, {rate} a second"),
            None => format!("none: rows follow each other, {rate} a second"),
        };
    };
    let start = found.start.as_ref().map(|start| format!(", from {start}")).unwrap_or_default();
    if found.samples < 2 {
        return format!("{}, {unit}; one sample, which tells no rate", columns.join(" and "));
    }
    let shared = if found.shared_stamps { ", several samples share a stamp" } else { "" };
    format!("{}, {unit}{start}; {rate} samples a second{shared}", columns.join(" and "))
}

fn column(found: &Inspection, number: usize) -> String {
    match found.columns.get(number - 1) {
        Some(name) if !name.is_empty() => format!("column {number} '{name}'"),
        _ => format!("column {number}"),
    }
}

fn samples(found: &Inspection) -> String {
    format!(
        "{} in {:.2} s, {} missing, {}, {} bad",
        found.samples,
        found.duration_s,
        found.missing,
        counted(found.duplicates, "duplicate"),
        found.bad
    )
}
