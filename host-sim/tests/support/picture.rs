//! A terminal's screen as SVG: one text element per run of equal style in a row.

use std::fmt::Write;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

/// Size of a character, px.
const WIDTH: usize = 9;
const HEIGHT: usize = 19;

pub fn svg(buffer: &Buffer) -> String {
    let (columns, rows) = (usize::from(buffer.area.width), usize::from(buffer.area.height));
    let (width, height) = (columns * WIDTH + 20, rows * HEIGHT + 20);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"DejaVu Sans Mono, Menlo, Consolas, monospace\" \
         font-size=\"15\">\n<rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#10161c\"/>\n"
    );
    for (row, cells) in buffer.content.chunks(columns.max(1)).enumerate() {
        let mut column = 0;
        for run in cells.chunk_by(|a, b| (a.fg, a.bg, a.modifier) == (b.fg, b.bg, b.modifier)) {
            stretch(&mut svg, run, 10 + column * WIDTH, 10 + row * HEIGHT);
            column += run.len();
        }
    }
    svg + "</svg>\n"
}

fn stretch(svg: &mut String, run: &[Cell], x: usize, y: usize) {
    let (first, width) = (&run[0], run.len() * WIDTH);
    if first.bg != Color::Reset {
        let fill = colour(first.bg);
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{HEIGHT}\" fill=\"{fill}\"/>"
        );
    }
    let text: String = run.iter().map(Cell::symbol).collect();
    if text.trim().is_empty() {
        return;
    }
    let bold = if first.modifier.contains(Modifier::BOLD) { " font-weight=\"bold\"" } else { "" };
    let (fill, base) = (colour(first.fg), y + 15);
    // A space that a browser does not collapse.
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace(' ', "\u{a0}");
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"{base}\" textLength=\"{width}\" fill=\"{fill}\"{bold}>{text}</text>"
    );
}

fn colour(colour: Color) -> &'static str {
    const KNOWN: [(Color, &str); 8] = [
        (Color::Black, "#10161c"),
        (Color::Red, "#c0392b"),
        (Color::Green, "#3fae6b"),
        (Color::Yellow, "#f0c05a"),
        (Color::LightYellow, "#f0c05a"),
        (Color::LightRed, "#ff8a75"),
        (Color::DarkGray, "#8a97a4"),
        (Color::Gray, "#8a97a4"),
    ];
    KNOWN.iter().find(|(known, _)| *known == colour).map_or("#e8edf2", |(_, shown)| shown)
}
