//! Several channels in consecutive rows, each with the same time: `time_s,channel,force_n`.

use crate::error::InputError;

use super::LogOptions;
use super::columns::Columns;
use super::header::{Kind, kind};
use super::label::Label;
use super::layout::TimeCells;
use super::number::finite;
use super::timing::median;

/// Smallest number of times with equally many rows.
const TIMES: usize = 4;
/// Rows per time above which numbers are taken for samples instead of channels.
const MOST: usize = 8;

impl Columns<'_> {
    /// Rejects rows that repeat each time for every channel, if another column names the channels
    /// or the forces show them.
    ///
    /// # Errors
    /// Names that column.
    pub fn refuse_channels(
        &self,
        time: TimeCells,
        force: usize,
        options: &LogOptions,
    ) -> Result<(), InputError> {
        self.refuse_other_rows(force)?;
        let (date, clock) = match time {
            TimeCells::Number { cell, .. } | TimeCells::Numbered { cell, .. } => (None, cell),
            TimeCells::DateAndClock { date, clock } => (date, clock),
            TimeCells::Count { .. } | TimeCells::Cr10 { .. } => return Ok(()),
        };
        let stamp =
            |row: &Vec<String>| (date.and_then(|at| row.get(at)).cloned(), row.get(clock).cloned());
        let mut groups: Vec<&[Vec<String>]> =
            self.header.rows.chunk_by(|a, b| stamp(a) == stamp(b)).collect();
        // The last group may be incomplete.
        groups.pop();
        let times = groups.first().map_or(0, |group| group.len());
        if times < 2 || groups.len() < TIMES || groups.iter().any(|group| group.len() != times) {
            return self.refuse_rounds(force, options);
        }
        let is_time = |at: usize| {
            at == clock || Some(at) == date || self.labels.get(at).is_some_and(Label::is_in_time)
        };
        let mut others = (0..self.header.width).filter(|&at| at != force && !is_time(at));
        let why = match others.find(|&at| names_channels(&groups, at)) {
            Some(channel) => format!("column {} differs within it: keep the rows of one channel", self.said(channel)),
            None if options.rate_hz.is_none() && are_of_channels(&groups, force) => {
                "the force goes to and fro between as many values: keep the rows of one channel, or \
                 give --rate-hz R if all are of one force"
                    .to_string()
            }
            None => return Ok(()),
        };
        Err(InputError::new(format!("each time stands {times} times, and {why}")))
    }

    /// Rejects rows of two sensors in alternation: another column has numbers exactly where the
    /// force is missing.
    fn refuse_other_rows(&self, force: usize) -> Result<(), InputError> {
        let holds = |row: &Vec<String>, at: usize| {
            row.get(at).is_some_and(|cell| finite(cell.as_bytes()).is_some())
        };
        let rows = &self.header.rows;
        let is_instead = |at: &usize| rows.iter().all(|row| holds(row, *at) != holds(row, force));
        let without = rows.iter().filter(|row| !holds(row, force)).count();
        let column = (0..self.header.width).filter(|&at| at != force).find(is_instead);
        match column.filter(|_| (TIMES..rows.len()).contains(&without)) {
            Some(other) => Err(InputError::new(format!(
                "column {} holds numbers where, and only where, {} holds none: these are rows of \
                 another sensor; take them out",
                self.said(other),
                self.said(force)
            ))),
            None => Ok(()),
        }
    }

    /// Rejects rows with a cyclic column of words, if its name is one of channels or the forces
    /// alternate with it, and each channel has its own times.
    fn refuse_rounds(&self, force: usize, options: &LogOptions) -> Result<(), InputError> {
        let channels = |at: usize| {
            let words = self.goes_round(at)?;
            let rounds: Vec<&[Vec<String>]> = self.header.rows.chunks_exact(words).collect();
            let are = self.is_of_channels(at) || are_of_channels(&rounds, force);
            Some((at, words)).filter(|_| are && options.rate_hz.is_none())
        };
        match (0..self.header.width).find_map(channels) {
            Some((channel, words)) => Err(InputError::new(format!(
                "column {} goes round through {words} words, from row to row: keep the rows of one \
                 channel, or give --rate-hz R if all are of one force",
                self.said(channel)
            ))),
            None => Ok(()),
        }
    }

    fn is_of_channels(&self, column: usize) -> bool {
        const NAMES: [&str; 7] = ["channel", "ch", "sensor", "type", "kanal", "signal", "field"];
        let name = self.name(column).to_lowercase();
        name.split(|letter: char| !letter.is_alphanumeric()).any(|word| NAMES.contains(&word))
    }

    /// Number of words in a cycle that repeats in the same order.
    fn goes_round(&self, column: usize) -> Option<usize> {
        let cells: Vec<&str> = self.cells(column).collect();
        let (first, others) = cells.split_first()?;
        let count = 1 + others.iter().position(|cell| cell == first)?;
        let round = cells.get(..count)?;
        let is_word = |cell: &&str| kind(cell) == Kind::Text;
        let differ =
            round.iter().enumerate().all(|(i, a)| !round.iter().skip(i + 1).any(|b| a == b));
        let again = cells.iter().zip(round.iter().cycle()).all(|(a, b)| a == b);
        let is_round = (2..=MOST).contains(&count) && cells.len() >= TIMES * count;
        (is_round && differ && again && round.iter().all(is_word)).then_some(count)
    }

    pub(super) fn said(&self, column: usize) -> String {
        match self.name(column) {
            "" => (column + 1).to_string(),
            name => format!("'{name}'"),
        }
    }
}

/// Whether a column has equal values for every time, and different ones in the rows of a time.
fn names_channels(groups: &[&[Vec<String>]], column: usize) -> bool {
    let cells = |group: &[Vec<String>]| {
        let cells: Vec<Option<String>> = group.iter().map(|row| row.get(column).cloned()).collect();
        cells
    };
    let Some(first) = groups.first().map(|group| cells(group)) else { return false };
    let mut sorted = first.clone();
    sorted.sort();
    sorted.dedup();
    let are_numbers = first.iter().flatten().all(|cell| cell.parse::<f64>().is_ok());
    sorted.len() == first.len()
        && (first.len() <= MOST || !are_numbers)
        && groups.iter().all(|group| cells(group) == first)
}

/// Whether the force changes in the same direction between the same rows of every time, and far
/// more than from time to time, because the rows belong to different channels.
fn are_of_channels(groups: &[&[Vec<String>]], column: usize) -> bool {
    /// Ratio of both changes that noise never reaches over this many times; tuned: a rising force
    /// has 0.5.
    const FAR: f64 = 4.0;
    let force = |row: &Vec<String>| finite(row.get(column)?.as_bytes());
    let first = |group: &&[Vec<String>]| force(group.first()?);
    let step = |group: &&[Vec<String>]| Some(force(group.get(1)?)? - force(group.first()?)?);
    let steps: Vec<f64> = groups.iter().filter_map(step).collect();
    let forces: Vec<f64> = groups.iter().filter_map(first).collect();
    let changes = forces.windows(2).filter_map(|w| Some((w.last()? - w.first()?).abs()));
    let change = median(changes.collect());
    let size = median(steps.iter().map(|step| step.abs()).collect());
    let one_way = steps.iter().all(|&step| step > 0.0) || steps.iter().all(|&step| step < 0.0);
    one_way && size.zip(change).is_some_and(|(size, change)| size > FAR * change)
}
