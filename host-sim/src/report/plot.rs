//! Plots: axes with ticks, and the drawing between them.

use super::scale::{Scale, Steps, Ticks, ticks};
use super::svg::{Path, coordinate, escape, rectangle, text};

/// Layout of a drawing. The page holds both, for a wide screen or paper and for a phone; the style
/// sheet shows the one that fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// From about 820 px on, and on paper.
    Wide,
    /// A phone.
    Narrow,
}

impl Layout {
    /// One of two values.
    pub fn pick<T>(self, wide: T, narrow: T) -> T {
        match self {
            Self::Wide => wide,
            Self::Narrow => narrow,
        }
    }

    fn class(self) -> &'static str {
        self.pick("wide", "narrow")
    }
}

/// One axis.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Smallest and largest value of the axis.
    pub domain: (f64, f64),
    /// Spacing of the ticks.
    pub steps: Steps,
    /// Label, safe for SVG.
    pub label: String,
    /// Symbol and unit for the read-out under the pointer.
    pub readout: (&'static str, String),
}

/// Description of a plot.
#[derive(Clone, Debug)]
pub(super) struct Spec<'a> {
    /// Identifier, unique on the page within a layout.
    pub id: &'a str,
    /// Layout that the plot is for.
    pub layout: Layout,
    /// Width and height, px.
    pub size: (f64, f64),
    /// Title for readers who cannot see the plot.
    pub title: &'a str,
    /// Description for readers who cannot see the plot.
    pub description: &'a str,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
}

/// A plot that is being drawn.
#[derive(Clone, Debug)]
pub(super) struct Plot {
    /// Horizontal scale.
    pub x: Scale,
    /// Vertical scale.
    pub y: Scale,
    head: String,
    inside: String,
    above: String,
}

/// Room for the labels of the vertical axis, px, if they have up to `LEFT_DIGITS` digits.
const LEFT: f64 = 54.0;
const LEFT_DIGITS: usize = 5;
const RIGHT: f64 = 14.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 44.0;
/// Spacing of the ticks of the horizontal axis, px, where their labels are short.
const APART: f64 = 68.0;
/// Approximate width of a digit, px.
const DIGIT: f64 = 8.0;

impl Plot {
    /// An empty plot with axes, ticks and labels.
    pub fn new(spec: &Spec<'_>) -> Self {
        let (width, height) = spec.size;
        let y = Scale { domain: spec.y.domain, range: (height - BOTTOM, TOP) };
        let up = ticks(y.domain, (y.range.0 - y.range.1) / 38.0, spec.y.steps);
        let left = LEFT + DIGIT * up.longest().saturating_sub(LEFT_DIGITS) as f64;
        let x = Scale { domain: spec.x.domain, range: (left, width - RIGHT) };
        let mut plot =
            Self { x, y, head: open(spec, &x, &y), inside: String::new(), above: String::new() };
        plot.grid(spec, &up);
        plot
    }

    fn grid(&mut self, spec: &Spec<'_>, up: &Ticks) {
        let (x, y) = (self.x, self.y);
        let across = across(&x, spec.x.steps);
        let mut lines = Path::default();
        across.values.iter().for_each(|&v| lines.bar(x.at(v), y.range.0, y.range.1));
        for &value in &up.values {
            lines.move_to((x.range.0, y.at(value)));
            lines.line_to((x.range.1, y.at(value)));
        }
        self.head.push_str(&lines.element("grid"));
        let foot = y.range.0 + 18.0;
        self.head.push_str(&labels(&across, "mid", |v, width| {
            (x.at(v).min(spec.size.0 - width / 2.0), foot)
        }));
        self.head.push_str(&labels(up, "end", |v, _| (x.range.0 - 7.0, y.at(v) + 4.5)));
        let middle = (x.range.0 + x.range.1) / 2.0;
        self.head.push_str(&text("axis mid", (middle, foot + 20.0), &spec.x.label));
        self.head.push_str(&text("axis", (4.0, 16.0), &spec.y.label));
        let id = format!("{}-{}", spec.id, spec.layout.class());
        self.head.push_str(&format!("</g><g clip-path=\"url(#{id}-c)\">"));
    }

    /// The coordinates of a pair of values.
    pub fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x.at(x), self.y.at(y))
    }

    /// Draws within the axes; what lies outside is clipped.
    pub fn draw(&mut self, element: &str) {
        self.inside.push_str(element);
    }

    /// Draws on top of everything, without clipping.
    pub fn annotate(&mut self, element: &str) {
        self.above.push_str(element);
    }

    /// A line through pairs of values.
    pub fn line(&mut self, class: &str, values: impl IntoIterator<Item = (f64, f64)>) {
        let path = Path::line(values.into_iter().map(|v| self.at(v)));
        self.draw(&path.element(class));
    }

    /// Points at pairs of values; those outside the axes are left out.
    pub fn dots(&mut self, class: &str, values: impl IntoIterator<Item = (f64, f64)>) {
        let path = Path::dots(values.into_iter().filter(|&v| self.contains(v)).map(|v| self.at(v)));
        self.draw(&path.element(class));
    }

    /// Whether a pair of values lies between the axes.
    pub fn contains(&self, (x, y): (f64, f64)) -> bool {
        let within = |v: f64, (low, high): (f64, f64)| (low..=high).contains(&v);
        within(x, self.x.domain) && within(y, self.y.domain)
    }

    /// Tints the full height between two values of x, wide enough to be seen.
    pub fn shade(&mut self, class: &str, from: f64, to: f64) {
        let (low, high) = self.x.domain;
        let (from, to) = (self.x.at(from.max(low)), self.x.at(to.min(high)));
        if to > from {
            let to = to.max(from + 1.2);
            let tint = rectangle(class, (from, self.y.range.1), (to, self.y.range.0));
            self.draw(&tint);
        }
    }

    /// The whole SVG element.
    pub fn finish(self) -> String {
        let outline =
            rectangle("frame", (self.x.range.0, self.y.range.1), (self.x.range.1, self.y.range.0));
        format!("{}{}</g>{outline}{}</svg>", self.head, self.inside, self.above)
    }
}

/// The opening tags, up to the group that is clipped at the axes.
fn open(spec: &Spec<'_>, x: &Scale, y: &Scale) -> String {
    let class = spec.layout.class();
    let id = format!("{}-{class}", spec.id);
    let (width, height) = (coordinate(spec.size.0), coordinate(spec.size.1));
    let area = rectangle("", (x.range.0, y.range.1), (x.range.1, y.range.0));
    format!(
        "<svg class=\"plot {class}\" id=\"{id}\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-labelledby=\"{id}-t {id}-d\" data-x=\"{}\" data-y=\"{}\">\
         <title id=\"{id}-t\">{}</title><desc id=\"{id}-d\">{}</desc>\
         <clipPath id=\"{id}-c\">{area}</clipPath><g class=\"axes\">",
        readout(x, &spec.x),
        readout(y, &spec.y),
        escape(spec.title),
        escape(spec.description),
    )
}

/// As many ticks as there is room for their labels; the last label may be moved in from the edge by
/// nearly half its width.
fn across(x: &Scale, steps: Steps) -> Ticks {
    let apart = |px: f64| ticks(x.domain, (x.range.1 - x.range.0) / px, steps);
    let usual = apart(APART);
    let width = DIGIT * usual.longest() as f64;
    let needed = 1.5 * width - RIGHT + DIGIT;
    if needed > APART { apart(needed) } else { usual }
}

/// Scale of an axis for the script, which converts a place into a value.
fn readout(scale: &Scale, axis: &Axis) -> String {
    let ((low, high), (from, to)) = (scale.domain, scale.range);
    let (name, unit) = &axis.readout;
    format!("{low}|{high}|{}|{}|{name}|{}", coordinate(from), coordinate(to), escape(unit))
}

/// Labels of ticks; `place` takes the value and the approximate width of its label.
fn labels(ticks: &Ticks, class: &str, place: impl Fn(f64, f64) -> (f64, f64)) -> String {
    let label = |&v: &f64| {
        let label = ticks.label(v);
        let width = DIGIT * label.chars().count() as f64;
        text(class, place(v, width), &label)
    };
    ticks.values.iter().map(label).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The labels of a constant force have eight digits.
    #[test]
    fn labels_do_not_touch() {
        for domain in [(499.9997, 500.0003), (1_234.567_8, 1_234.567_9), (0.0, 800.0)] {
            let x = Scale { domain, range: (LEFT, 360.0 - RIGHT) };
            let ticks = across(&x, Steps::Decimal);
            let half = DIGIT * ticks.longest() as f64 / 2.0;
            let places: Vec<f64> =
                ticks.values.iter().map(|&v| x.at(v).min(360.0 - half)).collect();
            assert!(places.len() > 1, "{domain:?}: {places:?}");
            assert!(places.windows(2).all(|p| p[1] - p[0] > 2.0 * half), "{domain:?}: {places:?}");
        }
    }

    /// If `500.0002` were cut off on the left, it would read `0.0002`.
    #[test]
    fn the_longest_label_is_on_the_paper() {
        let left = |domain| {
            let axis = |domain| Axis {
                domain,
                steps: Steps::Decimal,
                label: String::new(),
                readout: ("F", String::new()),
            };
            let spec = Spec {
                id: "p",
                layout: Layout::Narrow,
                size: (360.0, 230.0),
                title: "",
                description: "",
                x: axis((0.0, 1.0)),
                y: axis(domain),
            };
            Plot::new(&spec).x.range.0
        };
        assert!((left((0.0, 800.0)) - LEFT).abs() < 1e-9);
        let longest = DIGIT * "500.0002".len() as f64;
        assert!(left((499.9997, 500.0003)) > longest);
    }
}
