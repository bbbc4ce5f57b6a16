//! The table `tests.csv`: logs, and information that the logs do not contain.
//!
//! ```text
//! file,array_id,column,weight_n,slope_deg,snow_mm,kind,test_id
//! day3.dat,118,5,630,0,10,sliding,DFF8-13
//! ```
//!
//! The first line names the columns in any order; only `file` is required. Values of the table take
//! precedence over those of the log. The table may come from a spreadsheet: with semicolons or
//! tabs, and decimal commas.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use floe_core::Config;

use crate::error::{InputError, excerpt};
use crate::log::cells::{Cells, texts};
use crate::log::layout::is_empty;
use crate::log::{LogOptions, Unit, sense};
use crate::replay::test::TestOptions;
use crate::rounding::counted;

/// Name of the table in a directory of logs.
pub const NAME: &str = "tests.csv";

/// A log and the information about it in the table.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    /// The log.
    pub path: PathBuf,
    /// Position and format of the forces in the log.
    pub log: LogOptions,
    /// Properties of the test.
    pub test: TestOptions,
    /// Notes on the test.
    pub notes: Notes,
    /// Line of the table or list with the log; 0 for a log found in a directory.
    pub line: u64,
}

/// Notes on a test that do not enter the computation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes {
    /// Name of the test.
    pub test_id: Option<String>,
    /// Depth of the snow, mm.
    pub snow_mm: Option<f64>,
    /// `sliding`, `rafting` or `over-riding`.
    pub kind: Option<String>,
    /// `fresh` or `repeated`.
    pub track: Option<String>,
    /// Length of the cable, m.
    pub cable_length_m: Option<f64>,
}

/// Known columns.
pub(super) const COLUMNS: [&str; 13] = [
    "file",
    "array_id",
    "column",
    "unit",
    "weight_n",
    "mass_kg",
    "slope_deg",
    "winch_m_per_s",
    "snow_mm",
    "kind",
    "track",
    "cable_length_m",
    "test_id",
];

/// Possible separators of the cells.
const SEPARATORS: [u8; 3] = *b",;\t";

/// Whether a text begins like such a table.
#[must_use]
pub fn is_manifest(text: &str) -> bool {
    Head::find(text).is_some()
}

/// Reads a table; paths are relative to its folder.
///
/// # Errors
/// A line that cannot be read, with its number.
pub fn read(text: &str, folder: &Path) -> Result<Vec<Entry>, InputError> {
    let head = Head::find(text).ok_or_else(|| {
        let line = rows(text).next().map_or(1, |(line, _)| line);
        at(line, &format!("no column is called 'file'; {}", there_are()))
    })?;
    head.check().map_err(|why| at(head.line, &why))?;
    let rows = rows(text).filter(|(_, row)| !is_empty(row.as_bytes(), head.separator)).skip(1);
    rows.map(|(line, row)| head.entry(line, row, folder).map_err(|why| at(line, &why))).collect()
}

fn at(line: u64, why: &str) -> InputError {
    InputError::new(why).within(format_args!("line {line}"))
}

fn there_are() -> String {
    format!("there are: {}", COLUMNS.join(", "))
}

/// Lines with their numbers, without comments, empty lines and a spreadsheet's `sep=;`.
fn rows(text: &str) -> impl Iterator<Item = (u64, &str)> {
    let says =
        |row: &str| !row.trim().is_empty() && !row.starts_with('#') && !row.starts_with("sep=");
    (1..).zip(text.lines()).filter(move |(_, row)| says(row))
}

/// The line that names the columns.
struct Head {
    line: u64,
    separator: u8,
    names: Vec<String>,
}

impl Head {
    /// The first row, cut by the separator that gives a column of files.
    fn find(text: &str) -> Option<Self> {
        let (line, row) = rows(text).next()?;
        SEPARATORS.into_iter().find_map(|separator| {
            let names = texts(row.as_bytes(), separator).into_iter();
            let names: Vec<String> = names.map(|name| name.to_ascii_lowercase()).collect();
            names.iter().any(|name| name == "file").then_some(Self { line, separator, names })
        })
    }

    /// Rejects unknown and repeated names.
    fn check(&self) -> Result<(), String> {
        for (place, name) in self.names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            let said = excerpt(name.as_bytes());
            if !COLUMNS.contains(&name.as_str()) {
                return Err(format!("no column is called {said}; {}", there_are()));
            }
            if self.names.iter().take(place).any(|before| before == name) {
                return Err(format!("two columns are called {said}: leave one out"));
            }
        }
        Ok(())
    }

    fn entry(&self, line: u64, row: &str, folder: &Path) -> Result<Entry, String> {
        let (row, mut cells) = (row.as_bytes(), Cells::default());
        if !cells.cut(row, self.separator) {
            return Err("a quote is not closed; write each test into one line".to_string());
        }
        let (there, expected) = (cells.len(), self.names.len());
        if there != expected {
            let there = counted(there as u64, "cell");
            return Err(format!("{there} instead of {expected}: leave empty what is not known"));
        }
        let mut entry = Entry { line, ..Entry::default() };
        for (place, name) in self.names.iter().enumerate() {
            let cell = cells.text(row, place);
            if cell.is_empty() {
                continue;
            }
            if name.is_empty() {
                let (cell, place) = (excerpt(cell.as_bytes()), place + 1);
                return Err(format!("{cell} in cell {place} stands below no name: take it out"));
            }
            entry.set(name, &cell, folder).map_err(|why| format!("'{name}' {why}"))?;
        }
        entry.check().map(|()| entry)
    }
}

impl Entry {
    /// Stores a cell.
    fn set(&mut self, name: &str, cell: &str, folder: &Path) -> Result<(), String> {
        let (log, test, notes) = (&mut self.log, &mut self.test, &mut self.notes);
        let wants = |what: &str| format!("has {}: write {what}", excerpt(cell.as_bytes()));
        let text = || Some(cell.to_string());
        let number = || sense::number(name, cell).map(Some);
        let word = || sense::word(name, cell).map(Some);
        match name {
            "file" => self.path = folder.join(cell),
            "array_id" => {
                log.array_id = Some(cell.parse().map_err(|_| wants("the array's number"))?);
            }
            "column" => log.column = text(),
            "unit" => {
                let unit = Unit::from_str(cell, true);
                log.unit = Some(unit.map_err(|_| wants("N, kN, lbf, kgf or counts"))?);
            }
            "test_id" => notes.test_id = text(),
            "kind" => notes.kind = word()?,
            "track" => notes.track = word()?,
            "weight_n" => test.weight_n = number()?,
            "mass_kg" => test.mass_kg = number()?,
            "slope_deg" => test.slope_deg = number()?,
            "winch_m_per_s" => test.winch_m_per_s = number()?,
            "snow_mm" => notes.snow_mm = number()?,
            "cable_length_m" => notes.cable_length_m = number()?,
            _ => return Err(format!("is no column; {}", there_are())),
        }
        Ok(())
    }

    /// Rejects values that the core would reject, and contradictions.
    fn check(&self) -> Result<(), String> {
        let steepest_deg = f64::from(Config::STEEPEST_RAD).to_degrees().floor();
        let TestOptions { weight_n, mass_kg, slope_deg, winch_m_per_s, .. } = self.test;
        if self.path.as_os_str().is_empty() {
            return Err("names no file: write it, or take the line out".to_string());
        }
        let above_zero =
            [("weight_n", weight_n), ("mass_kg", mass_kg), ("winch_m_per_s", winch_m_per_s)];
        for (name, value) in above_zero {
            if let Some(value) = value.filter(|value| *value <= 0.0) {
                return Err(format!("'{name}' has {value}: write a number above zero"));
            }
        }
        if let Some(slope) = slope_deg.filter(|slope| slope.abs() > steepest_deg) {
            return Err(format!("'slope_deg' has {slope}: write degrees within ±{steepest_deg}"));
        }
        let both = weight_n.zip(mass_kg);
        match both.and_then(|(weight_n, mass_kg)| sense::other_weight_n(weight_n, mass_kg)) {
            Some(of_mass_n) => Err(format!(
                "'weight_n' is not the weight of 'mass_kg', {of_mass_n:.1} N: correct the one that \
                 is wrong"
            )),
            None => Ok(()),
        }
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
        let quoted =
            read("file,test_id\na.csv,\"the \"\"old\"\" block\"\n", Path::new("")).unwrap();
        assert_eq!(quoted[0].notes.test_id.as_deref(), Some("the \"old\" block"));
    }

    #[test]
    fn a_spreadsheets_table_is_read() {
        for (text, weight_n) in [
            ("File;Weight_N;winch_m_per_s\r\na.csv;630,5;0,0157\r\n;;\r\n", 630.5),
            ("sep=;\nfile;weight_n;\n\"a.csv\";630;\n", 630.0),
            ("file\tweight_n\na.csv\t630\n", 630.0),
        ] {
            assert!(is_manifest(text), "{text}");
            let entries = read(text, Path::new("logs")).unwrap();
            assert_eq!(entries.len(), 1, "{text}");
            assert_eq!(entries[0].path, Path::new("logs/a.csv"));
            assert_eq!(entries[0].test.weight_n, Some(weight_n));
        }
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, said) in [
            ("file,weight_n\na.csv,heavy\n", "line 2: 'weight_n' has 'heavy': write the number"),
            ("#\nfile,weigth_n\na.csv,630\n", "line 2: no column is called 'weigth_n'; there"),
            ("name,weight_n\na.csv,630\n", "line 1: no column is called 'file'; there are: file,"),
            ("file,file\na.csv,b.csv\n", "line 1: two columns are called 'file'"),
            ("file,unit\na.csv,stone\n", "line 2: 'unit' has 'stone': write N, kN"),
            ("file,array_id\na.csv,1.5\n", "line 2: 'array_id' has '1.5': write the array's"),
            ("file,weight_n\na.csv,630\n\nb.csv\n", "line 4: 1 cell instead of 2"),
            ("file,test_id\n\"a.csv,x\n", "line 2: a quote is not closed"),
            ("file,test_id\n,x\n", "line 2: names no file"),
            ("file;\na.csv;5\n", "line 2: '5' in cell 2 stands below no name"),
            ("file,winch_m_per_s\na.csv,nan\n", "line 2: 'winch_m_per_s' has 'nan'"),
            ("file,winch_m_per_s\na.csv,-0.02\n", "line 2: 'winch_m_per_s' has -0.02: write a"),
            ("file,weight_n\na.csv,0\n", "line 2: 'weight_n' has 0: write a number above zero"),
            ("file,slope_deg\na.csv,80\n", "line 2: 'slope_deg' has 80: write degrees within ±68"),
            ("file,snow_mm\na.csv,-1\n", "line 2: 'snow_mm' has '-1': write the depth"),
            ("file,kind\na.csv,foo\n", "line 2: 'kind' has 'foo': write one of sliding"),
            ("file,weight_n,mass_kg\na.csv,630,10\n", "line 2: 'weight_n' is not the weight of"),
        ] {
            let error = read(text, Path::new(".")).unwrap_err().to_string();
            assert!(error.starts_with(said), "{error}");
        }
        assert!(!is_manifest("a.csv\nb.csv\n") && !is_manifest("time_s,force_n\n"));
    }
}
