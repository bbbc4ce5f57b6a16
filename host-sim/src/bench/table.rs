//! The comparison as aligned text, or as Markdown.

use std::fmt::Write;

use super::result::{BenchResult, Errors, Row};

/// Titles of the columns after the method's name.
pub const TITLES: [&str; 13] = [
    "mu_s/bound",
    "mu/bound",
    "mu_s rms %",
    "mu rms %",
    "mu_s bias %",
    "mu bias %",
    "mu_s 95 %",
    "mu 95 %",
    "F1",
    "read %",
    "delay ms",
    "ns/sample",
    "worst ns",
];
/// The last column: fixed for a method, so only in the summary.
const STATE: &str = "state B";

/// A block of text for each scene, then the summary.
#[must_use]
pub fn text(result: &BenchResult) -> String {
    let mut out = String::new();
    for block in blocks(&result.rows) {
        let _ = writeln!(out, "{}", heading(block));
        let rows = block.iter().map(|row| (row.method.as_str(), cells(row).to_vec()));
        lines(&mut out, &TITLES, rows);
        out.push('\n');
    }
    for (kind, linear) in [("Linear", true), ("Hard", false)] {
        let _ = writeln!(out, "{kind} scenes: median (worst)");
        lines(&mut out, &SUMMARY_TITLES, summary(result, linear));
        out.push('\n');
    }
    let _ = writeln!(out, "one look at each sample: {:.2} ns", result.one_pass_ns);
    let _ = writeln!(out, "seeds from {} on in every scene", result.first_seed);
    if result.host.debug_build {
        let _ = writeln!(out, "built without optimisation: times mean little");
    }
    out
}

/// The rows of one scene each.
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

fn lines<'a>(
    out: &mut String,
    titles: &[&str],
    rows: impl Iterator<Item = (&'a str, Vec<String>)>,
) {
    let rows: Vec<(&str, Vec<String>)> = rows.collect();
    let width = |i: usize| {
        let cells = rows.iter().filter_map(|(_, cells)| cells.get(i)).map(|cell| cell.len());
        cells.chain(titles.get(i).map(|title| title.len())).max().unwrap_or(0) + 2
    };
    let _ = write!(out, "{:<24}", "");
    for (i, title) in titles.iter().enumerate() {
        let _ = write!(out, "{title:>0$}", width(i));
    }
    out.push('\n');
    for (name, cells) in &rows {
        let _ = write!(out, "{name:<24}");
        for (i, cell) in cells.iter().enumerate() {
            let _ = write!(out, "{cell:>0$}", width(i));
        }
        out.push('\n');
    }
}

/// The cells of a row under [`TITLES`].
#[must_use]
pub fn cells(row: &Row) -> [String; 13] {
    let of = |errors: Option<Errors>, f: fn(&Errors) -> Option<f64>| {
        errors.as_ref().and_then(f).map_or_else(|| "-".to_owned(), short)
    };
    let some = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
    [
        of(row.mu_s, |e| e.over_bound),
        of(row.mu, |e| e.over_bound),
        of(row.mu_s, |e| Some(e.rms_percent)),
        of(row.mu, |e| Some(e.rms_percent)),
        of(row.mu_s, |e| Some(e.bias_percent)),
        of(row.mu, |e| Some(e.bias_percent)),
        of(row.mu_s, |e| Some(e.p95_percent)),
        of(row.mu, |e| Some(e.p95_percent)),
        format!("{:.3}", row.f1),
        format!("{:.0}", row.read_percent),
        some(row.onset_delay_ms),
        short(row.ns_per_sample),
        some(row.worst_tick_ns),
    ]
}

/// Titles of the summaries.
pub const SUMMARY_TITLES: [&str; 12] = [
    "mu_s/bound",
    "mu/bound",
    "mu_s rms %",
    "mu rms %",
    "mu_s 95 %",
    "mu 95 %",
    "least F1",
    "least read %",
    "delay ms",
    "ns/sample",
    "worst ns",
    STATE,
];

/// Each method over the linear or the hard scenes: median, and the worst in brackets.
pub fn summary(
    result: &BenchResult,
    linear: bool,
) -> impl Iterator<Item = (&str, Vec<String>)> + '_ {
    methods(result).into_iter().map(move |method| {
        let of = |f: &dyn Fn(&Row) -> Option<f64>| -> Vec<f64> {
            let own = result.rows.iter().filter(|r| r.method == method && r.linear == linear);
            own.filter_map(f).collect()
        };
        let both = |f: &dyn Fn(&Row) -> Option<f64>| match spread(of(f)) {
            Some((_, median, worst)) => format!("{} ({})", short(median), short(worst)),
            None => "-".to_owned(),
        };
        let least = |f: &dyn Fn(&Row) -> f64| {
            let some = |row: &Row| (row.events > 0).then(|| f(row));
            of(&some).into_iter().fold(f64::INFINITY, f64::min)
        };
        let state = of(&|r| Some(r.state_bytes as f64)).into_iter().fold(0.0, f64::max);
        let cells = vec![
            both(&|r| r.mu_s.and_then(|e| e.over_bound)),
            both(&|r| r.mu.and_then(|e| e.over_bound)),
            both(&|r| r.mu_s.map(|e| e.rms_percent)),
            both(&|r| r.mu.map(|e| e.rms_percent)),
            both(&|r| r.mu_s.map(|e| e.p95_percent)),
            both(&|r| r.mu.map(|e| e.p95_percent)),
            format!("{:.3}", least(&|r| r.f1)),
            format!("{:.0}", least(&|r| r.read_percent)),
            both(&|r| r.onset_delay_ms),
            both(&|r| Some(r.ns_per_sample)),
            both(&|r| r.worst_tick_ns),
            format!("{state:.0}"),
        ];
        (method, cells)
    })
}

/// Titles of the table of the board.
pub const BOARD_TITLES: [&str; 8] = [
    "instructions a sample",
    "worst step",
    "mu_s/bound",
    "mu/bound",
    "mu_s rms %",
    "mu rms %",
    "mu_s 95 %",
    "mu 95 %",
];

/// The scenes that were counted on the board: instructions beside errors.
pub fn board(result: &BenchResult) -> impl Iterator<Item = (String, Vec<String>)> + '_ {
    result.rows.iter().filter_map(|row| {
        let on = row.board?;
        let noise = 0.01 * (100.0 * row.noise_percent).round();
        let errors = cells(row).into_iter().take(8);
        let errors = errors.enumerate().filter(|(i, _)| !(4..6).contains(i)).map(|(_, it)| it);
        let counts = [on.mean.to_string(), on.worst.to_string()];
        Some((format!("{}, {noise} %", row.scene), counts.into_iter().chain(errors).collect()))
    })
}

/// The methods in their order.
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
