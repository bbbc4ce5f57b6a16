//! Parses column names: a quantity, and a unit if there is one.
//!
//! `force_kN`, `Force [kN]`, `Kraft (N)`, `Time / s`, `Force in kN` and `kg` all contain the unit,
//! and so do `Force_kN_` and `Force..kN.`, which MATLAB and R make of `Force [kN]`.

use super::number::{Unit, finite};
use super::stamp::TimeUnit;

/// A parsed name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The quantity in lower case; empty if the name is only a unit.
    pub quantity: String,
    /// The unit as written.
    pub unit: Option<String>,
}

/// Names of a time.
const TIME: [&str; 32] = [
    "time",
    "tempo",
    "tid",
    "tijd",
    "время",
    "t",
    "ts",
    "zeit",
    "timestamp",
    "time stamp",
    "time_stamp",
    "epoch",
    "unix time",
    "unix_time",
    "elapsed",
    "elapsed time",
    "elapsed_time",
    "relative time",
    "datetime",
    "date time",
    "date/time",
    "date_time",
    "x_value",
    "temps",
    "tiempo",
    "uhrzeit",
    "datum/zeit",
    "datum/uhrzeit",
    "datum zeit",
    "datum uhrzeit",
    "zeitstempel",
    "date and time",
];
/// Names of a force in the cable.
const FORCE: [&str; 13] = [
    "force",
    "fuerza",
    "forza",
    "сила",
    "effort",
    "kraft",
    "zugkraft",
    "load",
    "pull",
    "pull force",
    "pull_force",
    "tension",
    "last",
];

impl Label {
    /// Parses a column's name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let name = name.trim().trim_end_matches([',', '_', '.']);
        let label = |quantity: &str, unit: &str| {
            let quantity = quantity.trim().trim_end_matches(['_', '/', ',', '.']).trim();
            let unit = Some(unit.trim().to_string()).filter(|unit| !unit.is_empty());
            Self { quantity: quantity.to_lowercase(), unit }
        };
        for (open, close) in [('[', ']'), ('(', ')')] {
            if let Some((quantity, unit)) =
                name.strip_suffix(close).and_then(|rest| rest.rsplit_once(open))
            {
                return Self::before(quantity, unit).unwrap_or_else(|| label(quantity, unit));
            }
            let inside = |(before, rest): (&'_ str, &'_ str)| {
                let (unit, behind) = rest.split_once(close).filter(|(unit, _)| is_unit(unit))?;
                Some(label(&format!("{} {}", before.trim(), behind.trim()), unit))
            };
            if let Some(label) = name.split_once(open).and_then(inside) {
                return label;
            }
        }
        if is_unit(name) && !name.eq_ignore_ascii_case("n") {
            return label("", name);
        }
        let says = |unit| is_unit(unit) || is_foreign(unit);
        match name.rsplit_once(['_', ' ', '/', '.']).filter(|(_, unit)| says(unit)) {
            Some((quantity, _)) if ends_with_size(quantity) => label(name, ""),
            Some((quantity, unit)) => label(quantity.trim_end_matches(" in"), unit),
            None => label(name, ""),
        }
    }

    /// A unit before brackets without one: `Force, N (LGR S/N: 1234)`.
    fn before(name: &str, inside: &str) -> Option<Self> {
        let label = Self::new(name);
        let is_unit = label.unit.as_deref().is_some_and(is_unit) && !is_unit_cell(inside);
        let quantity = format!("{} ({})", label.quantity, inside.to_lowercase());
        is_unit.then_some(Self { quantity, ..label })
    }

    /// Whether the name is that of a time column.
    #[must_use]
    pub fn is_time(&self) -> bool {
        let alone = self.quantity.is_empty() && self.time_unit().is_some();
        alone || TIME.contains(&self.quantity.as_str())
    }

    /// Whether the name is that of a force column; `force_min` is a minimum.
    #[must_use]
    pub fn is_force(&self) -> bool {
        FORCE.contains(&self.quantity.as_str()) && !self.is_in_time()
    }

    /// Whether the name contains a word for a force.
    #[must_use]
    pub fn holds_force(&self) -> bool {
        self.words().any(|word| FORCE.contains(&word))
    }

    /// Whether the name contains a word besides that for a force: `force_std`, `Force setpoint`.
    #[must_use]
    pub fn says_more_than_force(&self) -> bool {
        !self.is_force() && self.holds_force() && self.words().any(|word| !FORCE.contains(&word))
    }

    /// Whether the name contains a factor: `Force x 10`, `10*t`, `10^3 force`, `10 N`.
    #[must_use]
    pub fn holds_factor(&self) -> bool {
        let factor = |(at, mark): (usize, &str)| {
            let (before, behind) = self.quantity.split_at_checked(at).unwrap_or_default();
            let behind = behind.strip_prefix(mark).unwrap_or_default().trim_start();
            let is_word = mark != "x" || !before.ends_with(char::is_alphanumeric);
            let is_before = matches!(mark, "*" | "×") && finite(before.trim().as_bytes()).is_some();
            is_before || is_word && behind.starts_with(|first: char| first.is_ascii_digit())
        };
        finite(self.quantity.as_bytes()).is_some()
            || self.quantity.match_indices(['x', '×', '*', '/', '^']).any(factor)
    }

    fn words(&self) -> impl Iterator<Item = &str> {
        let words = self.quantity.split(|letter: char| !letter.is_alphanumeric());
        words.filter(|word| !word.is_empty())
    }

    /// Whether the unit is one of time.
    #[must_use]
    pub fn is_in_time(&self) -> bool {
        self.time_unit().is_some()
    }

    /// The unit, if it is one of time.
    #[must_use]
    pub fn time_unit(&self) -> Option<TimeUnit> {
        self.unit.as_deref().and_then(TimeUnit::from_label)
    }

    /// The unit, if it is one of force.
    #[must_use]
    pub fn force_unit(&self) -> Option<Unit> {
        self.unit.as_deref().and_then(Unit::from_label)
    }
}

/// Whether a unit behind this text is that of a number, such as the size of the cell: `Load cell 5 kN`.
fn ends_with_size(quantity: &str) -> bool {
    let last = quantity.trim_end().rsplit_once(' ');
    let is_factor = |before: &str| before.trim_end().ends_with(['x', '×', '*']);
    last.is_some_and(|(before, last)| finite(last.as_bytes()).is_some() && !is_factor(before))
}

fn is_unit(text: &str) -> bool {
    TimeUnit::from_label(text).is_some() || Unit::from_label(text).is_some()
}

/// Unsupported units of a force or of a load cell's output; an error is better than taking them for
/// newtons.
#[must_use]
pub fn is_foreign(text: &str) -> bool {
    const FOREIGN: [&str; 28] = [
        "mn", "cn", "dn", "dan", "g", "gf", "gram", "grams", "tf", "ton", "tons", "tonf", "tonne",
        "tonnes", "kip", "kips", "klb", "klbf", "oz", "ozf", "v", "mv", "uv", "mvv", "volt",
        "volts", "vdc", "lsb",
    ];
    FOREIGN.contains(&text.to_lowercase().as_str())
}

/// A unit of force other than N within a name: `Load_kgf_Avg`.
#[must_use]
pub fn unit_within(name: &str) -> Option<&str> {
    let words = || name.split(|letter: char| !letter.is_alphanumeric());
    let is_other = |word: &&str| Unit::from_label(word).is_some_and(|unit| unit != Unit::Newton);
    // Tonnes; behind a time it is its symbol.
    let are_tonnes = |word: &str| word.eq_ignore_ascii_case("t");
    let is_last = |word: &&str| is_foreign(word) || are_tonnes(word);
    words().find(is_other).or_else(|| words().skip(1).find(is_last))
}

/// Whether a cell may belong to a row of units: empty, in brackets, or the name of a unit.
#[must_use]
pub fn is_unit_cell(cell: &str) -> bool {
    const OTHERS: [&str; 18] = [
        "-", "v", "mv", "mv/v", "°c", "degc", "c", "k", "%", "mm", "m", "cm", "m/s", "mm/s", "deg",
        "°", "rad", "ts",
    ];
    let text = bare_unit(cell);
    cell.len() > text.len()
        || text.is_empty()
        || is_unit(text)
        || is_foreign(text)
        || OTHERS.contains(&text.to_lowercase().as_str())
}

/// A unit without surrounding brackets.
#[must_use]
pub fn bare_unit(cell: &str) -> &str {
    let cell = cell.trim();
    let inside = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    inside('[', ']').or_else(|| inside('(', ')')).unwrap_or(cell).trim()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_apart() {
        let table = [
            ("time_s", "time", "s"),
            ("t", "t", ""),
            ("Time (s)", "time", "s"),
            ("Zeit [ms]", "zeit", "ms"),
            ("time_ms", "time", "ms"),
            ("Time / s", "time", "s"),
            ("minutes", "", "minutes"),
            ("force_kN", "force", "kN"),
            ("Force in kN", "force", "kN"),
            ("Kraft (N)", "kraft", "N"),
            ("kg", "", "kg"),
            ("n", "n", ""),
            ("Load cell 1", "load cell 1", ""),
            ("Force [mV/V]", "force", "mV/V"),
            ("force_mN", "force", "mN"),
            ("Kraft daN", "kraft", "daN"),
            ("time_stamp", "time_stamp", ""),
            ("Force (N) Run #1", "force run #1", "N"),
            ("Force, N (LGR S/N: 1234)", "force (lgr s/n: 1234)", "N"),
            ("Force kN (x 10)", "force (x 10)", "kN"),
            ("Force_N (kgf)", "force_n", "kgf"),
            ("Time (s),", "time", "s"),
            ("Load cell 5 kN", "load cell 5 kn", ""),
            ("S-beam 500 kg", "s-beam 500 kg", ""),
            ("load_1_kn", "load_1", "kn"),
            ("Load cell 5 kN [N]", "load cell 5 kn", "N"),
            ("Force_kN_", "force", "kN"),
            ("Force..kN.", "force", "kN"),
            ("Time..min.", "time", "min"),
            ("Std. Dev.", "std. dev", ""),
        ];
        for (name, quantity, unit) in table {
            let unit = Some(unit.to_string()).filter(|unit| !unit.is_empty());
            assert_eq!(Label::new(name), Label { quantity: quantity.to_string(), unit }, "{name}");
        }
    }

    #[test]
    fn factors() {
        for name in [
            "Force x 10 N",
            "Force*10 (N)",
            "Force x10 [N]",
            "load ×1000",
            "10^3 force",
            "Force/10",
            "10 N",
            "0.1 [kN]",
            "10*t [s]",
            "Time/10 ms",
        ] {
            assert!(Label::new(name).holds_factor(), "{name}");
        }
        for name in ["force_n", "Force max (N)", "Load cell 1", "box1 force", "Force x (N)"] {
            assert!(!Label::new(name).holds_factor(), "{name}");
        }
    }

    #[test]
    fn unit_cells() {
        for cell in ["", "[kN]", "(lbf)", "kN", "s", "-", "°C", "[anything]"] {
            assert!(is_unit_cell(cell), "{cell}");
        }
        for cell in ["force", "time_s", "Channel 1", "0.5"] {
            assert!(!is_unit_cell(cell), "{cell}");
        }
        assert_eq!((bare_unit("[kN]"), bare_unit(" kN ")), ("kN", "kN"));
    }
}
