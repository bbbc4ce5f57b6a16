//! Speed against error as a picture, SVG.
//!
//! One panel for each coefficient, both axes logarithmic: time per sample to the
//! right, error over the Cramér-Rao bound upwards. A small dot is one linear scene,
//! a large mark the median of a method.

use std::fmt::Write;

use super::result::{BenchResult, Errors, Row};
use super::table::{methods, short, spread};

const WIDTH: f64 = 1040.0;
const HEIGHT: f64 = 588.0;
/// Left edges of the panels, their size and upper edge.
const LEFT: [f64; 2] = [84.0, 584.0];
const PANEL: (f64, f64) = (436.0, 388.0);
const TOP: f64 = 58.0;
/// Height of a line of text and mean width of a letter of the labels.
const LETTER: (f64, f64) = (15.0, 8.2);
/// Colours that the colour-blind tell apart too (Okabe and Ito), ours last.
const COLOURS: [&str; 6] = ["#6b6b6b", "#b87b00", "#00805c", "#0072b2", "#a6508a", "#d1430a"];

const STYLE: &str = "text{font:14px system-ui,'Segoe UI',Helvetica,Arial,sans-serif;fill:#222}\
.title{font-size:17px;font-weight:600}.panel{font-size:15px;font-weight:600}\
.note{font-size:12.5px;fill:#555}.tick{font-size:12.5px;fill:#444}\
.end{text-anchor:end}.mid{text-anchor:middle}\
.grid{stroke:#e4e4e4;fill:none}.frame{stroke:#888;fill:none}\
.limit{stroke:#222;stroke-width:1.4;stroke-dasharray:6 4;fill:none}.below{fill:#eef5ea}\
.left{fill:#f1f1f1}";

/// A logarithmic axis.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Decimal logarithms of the values at the ends.
    decades: (f64, f64),
    /// Coordinates of the ends.
    ends: (f64, f64),
}

impl Axis {
    /// From `start` to `end`, with room for all values, in half decades.
    fn around(values: &[f64], start: f64, end: f64) -> Self {
        let logs = || values.iter().filter(|v| **v > 0.0).map(|v| v.log10());
        let low = logs().fold(0.0, f64::min) - 0.2;
        let high = logs().fold(1.0, f64::max) + 0.2;
        let half = |x: f64| 0.5 * x;
        let decades = (half((2.0 * low).floor()), half((2.0 * high).ceil()));
        Self { decades, ends: (start, end) }
    }

    fn at(&self, value: f64) -> f64 {
        let (low, high) = self.decades;
        let part = (value.log10() - low) / (high - low);
        self.ends.0 + part.clamp(0.0, 1.0) * (self.ends.1 - self.ends.0)
    }

    /// Powers of ten on the axis.
    fn ticks(&self) -> impl Iterator<Item = f64> {
        let (low, high) = self.decades;
        (low.ceil() as i32..=high.floor() as i32).map(|power| 10_f64.powi(power))
    }

    fn shifted(self, by: f64) -> Self {
        Self { ends: (self.ends.0 + by, self.ends.1 + by), ..self }
    }
}

/// A rectangle that text or a mark takes: left, top, right, bottom.
type Area = (f64, f64, f64, f64);

/// One method in one panel.
#[derive(Clone, Debug)]
struct Series {
    name: &'static str,
    colour: &'static str,
    /// Time, ns, and error over the bound, one for each linear scene.
    points: Vec<(f64, f64)>,
    /// Medians of both.
    centre: (f64, f64),
}

/// The picture.
#[must_use]
pub fn svg(result: &BenchResult) -> String {
    let panels = [
        ("Static coefficient mu_s", series(result, |row| row.mu_s)),
        ("Dynamic coefficient mu", series(result, |row| row.mu)),
    ];
    let all = || panels.iter().flat_map(|(_, series)| series).flat_map(|s| &s.points);
    let times: Vec<f64> = all().map(|p| p.0).chain([result.one_pass_ns]).collect();
    let errors: Vec<f64> = all().map(|p| p.1).collect();
    let x = Axis::around(&times, LEFT[0], LEFT[0] + PANEL.0);
    let y = Axis::around(&errors, TOP + PANEL.1, TOP);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         width=\"{WIDTH}\" height=\"{HEIGHT}\">\n<title>Speed against error</title>\n\
         <style>{STYLE}</style>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    text(&mut out, "title", (LEFT[0], 28.0), "Speed against error, one event at a time");
    for ((name, series), left) in panels.iter().zip(LEFT) {
        panel(&mut out, name, series, x.shifted(left - LEFT[0]), y, result.one_pass_ns);
    }
    axis_titles(&mut out);
    legend(&mut out);
    out.push_str("</svg>\n");
    out
}

fn series(result: &BenchResult, errors: fn(&Row) -> Option<Errors>) -> Vec<Series> {
    let of = |(name, colour): (&'static str, &'static str)| {
        let own = result.rows.iter().filter(|row| row.linear && row.method == name);
        let point = |row: &Row| Some((row.ns_per_sample, errors(row)?.over_bound?));
        let points: Vec<(f64, f64)> = own.filter_map(point).collect();
        let middle = |f: fn(&(f64, f64)) -> f64| spread(points.iter().map(f).collect());
        let centre = (middle(|p| p.0)?.1, middle(|p| p.1)?.1);
        Some(Series { name, colour, points, centre })
    };
    methods(result).into_iter().zip(COLOURS).filter_map(of).collect()
}

fn panel(out: &mut String, name: &str, series: &[Series], x: Axis, y: Axis, one_pass_ns: f64) {
    let (left, right, top, bottom) = (x.ends.0, x.ends.1, y.ends.1, y.ends.0);
    text(out, "panel", (left, top - 9.0), name);
    let bound = y.at(1.0);
    let pass = x.at(one_pass_ns);
    rectangle(out, "below", (left, bound, right, bottom));
    rectangle(out, "left", (left, top, pass, bottom));
    for tick in x.ticks() {
        line(out, "grid", (x.at(tick), top), (x.at(tick), bottom));
        text(out, "tick mid", (x.at(tick), bottom + 18.0), &short_power(tick));
    }
    for tick in y.ticks() {
        line(out, "grid", (left, y.at(tick)), (right, y.at(tick)));
        text(out, "tick end", (left - 7.0, y.at(tick) + 4.5), &short_power(tick));
    }
    line(out, "limit", (left, bound), (right, bound));
    line(out, "limit", (pass, top), (pass, bottom));
    rectangle(out, "frame", (left, top, right, bottom));
    let mut taken = limit_labels(out, (pass, bound), (left, top));
    marks(out, series, x, y, &mut taken);
    labels(out, series, x, y, &mut taken);
}

/// Says what the dashed lines are; returns the areas of the words.
fn limit_labels(out: &mut String, (pass, bound): (f64, f64), (left, top): (f64, f64)) -> Vec<Area> {
    text(out, "note", (pass + 7.0, bound + 16.0), "Cramér-Rao bound");
    let turned = format!("rotate(-90 {0:.1} {1:.1})", left + 14.0, top + 8.0);
    let at = (left + 14.0, top + 8.0);
    let _ = writeln!(
        out,
        "<text class=\"note end\" x=\"{:.1}\" y=\"{:.1}\" transform=\"{turned}\">\
         one look at each sample</text>",
        at.0, at.1
    );
    vec![
        (pass, bound + 2.0, pass + 140.0, bound + 20.0),
        (pass - 6.0, top, pass + 6.0, top + PANEL.1),
        (left, bound - 1.0, left + PANEL.0, bound + 1.0),
        (left, top, pass.max(left + 18.0), top + 160.0),
    ]
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

/// Names the methods: each label near its mark, where it covers least of what is there.
fn labels(out: &mut String, series: &[Series], x: Axis, y: Axis, taken: &mut Vec<Area>) {
    for s in series {
        let label = format!("{}: {}", s.name, short(s.centre.1));
        let width = LETTER.1 * label.chars().count() as f64;
        let (cx, cy) = (x.at(s.centre.0), y.at(s.centre.1));
        let place = |(dx, dy): (f64, f64)| {
            let left = (cx + dx).clamp(x.ends.0 + 4.0, x.ends.1 - width - 4.0);
            (left, cy + dy - 0.8 * LETTER.0, left + width, cy + dy + 0.2 * LETTER.0)
        };
        // Far from its mark a label is read for another one.
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

/// Area that two rectangles share.
fn overlap(a: &Area, b: &Area) -> f64 {
    let width = (a.2.min(b.2) - a.0.max(b.0)).max(0.0);
    let height = (a.3.min(b.3) - a.1.max(b.1)).max(0.0);
    width * height
}

fn axis_titles(out: &mut String) {
    let bottom = TOP + PANEL.1;
    for left in LEFT {
        let at = (left + 0.5 * PANEL.0, bottom + 40.0);
        text(out, "mid", at, "time per sample on this host, ns");
    }
    let (x, y) = (26.0, TOP + 0.5 * PANEL.1);
    let _ = writeln!(
        out,
        "<text class=\"mid\" x=\"{x}\" y=\"{y}\" transform=\"rotate(-90 {x} {y})\">\
         rms error / Cramér-Rao bound</text>"
    );
}

fn legend(out: &mut String) {
    let y = TOP + PANEL.1 + 72.0;
    circle(out, "#222", (LEFT[0] + 8.0, y - 4.5), 7.0, "");
    text(out, "note", (LEFT[0] + 22.0, y), "median of a method over the linear scenes (value)");
    circle(out, "#222", (LEFT[0] + 350.0, y - 4.5), 2.6, "fill-opacity=\"0.45\"");
    text(out, "note", (LEFT[0] + 360.0, y), "one linear scene: five blocks, noise 0.1, 0.3, 2 %");
    let below = "Green: below the bound of one event by itself, by what earlier events of the same \
                 test tell of loading rate and omega.";
    let grey = "Grey: faster than to look at each sample once and keep the largest.";
    text(out, "note", (LEFT[0], y + 22.0), below);
    text(out, "note", (LEFT[0], y + 42.0), grey);
}

/// A power of ten as a person writes it.
fn short_power(value: f64) -> String {
    if value >= 1e4 { format!("{}k", value / 1e3) } else { format!("{value}") }
}

fn text(out: &mut String, class: &str, (x, y): (f64, f64), words: &str) {
    let _ = writeln!(out, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>");
}

fn line(out: &mut String, class: &str, a: (f64, f64), b: (f64, f64)) {
    let (x, y) = (b.0, b.1);
    let _ = writeln!(out, "<path class=\"{class}\" d=\"M{:.1} {:.1}L{x:.1} {y:.1}\"/>", a.0, a.1);
}

fn rectangle(out: &mut String, class: &str, (left, top, right, bottom): Area) {
    let (width, height) = ((right - left).max(0.0), (bottom - top).max(0.0));
    let _ = writeln!(
        out,
        "<rect class=\"{class}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" \
         height=\"{height:.1}\"/>"
    );
}

fn circle(out: &mut String, colour: &str, (x, y): (f64, f64), radius: f64, more: &str) {
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\" {more}/>"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_logarithmic() {
        let axis = Axis::around(&[2.0, 900.0], 100.0, 500.0);
        assert!((axis.at(10.0) - axis.at(1.0) - (axis.at(100.0) - axis.at(10.0))).abs() < 1e-9);
        assert!(axis.at(2.0) > 100.0 && axis.at(900.0) < 500.0);
        assert_eq!(axis.ticks().count(), 4);
    }

    #[test]
    fn overlap_is_the_common_area() {
        assert!((overlap(&(0.0, 0.0, 2.0, 2.0), &(1.0, 1.0, 5.0, 5.0)) - 1.0).abs() < 1e-12);
        assert!(overlap(&(0.0, 0.0, 2.0, 2.0), &(3.0, 0.0, 5.0, 5.0)).abs() < 1e-12);
    }
}
