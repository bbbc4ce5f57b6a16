//! A table of logs and of what they do not say themselves: `tests.csv`.
//!
//! ```text
//! file,array_id,column,weight_n,slope_deg,snow_mm,kind,test_id
//! day3.dat,118,5,630,0,10,sliding,DFF8-13
//! ```
//!
//! The first line names the columns, in any order; `file` is needed, the rest where it is
//! known. What the table says stands before what the log says.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde::Deserialize;

use crate::error::{InputError, excerpt};
use crate::log::{LogOptions, Unit};
use crate::replay::test::TestOptions;

/// Name of the table in a directory of logs.
pub const NAME: &str = "tests.csv";

/// A log and what is known beside it.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// The log.
    pub path: PathBuf,
    /// Where its forces are.
    pub log: LogOptions,
    /// What was pulled.
    pub test: TestOptions,
    /// The notebook.
    pub notes: Notes,
}

/// What is written down of a test and not computed with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes {
    /// Name of the test.
    pub test_id: Option<String>,
    /// Take-up speed of the winch, m/s.
    pub winch_m_per_s: Option<f64>,
    /// Depth of the snow, mm.
    pub snow_mm: Option<f64>,
    /// `sliding`, `rafting` or `over-riding`.
    pub kind: Option<String>,
    /// `fresh` or `repeated`.
    pub track: Option<String>,
    /// Length of the cable, m.
    pub cable_length_m: Option<f64>,
}

/// A line of the table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    file: String,
    array_id: Option<u32>,
    column: Option<String>,
    unit: Option<String>,
    weight_n: Option<f64>,
    mass_kg: Option<f64>,
    slope_deg: Option<f64>,
    winch_m_per_s: Option<f64>,
    snow_mm: Option<f64>,
    kind: Option<String>,
    track: Option<String>,
    cable_length_m: Option<f64>,
    test_id: Option<String>,
}

/// Whether a text begins as such a table does.
#[must_use]
pub fn is_manifest(text: &str) -> bool {
    let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#'));
    first.is_some_and(|line| line.split(',').any(|name| name.trim() == "file"))
}

/// Reads a table; the files lie beside it.
///
/// # Errors
/// A line that cannot be read, with its number.
pub fn read(text: &str, folder: &Path) -> Result<Vec<Entry>, InputError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut entries = Vec::new();
    for row in reader.deserialize::<Row>() {
        let row = row.map_err(|error| {
            let line = error.position().map_or(1, csv::Position::line);
            InputError::new(format!("line {line}: {}", error_text(&error)))
        })?;
        entries.push(row.entry(folder)?);
    }
    Ok(entries)
}

/// Without the place, which is said already.
fn error_text(error: &csv::Error) -> String {
    if let csv::ErrorKind::Deserialize { err, .. } = error.kind() {
        err.to_string()
    } else {
        error.to_string()
    }
}

impl Row {
    fn entry(self, folder: &Path) -> Result<Entry, InputError> {
        let unit = self.unit.as_deref().map(|unit| {
            let known = Unit::from_str(unit, true);
            known.map_err(|_| InputError::new(format!("no unit: {}", excerpt(unit.as_bytes()))))
        });
        Ok(Entry {
            path: folder.join(&self.file),
            log: LogOptions {
                array_id: self.array_id,
                column: self.column,
                unit: unit.transpose()?,
                ..LogOptions::default()
            },
            test: TestOptions {
                weight_n: self.weight_n,
                mass_kg: self.mass_kg,
                slope_deg: self.slope_deg,
                ..TestOptions::default()
            },
            notes: Notes {
                test_id: self.test_id,
                winch_m_per_s: self.winch_m_per_s,
                snow_mm: self.snow_mm,
                kind: self.kind,
                track: self.track,
                cable_length_m: self.cable_length_m,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read() {
        let text = "# day 3\nfile, array_id,column,weight_n,slope_deg,snow_mm,kind\n\
                    old.dat,118,5,630,2,10,rafting\nnew.csv,,,,,,\n";
        assert!(is_manifest(text));
        let entries = read(text, Path::new("logs")).unwrap();
        assert_eq!(entries[0].path, Path::new("logs/old.dat"));
        assert_eq!((entries[0].log.array_id, entries[0].test.weight_n), (Some(118), Some(630.0)));
        assert_eq!(entries[0].notes.kind.as_deref(), Some("rafting"));
        assert_eq!((entries[1].test.weight_n, &entries[1].notes), (None, &Notes::default()));
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        let said = |text: &str| read(text, Path::new(".")).unwrap_err().to_string();
        assert!(said("file,weight_n\na.csv,heavy\n").contains("line 2"));
        assert!(said("file,weigth_n\na.csv,630\n").contains("weigth_n"));
        assert!(said("file,unit\na.csv,stone\n").contains("stone"));
        assert!(!is_manifest("a.csv\nb.csv\n") && !is_manifest("time_s,force_n\n"));
    }
}
