//! What a caller may say about a log.

use super::Format;
use super::number::{Decimal, Unit};
use super::stamp::TimeUnit;
use crate::error::InputError;
use crate::replay::test::TestOptions;

/// What a caller may say about a log; everything else is found in it.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "The log, where it is not recognised")]
pub struct LogOptions {
    /// Format of the log [default: recognised from its content]
    #[arg(long)]
    pub format: Option<Format>,
    /// Samples per second, 1 to 2000 [default: from the time stamps, else 16]
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    pub rate_hz: Option<f64>,
    /// Name of the force column, or its number from 1
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    /// Unit of the force column [default: as the log says, else N]
    #[arg(long)]
    pub unit: Option<Unit>,
    /// Name of the time column, or its number from 1
    #[arg(long, value_name = "NAME")]
    pub time_column: Option<String>,
    /// Unit or form of the time column [default: as the log says, else s]
    #[arg(long)]
    pub time_unit: Option<TimeUnit>,
    /// Lines to skip before the header
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub skip_lines: u64,
    /// What separates the cells: a character, tab or space (any number of blanks)
    #[arg(long, value_name = "C", value_parser = separator)]
    pub delimiter: Option<u8>,
    /// The decimal mark, . or ,
    #[arg(long, value_name = "C")]
    pub decimal: Option<Decimal>,
    /// Array to read of a cr10 log [default: the only one, or the only one with seconds]
    #[arg(long, value_name = "ID")]
    pub array_id: Option<u32>,
    /// Keys of the log's metadata that the command's other options replace, so that the log may
    /// contradict itself there
    #[arg(skip)]
    pub settled: Vec<&'static str>,
}

impl LogOptions {
    /// These options, with the keys that the options of a test replace.
    #[must_use]
    pub fn settled_by(&self, test: &TestOptions) -> Self {
        let rate = self.rate_hz.map(|_| "rate_hz");
        Self { settled: test.settles().chain(rate).collect(), ..self.clone() }
    }

    /// Rejects options that a format cannot use.
    ///
    /// # Errors
    /// Names the option and the format.
    pub fn check(&self, format: Format) -> Result<(), InputError> {
        use Format::{Cr10, Csv, Floe, Toa5};
        let (is_csv, is_floe) = (format == Csv, format == Floe);
        let unused = [
            ("--array-id", self.array_id.is_some() && format != Cr10, Cr10),
            ("--column", self.column.is_some() && is_floe, Csv),
            ("--unit", self.unit.is_some() && is_floe, Csv),
            ("--time-column", self.time_column.is_some() && !is_csv && format != Toa5, Csv),
            ("--time-unit", self.time_unit.is_some() && !is_csv, Csv),
            ("--skip-lines", self.skip_lines > 0 && !is_csv, Csv),
            ("--delimiter", self.delimiter.is_some() && !is_csv, Csv),
            ("--decimal", self.decimal.is_some() && !is_csv, Csv),
        ];
        let Some((option, _, of)) = unused.into_iter().find(|(_, is_unused, _)| *is_unused) else {
            return Ok(());
        };
        let (of, this) = (of.name(), format.name());
        // A logger's own log is not text.
        let remedy = if is_floe { "" } else { &format!(", or give --format {of}") };
        Err(InputError::new(format!(
            "{option} is for a {of} log, and this is {this}: leave it out{remedy}"
        )))
    }
}

fn separator(text: &str) -> Result<u8, String> {
    match (text, text.as_bytes()) {
        ("tab" | "\\t", _) => Ok(b'\t'),
        ("space", _) => Ok(b' '),
        (_, &[one]) if one.is_ascii_punctuation() && !b"\"#.-+".contains(&one) => Ok(one),
        (_, &[one @ (b' ' | b'\t')]) => Ok(one),
        _ => Err("must be one character like ; or tab or space".to_string()),
    }
}
