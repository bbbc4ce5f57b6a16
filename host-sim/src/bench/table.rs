//! The comparison as tables and as aligned text.

use std::fmt::Write;

use super::result::{BenchResult, Row};

/// Title of a column, and the function for its value.
type Column = (&'static str, fn(&Row) -> Option<f64>);

const OVER_BOUND: [Column; 2] =
    [("mu_s/bound", |row| row.mu_s?.over_bound), ("mu/bound", |row| row.mu?.over_bound)];
const RMS: [Column; 2] = [
    ("mu_s rms %", |row| Some(row.mu_s?.rms_percent)),
    ("mu rms %", |row| Some(row.mu?.rms_percent)),
];
const BIAS: [Column; 2] = [
    ("mu_s bias %", |row| Some(row.mu_s?.bias_percent)),
    ("mu bias %", |row| Some(row.mu?.bias_percent)),
];
const P95: [Column; 2] = [
    ("mu_s 95 %", |row| Some(row.mu_s?.p95_percent)),
    ("mu 95 %", |row| Some(row.mu?.p95_percent)),
];
const TIMES: [Column; 3] = [
    ("delay ms", |row| row.onset_delay_ms),
    ("ns/sample", |row| Some(row.ns_per_sample)),
    ("worst ns", |row| row.worst_tick_ns),
];

/// One of the comparison's tables.
#[derive(Clone, Debug)]
pub struct Table {
    /// Titles of the columns after the names.
    pub titles: Vec<&'static str>,
    /// Name and cells of each row.
    pub rows: Vec<(String, Vec<String>)>,
}

/// Text with a table per scene, then the summary.
#[must_use]
pub fn text(result: &BenchResult) -> String {
    let mut out = String::new();
    for block in blocks(&result.rows) {
        let _ = writeln!(out, "{}", heading(block));
        lines(&mut out, &scene(block));
        out.push('\n');
    }
    for (kind, linear) in [("Linear", true), ("Hard", false)] {
        let _ = writeln!(out, "{kind} scenes: median (worst)");
        lines(&mut out, &summary(result, linear));
        out.push('\n');
    }
    let _ = writeln!(out, "one look at each sample: {:.2} ns", result.one_pass_ns);
    let _ = writeln!(out, "seeds from {} on in every scene", result.first_seed);
    if result.host.debug_build {
        let _ = writeln!(out, "built without optimisation: times mean little");
    }
    out
}

/// The rows of each scene.
pub fn blocks(rows: &[Row]) -> impl Iterator<Item = &[Row]> {
    rows.chunk_by(|a, b| a.scene == b.scene && a.noise_percent.total_cmp(&b.noise_percent).is_eq())
}

/// Name, kind and size of a scene.
#[must_use]
pub fn heading(block: &[Row]) -> String {
    let Some(row) = block.first() else { return String::new() };
    let kind = if row.linear { "linear" } else { "hard" };
    let noise = 0.01 * (100.0 * row.noise_percent).round();
    format!("{} ({kind}), noise {noise} % of the weight, {} events", row.scene, row.events)
}

fn lines(out: &mut String, Table { titles, rows }: &Table) {
    let width = |i: usize| {
        let cells = rows.iter().filter_map(|(_, cells)| cells.get(i)).map(String::len);
        cells.chain(titles.get(i).map(|title| title.len())).max().unwrap_or(0) + 2
    };
    let _ = write!(out, "{:<24}", "");
    for (i, title) in titles.iter().enumerate() {
        let _ = write!(out, "{title:>0$}", width(i));
    }
    out.push('\n');
    for (name, cells) in rows {
        let _ = write!(out, "{name:<24}");
        for (i, cell) in cells.iter().enumerate() {
            let _ = write!(out, "{cell:>0$}", width(i));
        }
        out.push('\n');
    }
}

fn titles(columns: &[Column]) -> Vec<&'static str> {
    columns.iter().map(|(title, _)| *title).collect()
}

fn cells(columns: &[Column], row: &Row) -> Vec<String> {
    columns.iter().map(|(_, of)| of(row).map_or_else(|| "-".to_owned(), short)).collect()
}

/// Table of the methods in one scene.
#[must_use]
pub fn scene(block: &[Row]) -> Table {
    let errors = [OVER_BOUND, RMS, BIAS, P95].concat();
    let row = |row: &Row| {
        let found = [format!("{:.3}", row.f1), format!("{:.0}", row.read_percent)];
        (row.method.clone(), [&cells(&errors, row)[..], &found, &cells(&TIMES, row)].concat())
    };
    Table {
        titles: [&titles(&errors)[..], &["F1", "read %"], &titles(&TIMES)].concat(),
        rows: block.iter().map(row).collect(),
    }
}

/// Table of each method over the linear or hard scenes: median, and the worst value in brackets.
/// The memory between samples is equal in all scenes.
#[must_use]
pub fn summary(result: &BenchResult, linear: bool) -> Table {
    let errors = [OVER_BOUND, RMS, P95].concat();
    let row = |method: &str| {
        let of = |f: &dyn Fn(&Row) -> Option<f64>| -> Vec<f64> {
            let own = result.rows.iter().filter(|r| r.method == method && r.linear == linear);
            own.filter_map(f).collect()
        };
        let both = |(_, f): &Column| match spread(of(f)) {
            Some((_, median, worst)) => format!("{} ({})", short(median), short(worst)),
            None => "-".to_owned(),
        };
        let both = |columns: &[Column]| columns.iter().map(both).collect::<Vec<_>>();
        let least = |f: &dyn Fn(&Row) -> f64| {
            let some = |row: &Row| (row.events > 0).then(|| f(row));
            of(&some).into_iter().fold(f64::INFINITY, f64::min)
        };
        let found =
            [format!("{:.3}", least(&|r| r.f1)), format!("{:.0}", least(&|r| r.read_percent))];
        let state = of(&|r| Some(r.state_bytes as f64)).into_iter().fold(0.0, f64::max);
        let cells = [&both(&errors)[..], &found, &both(&TIMES), &[format!("{state:.0}")]].concat();
        (method.to_owned(), cells)
    };
    let found = ["least F1", "least read %"];
    Table {
        titles: [&titles(&errors)[..], &found, &titles(&TIMES), &["state B"]].concat(),
        rows: methods(result).into_iter().map(row).collect(),
    }
}

/// Table of the scenes counted on the board: instructions and errors.
#[must_use]
pub fn board(result: &BenchResult) -> Table {
    let errors = [OVER_BOUND, RMS, P95].concat();
    let row = |row: &Row| {
        let counts = row.board.map(|on| [on.mean.to_string(), on.worst.to_string()])?;
        let noise = 0.01 * (100.0 * row.noise_percent).round();
        let name = format!("{}, {noise} %", row.scene);
        Some((name, [&counts[..], &cells(&errors, row)].concat()))
    };
    Table {
        titles: [&["instructions a sample", "worst step"][..], &titles(&errors)].concat(),
        rows: result.rows.iter().filter_map(row).collect(),
    }
}

/// Names of the methods in order.
#[must_use]
pub fn methods(result: &BenchResult) -> Vec<&str> {
    blocks(&result.rows).next().unwrap_or_default().iter().map(|row| row.method.as_str()).collect()
}

/// Smallest, median and largest.
#[must_use]
pub fn spread(mut values: Vec<f64>) -> Option<(f64, f64, f64)> {
    values.sort_by(f64::total_cmp);
    Some((*values.first()?, *values.get(values.len() / 2)?, *values.last()?))
}

/// Three significant digits, at most three decimals.
#[must_use]
pub fn short(value: f64) -> String {
    let digits = (2.0 - value.abs().max(1e-12).log10().floor()).clamp(0.0, 3.0) as usize;
    let text = format!("{value:.digits$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        return "0".to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let expected = [
            (937.4, "937"),
            (12.34, "12.3"),
            (1.0, "1.00"),
            (0.0321, "0.032"),
            (-0.0001, "0"),
            (0.0, "0"),
        ];
        for (value, text) in expected {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn the_spread_is_smallest_median_largest() {
        assert_eq!(spread(vec![3.0, 1.0, 9.0]), Some((1.0, 3.0, 9.0)));
        assert_eq!(spread(Vec::new()), None);
    }
}
