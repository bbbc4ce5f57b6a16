//! Shapes and text as SVG.

use std::fmt::Write;

/// A rectangle: left, top, right, bottom.
pub(super) type Area = (f64, f64, f64, f64);

pub(super) fn text(out: &mut String, class: &str, (x, y): (f64, f64), words: &str) {
    let _ = writeln!(out, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>");
}

pub(super) fn line(out: &mut String, class: &str, a: (f64, f64), b: (f64, f64)) {
    let (x, y) = (b.0, b.1);
    let _ = writeln!(out, "<path class=\"{class}\" d=\"M{:.1} {:.1}L{x:.1} {y:.1}\"/>", a.0, a.1);
}

pub(super) fn rectangle(out: &mut String, class: &str, (left, top, right, bottom): Area) {
    let (width, height) = ((right - left).max(0.0), (bottom - top).max(0.0));
    let _ = writeln!(
        out,
        "<rect class=\"{class}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" \
         height=\"{height:.1}\"/>"
    );
}

pub(super) fn circle(out: &mut String, colour: &str, (x, y): (f64, f64), radius: f64, more: &str) {
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\" {more}/>"
    );
}

/// Area shared by two rectangles.
pub(super) fn overlap(a: &Area, b: &Area) -> f64 {
    let width = (a.2.min(b.2) - a.0.max(b.0)).max(0.0);
    let height = (a.3.min(b.3) - a.1.max(b.1)).max(0.0);
    width * height
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_is_the_common_area() {
        assert!((overlap(&(0.0, 0.0, 2.0, 2.0), &(1.0, 1.0, 5.0, 5.0)) - 1.0).abs() < 1e-12);
        assert!(overlap(&(0.0, 0.0, 2.0, 2.0), &(3.0, 0.0, 5.0, 5.0)).abs() < 1e-12);
    }
}
