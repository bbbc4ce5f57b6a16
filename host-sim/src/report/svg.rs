//! Building blocks of SVG for the figures.

use std::fmt::Write;

/// Text made safe for HTML, SVG and their attributes. Characters that XML does
/// not allow become U+FFFD.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            _ => safe.push(c),
        }
    }
    safe
}

/// A coordinate with at most one decimal, limited to a value far outside the drawing.
pub(super) fn coordinate(x: f64) -> String {
    const FAR: f64 = 1e5;
    let x = if x.is_nan() { 0.0 } else { x.clamp(-FAR, FAR) };
    let text = format!("{x:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.into() }
}

/// The `d` of a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    d: String,
}

impl Path {
    fn command(&mut self, letter: char, (x, y): (f64, f64)) {
        let _ = write!(self.d, "{letter}{} {}", coordinate(x), coordinate(y));
    }

    /// Starts a line.
    pub fn move_to(&mut self, point: (f64, f64)) {
        self.command('M', point);
    }

    /// Continues the line.
    pub fn line_to(&mut self, point: (f64, f64)) {
        self.command('L', point);
    }

    /// A point: a line of zero length, visible by its round caps.
    pub fn dot(&mut self, point: (f64, f64)) {
        self.command('M', point);
        self.d.push_str("h0");
    }

    /// A vertical line.
    pub fn bar(&mut self, x: f64, y0: f64, y1: f64) {
        self.command('M', (x, y0));
        let _ = write!(self.d, "V{}", coordinate(y1));
    }

    /// Closes the outline, if there is one.
    pub fn close(&mut self) {
        if !self.d.is_empty() {
            self.d.push('Z');
        }
    }

    /// A line through points; a point that is not finite interrupts it, and one between two such is
    /// a dot.
    pub fn line(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
        let (mut path, mut drawing) = (Self::default(), false);
        let mut points = points.into_iter().peekable();
        while let Some(point) = points.next() {
            match (finite(&point), drawing) {
                (true, true) => path.line_to(point),
                (true, false) if points.peek().is_some_and(finite) => path.move_to(point),
                (true, false) => path.dot(point),
                (false, _) => {}
            }
            drawing = finite(&point);
        }
        path
    }

    /// Points.
    pub fn dots(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut path = Self::default();
        points.into_iter().filter(|p| p.0.is_finite() && p.1.is_finite()).for_each(|p| path.dot(p));
        path
    }

    /// The element; an empty text for an empty path.
    pub fn element(&self, class: &str) -> String {
        if self.d.is_empty() {
            return String::new();
        }
        format!("<path class=\"{class}\" d=\"{}\"/>", self.d)
    }
}

/// A rectangle between two corners.
pub(super) fn rectangle(class: &str, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> String {
    let (x, y) = (coordinate(x0.min(x1)), coordinate(y0.min(y1)));
    let (width, height) = (coordinate((x1 - x0).abs()), coordinate((y1 - y0).abs()));
    format!("<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>")
}

/// Text that is safe already; `class` sets the anchor.
pub(super) fn text(class: &str, (x, y): (f64, f64), safe: &str) -> String {
    let (x, y) = (coordinate(x), coordinate(y));
    format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{safe}</text>")
}

/// A symbol for SVG text, like `F` with a subscript.
pub(super) fn symbol(letter: &str, subscript: &str) -> String {
    format!(
        "<tspan class=\"sym\">{letter}</tspan><tspan class=\"sub\" dy=\"3\">{subscript}</tspan>"
    )
}

/// Shapes of the marks, distinguishable without colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// `Fs`: a circle.
    Static,
    /// `Fp`: a diamond.
    Dynamic,
    /// `Fe`: a square.
    Restick,
}

impl Mark {
    /// The mark around a point.
    pub fn at(self, (x, y): (f64, f64)) -> String {
        let p = |dx: f64, dy: f64| format!("{} {}", coordinate(x + dx), coordinate(y + dy));
        let (class, d) = match self {
            Self::Static => {
                ("m-static", format!("M{}a5 5 0 1 1 10 0a5 5 0 1 1-10 0Z", p(-5.0, 0.0)))
            }
            Self::Dynamic => (
                "m-dynamic",
                format!("M{}L{}L{}L{}Z", p(0.0, -6.5), p(6.5, 0.0), p(0.0, 6.5), p(-6.5, 0.0)),
            ),
            Self::Restick => ("m-restick", format!("M{}h9v9h-9Z", p(-4.5, -4.5))),
        };
        format!("<path class=\"mark {class}\" d=\"{d}\"/>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_made_safe() {
        assert_eq!(escape("a<b>&\"'\u{1}\n"), "a&lt;b&gt;&amp;&quot;&#39;\u{fffd} ");
    }

    #[test]
    fn a_gap_breaks_the_line() {
        let points = [(0.0, 0.0), (1.04, 2.0), (2.0, f64::NAN), (3.0, 1.0), (4.0, -0.01)];
        assert_eq!(Path::line(points).d, "M0 0L1 2M3 1L4 0");
        let gap = (1.0, f64::NAN);
        assert_eq!(Path::line([(0.0, 1.0), gap, (2.0, 1.0)]).d, "M0 1h0M2 1h0");
        let mut none = Path::line([]);
        none.close();
        assert_eq!(none.element("x"), "");
    }
}
