//! A panel: one coefficient in one kind of scenes.

use std::fmt::Write;

use super::super::table::short;
use super::axis::{Axis, short_power};
use super::draw::{Area, circle, line, overlap, rectangle, text};

/// Width and height.
pub(super) const PANEL: (f64, f64) = (436.0, 300.0);
/// Height of a line of text, and mean width of a letter, in labels.
const LETTER: (f64, f64) = (15.0, 8.2);

/// Data of one method in one panel.
#[derive(Clone, Debug)]
pub(super) struct Series<'a> {
    pub(super) name: &'a str,
    pub(super) colour: &'static str,
    /// Time, ns, and error of each scene.
    pub(super) points: Vec<(f64, f64)>,
    /// Medians of time and error.
    pub(super) centre: (f64, f64),
}

/// Content and axes of a panel.
#[derive(Clone, Debug)]
pub(super) struct Panel<'a> {
    pub(super) title: String,
    pub(super) series: Vec<Series<'a>>,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Whether errors are relative to the bound, so that 1 is a limit.
    pub(super) in_bounds: bool,
    /// Time to read each sample once, ns.
    pub(super) one_pass_ns: f64,
}

/// Draws a panel.
pub(super) fn draw(out: &mut String, panel: &Panel) {
    let Panel { title, x, y, in_bounds, one_pass_ns, .. } = panel;
    let (left, right, top, bottom) = (x.ends.0, x.ends.1, y.ends.1, y.ends.0);
    text(out, "panel", (left, top - 9.0), title);
    let (bound, pass) = (y.at(1.0), x.at(*one_pass_ns));
    if *in_bounds {
        rectangle(out, "below", (left, bound, right, bottom));
    }
    rectangle(out, "left", (left, top, pass, bottom));
    for tick in x.ticks() {
        line(out, "grid", (x.at(tick), top), (x.at(tick), bottom));
        text(out, "tick mid", (x.at(tick), bottom + 18.0), &short_power(tick));
    }
    for tick in y.ticks() {
        line(out, "grid", (left, y.at(tick)), (right, y.at(tick)));
        text(out, "tick end", (left - 7.0, y.at(tick) + 4.5), &short_power(tick));
    }
    let mut taken = vec![pass_label(out, pass, (left, top))];
    line(out, "limit", (pass, top), (pass, bottom));
    if *in_bounds {
        line(out, "limit", (left, bound), (right, bound));
        text(out, "note", (pass + 7.0, bound + 16.0), "Cramér-Rao bound");
        taken.push((pass, bound + 2.0, pass + 140.0, bound + 20.0));
        taken.push((left, bound - 1.0, right, bound + 1.0));
    }
    rectangle(out, "frame", (left, top, right, bottom));
    marks(out, &panel.series, *x, *y, &mut taken);
    labels(out, &panel.series, *x, *y, &mut taken);
}

/// Labels the vertical dashed line; returns the area of the line and the label.
fn pass_label(out: &mut String, pass: f64, (left, top): (f64, f64)) -> Area {
    let at = (left + 14.0, top + 8.0);
    let turned = format!("rotate(-90 {0:.1} {1:.1})", at.0, at.1);
    let _ = writeln!(
        out,
        "<text class=\"note end\" x=\"{:.1}\" y=\"{:.1}\" transform=\"{turned}\">\
         one look at each sample</text>",
        at.0, at.1
    );
    (left, top, (pass + 6.0).max(left + 18.0), top + PANEL.1)
}

fn marks(out: &mut String, series: &[Series], x: Axis, y: Axis, taken: &mut Vec<Area>) {
    for s in series {
        for &(time, error) in &s.points {
            let at = (x.at(time), y.at(error));
            circle(out, s.colour, at, 2.6, "fill-opacity=\"0.45\"");
            taken.push((at.0 - 2.0, at.1 - 2.0, at.0 + 2.0, at.1 + 2.0));
        }
    }
    for s in series {
        let at = (x.at(s.centre.0), y.at(s.centre.1));
        circle(out, s.colour, at, 7.0, "stroke=\"#fff\" stroke-width=\"1.5\"");
        taken.push((at.0 - 8.0, at.1 - 8.0, at.0 + 8.0, at.1 + 8.0));
    }
}

/// Labels the methods near their marks, where a label covers least.
fn labels(out: &mut String, series: &[Series], x: Axis, y: Axis, taken: &mut Vec<Area>) {
    for s in series {
        let label = format!("{}: {}", s.name, short(s.centre.1));
        let width = LETTER.1 * label.chars().count() as f64;
        let (cx, cy) = (x.at(s.centre.0), y.at(s.centre.1));
        let place = |(dx, dy): (f64, f64)| {
            let left = (cx + dx).clamp(x.ends.0 + 4.0, x.ends.1 - width - 4.0);
            (left, cy + dy - 0.8 * LETTER.0, left + width, cy + dy + 0.2 * LETTER.0)
        };
        // A distant label would be read as that of another mark.
        let distance = |area: &Area| 3.0 * (0.5 * (area.1 + area.3) - cy).abs();
        let side = -width - 13.0;
        let rows = [4.5, -14.0, 23.0, -32.0, 41.0, -50.0, 59.0];
        let tries = rows.into_iter().flat_map(|dy| [(13.0, dy), (side, dy), (-0.5 * width, dy)]);
        let inside = |area: &Area| area.1 > y.ends.1 && area.3 < y.ends.0;
        let covered = |area: &Area| {
            taken.iter().map(|other| overlap(area, other)).sum::<f64>() + distance(area)
        };
        let places = tries.map(place).filter(inside);
        let Some(best) = places.min_by(|a, b| covered(a).total_cmp(&covered(b))) else { continue };
        let _ = writeln!(
            out,
            "<text style=\"fill:{};font-weight:600;font-size:13.5px\" x=\"{:.1}\" y=\"{:.1}\">{}\
             </text>",
            s.colour,
            best.0,
            best.3 - 0.2 * LETTER.0,
            label
        );
        taken.push(best);
    }
}
