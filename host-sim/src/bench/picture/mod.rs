//! Speed against error as an SVG picture.
//!
//! One column per coefficient, both axes logarithmic: time per sample to the right, error upwards.
//! The rows are linear scenes relative to the Cramér-Rao bound, linear scenes in percent of the
//! coefficient, and hard scenes in percent. A small dot is one scene, a large mark is the median of
//! a method.

mod axis;
mod draw;
mod panel;

use std::fmt::Write;

use super::result::{BenchResult, Errors, Row};
use super::table::{methods, spread};
use axis::Axis;
use draw::{circle, text};
use panel::{PANEL, Panel, Series};

const WIDTH: f64 = 1040.0;
const HEIGHT: f64 = 1272.0;
/// Left edges of the columns, upper edges of the rows.
const LEFT: [f64; 2] = [84.0, 584.0];
const TOP: [f64; 3] = [72.0, 448.0, 824.0];
/// Colours that colour-blind readers can distinguish (Okabe and Ito); the last one is Floe's.
const COLOURS: [&str; 6] = ["#6b6b6b", "#b87b00", "#00805c", "#0072b2", "#a6508a", "#d1430a"];

const STYLE: &str = "text{font:14px system-ui,'Segoe UI',Helvetica,Arial,sans-serif;fill:#222}\
.title{font-size:17px;font-weight:600}.panel{font-size:15px;font-weight:600}\
.note{font-size:12.5px;fill:#555}.tick{font-size:12.5px;fill:#444}\
.end{text-anchor:end}.mid{text-anchor:middle}\
.grid{stroke:#e4e4e4;fill:none}.frame{stroke:#888;fill:none}\
.limit{stroke:#222;stroke-width:1.4;stroke-dasharray:6 4;fill:none}.below{fill:#eef5ea}\
.left{fill:#f1f1f1}";

/// Selects an error of a method in a scene.
type Of = fn(&Errors) -> Option<f64>;

/// Selects a coefficient of a row.
type Coefficient = fn(&Row) -> Option<Errors>;

/// A row of panels: its scenes and errors.
struct Kind {
    title: &'static str,
    axis: &'static str,
    linear: bool,
    of: Of,
    in_bounds: bool,
}

const KINDS: [Kind; 3] = [
    Kind {
        title: "linear scenes, in bounds",
        axis: "rms error / Cramér-Rao bound",
        linear: true,
        of: |errors| errors.over_bound,
        in_bounds: true,
    },
    Kind {
        title: "linear scenes, in percent",
        axis: "rms error, % of the coefficient",
        linear: true,
        of: |errors| Some(errors.rms_percent),
        in_bounds: false,
    },
    Kind {
        title: "hard scenes, in percent",
        axis: "rms error, % of the coefficient",
        linear: false,
        of: |errors| Some(errors.rms_percent),
        in_bounds: false,
    },
];

/// The picture.
#[must_use]
pub fn svg(result: &BenchResult) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         width=\"{WIDTH}\" height=\"{HEIGHT}\">\n<title>Speed against error</title>\n\
         <style>{STYLE}</style>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    text(&mut out, "title", (LEFT[0], 28.0), "Speed against error, one event at a time");
    for panel in panels(result) {
        panel::draw(&mut out, &panel);
    }
    axis_titles(&mut out);
    legend(&mut out, result);
    out.push_str("</svg>\n");
    out
}

/// All panels, with a common time axis and a common error axis per unit.
fn panels(result: &BenchResult) -> Vec<Panel<'_>> {
    let coefficients: [(&str, Coefficient); 2] =
        [("Static coefficient mu_s", |row| row.mu_s), ("Dynamic coefficient mu", |row| row.mu)];
    let passes = std::iter::once(result.one_pass_ns);
    let times: Vec<f64> = result.rows.iter().map(|row| row.ns_per_sample).chain(passes).collect();
    let mut panels = Vec::new();
    for (kind, top) in KINDS.iter().zip(TOP) {
        let errors = errors(result, kind.in_bounds);
        for ((name, coefficient), left) in coefficients.iter().zip(LEFT) {
            panels.push(Panel {
                title: format!("{name}: {}", kind.title),
                series: series(result, kind, *coefficient),
                x: Axis::around(&times, left, left + PANEL.0),
                y: Axis::around(&errors, top + PANEL.1, top),
                in_bounds: kind.in_bounds,
                one_pass_ns: result.one_pass_ns,
            });
        }
    }
    panels
}

/// Errors of both coefficients in all panels with the same unit.
fn errors(result: &BenchResult, in_bounds: bool) -> Vec<f64> {
    let kinds = KINDS.iter().filter(|kind| kind.in_bounds == in_bounds);
    let own = kinds.flat_map(|kind| {
        let rows = result.rows.iter().filter(|row| row.linear == kind.linear);
        rows.flat_map(|row| [row.mu_s, row.mu]).filter_map(|errors| (kind.of)(&errors?))
    });
    own.collect()
}

fn series<'a>(result: &'a BenchResult, kind: &Kind, coefficient: Coefficient) -> Vec<Series<'a>> {
    let of = |(name, colour): (&'a str, &'static str)| {
        let own = result.rows.iter().filter(|row| row.linear == kind.linear && row.method == name);
        let point = |row: &Row| Some((row.ns_per_sample, (kind.of)(&coefficient(row)?)?));
        let points: Vec<(f64, f64)> = own.filter_map(point).collect();
        let middle = |f: fn(&(f64, f64)) -> f64| spread(points.iter().map(f).collect());
        let centre = (middle(|p| p.0)?.1, middle(|p| p.1)?.1);
        Some(Series { name, colour, points, centre })
    };
    methods(result).into_iter().zip(COLOURS).filter_map(of).collect()
}

fn axis_titles(out: &mut String) {
    for (kind, top) in KINDS.iter().zip(TOP) {
        for left in LEFT {
            let at = (left + 0.5 * PANEL.0, top + PANEL.1 + 38.0);
            text(out, "mid", at, "time per sample on this host, ns");
        }
        let (x, y) = (26.0, top + 0.5 * PANEL.1);
        let _ = writeln!(
            out,
            "<text class=\"mid\" x=\"{x}\" y=\"{y}\" transform=\"rotate(-90 {x} {y})\">{}</text>",
            kind.axis
        );
    }
}

fn legend(out: &mut String, result: &BenchResult) {
    let y = TOP[2] + PANEL.1 + 68.0;
    circle(out, "#222", (LEFT[0] + 8.0, y - 4.5), 7.0, "");
    text(out, "note", (LEFT[0] + 22.0, y), "median of a method over the scenes (value)");
    circle(out, "#222", (LEFT[0] + 350.0, y - 4.5), 2.6, "fill-opacity=\"0.45\"");
    text(
        out,
        "note",
        (LEFT[0] + 360.0, y),
        "one scene; linear ones: five blocks, noise 0.1, 0.3, 2 %",
    );
    let below = "Green: below the bound of one event by itself, by what earlier events of the same \
                 test tell of loading rate and omega.";
    let grey = "Grey: faster than to look at each sample once and keep the largest.";
    text(out, "note", (LEFT[0], y + 20.0), below);
    text(out, "note", (LEFT[0], y + 38.0), grey);
    text(out, "note", (LEFT[0], y + 56.0), &board(result));
}

/// Text with Floe's cost on the board, if it was counted.
fn board(result: &BenchResult) -> String {
    let median = |linear: bool| {
        let own = result.rows.iter().filter(|row| row.linear == linear);
        Some(spread(own.filter_map(|row| Some(row.board?.mean as f64)).collect())?.1)
    };
    let Some((linear, hard)) = median(true).zip(median(false)) else { return String::new() };
    format!(
        "floe on the board, a Cortex-M4F: {linear:.0} instructions a sample in the median linear scene, {hard:.0} in \
         the median hard one."
    )
}
