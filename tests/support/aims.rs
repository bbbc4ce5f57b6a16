//! Figures with aims, and lists of the figures that miss them.
//!
//! A list is a CSV file with row, figure, largest miss, and reason. A missed aim is an error unless
//! the list has it; a reached aim must be removed from the list, which [`shrink`] does. Nothing is
//! added.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Aim for the fraction of 95 % intervals that cover the truth.
pub const COVERAGE: (f64, f64) = (0.90, 0.99);

/// A figure with its aim.
#[derive(Clone, Debug)]
pub struct Check {
    /// Row of the table.
    pub row: String,
    /// Name of the figure in its row.
    pub what: String,
    /// The figure.
    pub value: f64,
    /// Distance from the aim; zero or less if the aim is reached.
    pub miss: f64,
}

impl Check {
    /// A figure with an aim between two values.
    #[must_use]
    pub fn between(row: &str, what: &str, value: f64, (least, most): (f64, f64)) -> Self {
        // NaN never reaches an aim.
        let miss = if value.is_nan() { f64::INFINITY } else { (least - value).max(value - most) };
        Self { row: row.to_owned(), what: what.to_owned(), value, miss }
    }

    /// A figure with a lower limit as its aim.
    #[must_use]
    pub fn least(row: &str, what: &str, value: f64, least: f64) -> Self {
        Self::between(row, what, value, (least, f64::INFINITY))
    }

    /// A figure with an upper limit as its aim.
    #[must_use]
    pub fn most(row: &str, what: &str, value: f64, most: f64) -> Self {
        Self::between(row, what, value, (f64::NEG_INFINITY, most))
    }
}

/// Aims of a fraction, widened by three standard errors for a number of draws: below by those of a
/// fraction of .95, above by those of the upper aim.
#[must_use]
pub fn share_limits((least, most): (f64, f64), draws: usize) -> (f64, f64) {
    let chance = |share: f64| 3.0 * (share * (1.0 - share) / draws.max(1) as f64).sqrt();
    (least - chance(0.95), most + chance(most))
}

/// A missed aim on a list.
#[derive(Clone, Debug, PartialEq)]
pub struct NotYet {
    /// Row of the table.
    pub row: String,
    /// Name of the figure.
    pub what: String,
    /// Largest accepted miss.
    pub miss: f64,
    /// Reason.
    pub why: String,
}

impl NotYet {
    fn is_of(&self, check: &Check) -> bool {
        self.row == check.row && self.what == check.what
    }
}

/// Reads a list.
///
/// # Panics
/// The file cannot be read, or a line has not four fields.
#[must_use]
pub fn not_yet(file: &Path) -> Vec<NotYet> {
    let text = fs::read_to_string(file).expect("a list of aims that are not reached");
    let entry = |line: &str| {
        let mut fields = line.splitn(4, ',').map(str::to_owned);
        let mut field = || fields.next().unwrap_or_else(|| panic!("four fields: {line}"));
        let (row, what) = (field(), field());
        let miss = field().parse().unwrap_or_else(|_| panic!("a number as third field: {line}"));
        NotYet { row, what, miss, why: field() }
    };
    text.lines().skip(1).map(entry).collect()
}

/// Error messages: a missed aim that is not on the list, a larger miss than listed, and a listed
/// aim that is reached or does not exist.
#[must_use]
pub fn faults(checks: &[Check], list: &[NotYet]) -> Vec<String> {
    let missed = checks.iter().filter_map(|check| {
        let allowed = list.iter().find(|e| e.is_of(check)).map_or(0.0, |e| e.miss);
        let Check { row, what, value, miss } = check;
        let far = format!("{row}: {what} is {value:.4}, {miss:.4} from its aim");
        (*miss > allowed).then(|| format!("{far} (allowed: {allowed})"))
    });
    let stale = list.iter().filter(|e| !is_missed(e, checks)).map(|e| {
        format!("{}: {} has reached its aim: FLOE_TABLE=write takes it off the list", e.row, e.what)
    });
    missed.chain(stale).collect()
}

/// The listed reason of a missed aim.
pub fn reason<'a>(list: &'a [NotYet]) -> impl Fn(&Check) -> &'a str {
    move |check| list.iter().find(|e| e.is_of(check)).map_or("not on the list", |e| &e.why)
}

/// Section of a page with the missed aims and their reasons.
#[must_use]
pub fn section<'a>(checks: &[Check], why: impl Fn(&Check) -> &'a str) -> String {
    let line = |check: &Check| {
        let Check { row, what, value, miss } = check;
        format!("| {row} | {what} | {value:.3} | {miss:.3} | {} |\n", why(check))
    };
    let lines: String = checks.iter().filter(|c| c.miss > 0.0).map(line).collect();
    let table = match lines.as_str() {
        "" => "Nothing.\n".to_owned(),
        lines => {
            format!("| row | figure | is | from the aim | why |\n|---|---|---:|---:|---|\n{lines}")
        }
    };
    format!("\n## What misses its aim\n\n{table}")
}

fn is_missed(entry: &NotYet, checks: &[Check]) -> bool {
    checks.iter().any(|check| entry.is_of(check) && check.miss > 0.0)
}

/// Checks figures against their aims and the list `golden/NAME-not-yet.csv`, which
/// `FLOE_TABLE=write` shrinks.
///
/// # Panics
/// If an aim is missed without being listed, or the list is outdated.
pub fn hold(name: &str, checks: &[Check]) {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let list = golden.join(format!("{name}-not-yet.csv"));
    if std::env::var("FLOE_TABLE").is_ok_and(|what| what == "write") {
        shrink(&list, checks);
    }
    let faults = faults(checks, &not_yet(&list));
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

/// Removes reached aims from a list.
///
/// # Panics
/// The file cannot be read or written.
pub fn shrink(file: &Path, checks: &[Check]) {
    let mut text = "row,what,miss,why\n".to_owned();
    for e in not_yet(file).iter().filter(|e| is_missed(e, checks)) {
        let _ = writeln!(text, "{},{},{},{}", e.row, e.what, e.miss, e.why);
    }
    fs::write(file, text).expect("the list can be written");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_of_one_is_too_much_of_a_thousand() {
        let (least, most) = share_limits((0.90, 0.99), 1000);
        assert!((0.879..0.880).contains(&least) && most < 1.0, "{least} {most}");
        assert!(share_limits((0.90, 0.99), 100).1 > 1.0);
    }

    #[test]
    fn what_misses_its_aim_is_named_with_the_reason() {
        let check = |value| [Check::most("a", "bias", value, 0.5)];
        let list = [NotYet { row: "a".into(), what: "bias".into(), miss: 0.3, why: "b".into() }];
        assert!(section(&check(0.5), reason(&list)).ends_with("\nNothing.\n"));
        let missed = section(&check(0.75), reason(&list));
        assert!(missed.ends_with("| a | bias | 0.750 | 0.250 | b |\n"), "{missed}");
    }
}
