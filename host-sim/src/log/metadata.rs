//! Metadata of a test in `# key: value` lines of a log.

use crate::error::{InputError, excerpt};
use crate::replay::known::{KnownMetadata, WeightFrom};

use super::cells::words;
use super::comment::comment;
use super::meant::meant;
use super::sense;
use super::winch_marks::{self, WinchMark};

/// Values of the known keys; all other comments are skipped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Metadata {
    /// Name of the test.
    pub test_id: Option<String>,
    /// Effects that were looked for, in the form of `--effects`.
    pub effects: Option<String>,
    /// Weight of the block, N.
    pub weight_n: Option<f64>,
    /// Mass of the block, kg.
    pub mass_kg: Option<f64>,
    /// Normal force of a block under the ice, N.
    pub normal_n: Option<f64>,
    /// Slope along the pull, degrees, uphill positive.
    pub slope_deg: Option<f64>,
    /// Uncertainties of the inputs.
    pub known: KnownMetadata,
    /// Take-up speed of the winch, m/s.
    pub winch_m_per_s: Option<f64>,
    /// Marks of the winch during the test.
    pub winch_marks: Option<Vec<WinchMark>>,
    /// Length of the cable, m.
    pub cable_length_m: Option<f64>,
    /// How the block was pulled: `sliding`, `rafting` or `over-riding`.
    pub kind: Option<String>,
    /// The ice under the block: `fresh` or `repeated`.
    pub track: Option<String>,
    /// Start of the test, ms since 1970 (UTC).
    pub start_unix_ms: Option<f64>,
    /// Whether the stamps have no meaningful date, because the logger's clock was not set.
    pub undated: bool,
    /// Mean temperature of the converter, °C.
    pub temperature_c: Option<f64>,
    /// Mean supply of the converter, V.
    pub supply_v: Option<f64>,
    /// Depth of the snow cover, mm.
    pub snow_mm: Option<f64>,
    /// Samples per second.
    pub rate_hz: Option<f64>,
    /// Largest force of the load cell, N.
    pub range_n: Option<f64>,
    /// Converter code at zero force.
    pub tare_counts: Option<f64>,
    /// Converter codes per newton.
    pub counts_per_n: Option<f64>,
    /// Unit of the force, as written, for a column without a unit.
    pub unit: Option<String>,
    /// Description by the simulator, if the log was simulated.
    pub synthetic: Option<String>,
    /// All known keys, in the order of the log.
    pub said: Vec<Said>,
    /// Lines that resemble a known key, or come too late.
    pub notes: Vec<Note>,
    /// Keys that come too late.
    late: Vec<String>,
    /// Keys that the caller's options replace, so that the log may contradict itself there.
    settled: Vec<&'static str>,
    /// Those for which it does.
    contradicted: Vec<String>,
}

/// A line with unused information.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The key that was meant, or came too late.
    pub key: String,
    /// Text of the note.
    pub text: String,
}

/// First line with a key.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Said {
    /// The key.
    pub key: String,
    /// Value as written in the log.
    pub value: String,
    /// Line number.
    pub line: u64,
}

impl Metadata {
    /// Nothing stored yet; a contradiction about a key of `settled` is noted and no error.
    #[must_use]
    pub fn new(settled: &[&'static str]) -> Self {
        Self { settled: settled.to_vec(), ..Self::default() }
    }

    /// Stores the comment in line `number`; other lines that resemble one are noted.
    ///
    /// # Errors
    /// A known key whose value is not a finite number, or contradicts an earlier line and is not
    /// settled.
    pub fn take(&mut self, line: &[u8], number: u64) -> Result<(), InputError> {
        let behind_mark = comment(line);
        let text = words(behind_mark.unwrap_or(line));
        // A spreadsheet fills a comment with empty cells.
        let text = text.trim_end_matches(|end: char| end.is_whitespace() || ",;".contains(end));
        let text = text.trim_start_matches(['#', '%', ' ', '\t']);
        let Some((key, value)) = behind_mark.and_then(|_| text.split_once(':')) else {
            self.look_at(text, number);
            return Ok(());
        };
        let (key, value) = (key.trim().to_ascii_lowercase(), value.trim());
        let Some(contradicted) = self.store(&key, value)? else {
            self.look_at(text, number);
            return Ok(());
        };
        match self.line(&key) {
            Some(first) if contradicted => self.contradict(&key, value, [first, number]),
            Some(_) => Ok(()),
            None => {
                self.said.push(Said { key, value: value.to_string(), line: number });
                self.weigh(number)
            }
        }
    }

    /// Handles a value that differs from that of an earlier line: an error, unless the caller's
    /// option settles it.
    fn contradict(&mut self, key: &str, value: &str, lines: [u64; 2]) -> Result<(), InputError> {
        let ([first, number], value) = (lines, excerpt(value.as_bytes()));
        if !self.settled.contains(&key) {
            return Err(InputError::new(format!(
                "'# {key}:' says {value}, and line {first} says otherwise: cut the log there, or \
                 correct the one that is wrong"
            )));
        }
        if !self.is_contradicted(key) {
            self.contradicted.push(key.to_string());
            let text = format!(
                "line {number}: '# {key}:' says {value}, and line {first} says otherwise: neither is \
                 used, as the command says it"
            );
            self.notes.push(Note { key: key.to_string(), text });
        }
        Ok(())
    }

    /// Whether the log gives two values of a key that the caller's options replace.
    #[must_use]
    pub fn is_contradicted(&self, key: &str) -> bool {
        self.contradicted.iter().any(|it| it == key)
    }

    /// Stores the value of a key; returns whether another value was stored before, or `None` for an
    /// unknown key.
    fn store(&mut self, key: &str, value: &str) -> Result<Option<bool>, InputError> {
        let refused = |why: String| InputError::new(format!("'# {key}:' {why}"));
        let text = Some(value.to_string());
        let contradicted = match key {
            "test_id" => replaced(&mut self.test_id, text.filter(|id| !id.is_empty())),
            "effects" => replaced(&mut self.effects, text.filter(|it| !it.is_empty())),
            "kind" => replaced(&mut self.kind, Some(sense::word("kind", value).map_err(refused)?)),
            "track" => {
                replaced(&mut self.track, Some(sense::word("track", value).map_err(refused)?))
            }
            "weight_from" => {
                replaced(&mut self.known.weight_from, Some(WeightFrom::from_word(value)?))
            }
            "winch_marks_s" => {
                let marks = winch_marks::parse(value).map_err(refused)?;
                replaced(&mut self.winch_marks, Some(marks))
            }
            "unit" => replaced(&mut self.unit, text),
            "synthetic" => replaced(&mut self.synthetic, text),
            key => match self.field(key) {
                Some(field) => replaced(field, Some(sense::number(key, value).map_err(refused)?)),
                None => return Ok(None),
            },
        };
        Ok(Some(contradicted))
    }

    /// Handles the comment in line `number` after the samples that define the log: a new key there
    /// is too late.
    ///
    /// # Errors
    /// A known key whose value is not a finite number, or contradicts an earlier line.
    pub fn take_late(&mut self, line: &[u8], number: u64) -> Result<(), InputError> {
        let mut with = self.clone();
        with.take(line, number)?;
        (self.notes, self.contradicted) = (with.notes, with.contradicted);
        let Some(Said { key, value, .. }) = with.said.get(self.said.len()) else { return Ok(()) };
        if !self.late.contains(key) {
            let text = format!(
                "line {number}: '# {key}: {value}' comes too late and is not used: write it above \
                 the rows"
            );
            self.notes.push(Note { key: key.clone(), text });
            self.late.push(key.clone());
        }
        Ok(())
    }

    /// Rejects a weight that differs from that of the mass by more than variations of gravity.
    fn weigh(&self, number: u64) -> Result<(), InputError> {
        let (Some(weight_n), Some(mass_kg)) = (self.weight_n, self.mass_kg) else { return Ok(()) };
        let (weight, mass) = (self.line("weight_n"), self.line("mass_kg"));
        let (Some(weight), Some(mass)) = (weight, mass) else { return Ok(()) };
        let Some(of_mass_n) = sense::other_weight_n(weight_n, mass_kg) else { return Ok(()) };
        let is_settled = ["weight_n", "mass_kg"].iter().all(|key| self.settled.contains(key));
        if weight.max(mass) != number || is_settled {
            return Ok(());
        }
        Err(InputError::new(format!(
            "'# weight_n: {weight_n}' in line {weight} is not the weight of '# mass_kg: {mass_kg}' in \
             line {mass}, {of_mass_n:.1} N: correct the one that is wrong"
        )))
    }

    /// Notes a line that resembles a known key, one of the first few for each: of a long log all
    /// would cost memory, and time with every further comment.
    fn look_at(&mut self, text: &str, number: u64) {
        const MOST: usize = 8;
        let Some((key, value)) = meant(text, |key| self.field(key).is_some()) else { return };
        if self.notes.iter().filter(|note| note.key == key).count() >= MOST {
            return;
        }
        let said = excerpt(text.as_bytes());
        let text = format!("line {number}: {said} is not read: write '# {key}: {value}'");
        self.notes.push(Note { key, text });
    }

    /// First line with a key.
    #[must_use]
    pub fn line(&self, key: &str) -> Option<u64> {
        self.first(key).map(|said| said.line)
    }

    /// First entry with a key.
    #[must_use]
    pub fn first(&self, key: &str) -> Option<&Said> {
        self.said.iter().find(|said| said.key == key)
    }

    fn field(&mut self, key: &str) -> Option<&mut Option<f64>> {
        Some(match key {
            "weight_n" => &mut self.weight_n,
            "mass_kg" => &mut self.mass_kg,
            "normal_n" => &mut self.normal_n,
            "slope_deg" => &mut self.slope_deg,
            "winch_m_per_s" => &mut self.winch_m_per_s,
            "cable_length_m" => &mut self.cable_length_m,
            "start_unix_ms" => &mut self.start_unix_ms,
            "temperature_c" => &mut self.temperature_c,
            "supply_v" => &mut self.supply_v,
            "snow_mm" => &mut self.snow_mm,
            "rate_hz" => &mut self.rate_hz,
            "range_n" => &mut self.range_n,
            "tare_counts" => &mut self.tare_counts,
            "counts_per_n" => &mut self.counts_per_n,
            key => return self.known.field(key),
        })
    }
}

/// Stores a value; returns whether it replaced a different one.
fn replaced<T: PartialEq>(field: &mut Option<T>, value: Option<T>) -> bool {
    let contradicts = field.is_some() && *field != value;
    *field = value;
    contradicts
}

#[cfg(test)]
mod tests;
