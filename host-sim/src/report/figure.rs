//! A figure of the page: drawings for both layouts, a legend, a caption.

use super::plot::Layout;
use super::svg::Mark;

/// Parts of a figure; every text is safe for HTML.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// CSS class of the element.
    pub class: &'static str,
    /// The drawings, each for both layouts.
    pub drawings: Vec<[String; 2]>,
    /// Entries of the legend.
    pub keys: Vec<String>,
    /// Caption without the number of the figure.
    pub caption: String,
}

/// A drawing for both layouts.
pub(super) fn both(draw: impl Fn(Layout) -> String) -> [String; 2] {
    [Layout::Wide, Layout::Narrow].map(draw)
}

/// A legend entry: a line of this CSS class.
pub(super) fn line_key(class: &str, label: &str) -> String {
    key(&format!("<path class=\"{class}\" d=\"M2 8H26\"/>"), label)
}

/// A legend entry: dots.
pub(super) fn dot_key(class: &str, label: &str) -> String {
    key(&format!("<path class=\"{class}\" d=\"M6 8h0M14 8h0M22 8h0\"/>"), label)
}

/// A legend entry: a tint.
pub(super) fn tint_key(class: &str, label: &str) -> String {
    key(
        &format!("<rect class=\"{class} edge\" x=\"2\" y=\"2\" width=\"24\" height=\"12\"/>"),
        label,
    )
}

/// The legend entries for `Fs`, `Fp` and `Fe`.
pub(super) fn mark_keys() -> [String; 3] {
    [
        (Mark::Static, "<i>F</i><sub>s</sub> slip onset"),
        (Mark::Dynamic, "<i>F</i><sub>p</sub> centre of the ellipse"),
        (Mark::Restick, "<i>F</i><sub>e</sub> re-stick"),
    ]
    .map(|(mark, label)| key(&mark.at((14.0, 8.0)), label))
}

fn key(drawing: &str, label: &str) -> String {
    format!(
        "<span class=\"key\"><svg width=\"28\" height=\"16\" viewBox=\"0 0 28 16\" \
         aria-hidden=\"true\">{drawing}</svg><span>{label}</span></span>"
    )
}

impl Figure {
    /// The HTML element.
    pub fn html(&self, number: usize) -> String {
        let drawings = self.drawings.iter();
        let drawings =
            drawings.map(|[wide, narrow]| format!("<div class=\"draw\">{wide}{narrow}</div>"));
        format!(
            "<figure class=\"{}\"><div class=\"draws\">{}</div><div class=\"keys\">{}</div>\
             <figcaption><b>Figure {number}.</b> {}</figcaption></figure>\n",
            self.class,
            drawings.collect::<String>(),
            self.keys.concat(),
            self.caption
        )
    }
}
