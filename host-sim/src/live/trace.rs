//! The force of the last 30 s.

use std::collections::VecDeque;

use floe_core::{Phase, SampleFlag};
use floe_firmware::line::LiveSample;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::widgets::{Axis, Chart, Dataset, GraphType};

use super::phase_plane::axis;
use super::state::{State, TRACE_LEN};

/// Consecutive points of one phase, without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Whether the block moves.
    pub slips: bool,
    /// Time before the last sample (negative), s, and force, N.
    pub points: Vec<(f64, f64)>,
}

/// The trace as pieces; a gap or an unusable sample separates them.
#[must_use]
pub fn pieces(trace: &VecDeque<LiveSample>, rate_hz: f64) -> Vec<Piece> {
    let Some(last) = trace.back() else { return Vec::new() };
    let mut pieces: Vec<Piece> = Vec::new();
    let mut whole = false;
    for sample in trace {
        let force = sample.force_n.filter(|_| sample.flag == SampleFlag::Good);
        let Some(force_n) = force.filter(|force| force.is_finite()) else {
            whole = false;
            continue;
        };
        let ago = last.index.saturating_sub(sample.index) as f64;
        let point = (-ago / rate_hz, f64::from(force_n));
        let slips = sample.phase == Phase::Slip;
        match pieces.last_mut().filter(|_| whole && sample.gap == 0) {
            Some(piece) if piece.slips == slips => piece.points.push(point),
            // The line continues in another colour.
            Some(piece) => {
                piece.points.push(point);
                pieces.push(Piece { slips, points: vec![point] });
            }
            None => pieces.push(Piece { slips, points: vec![point] }),
        }
        whole = true;
    }
    pieces
}

/// Draws the trace into an area of any size.
pub fn draw(frame: &mut Frame<'_>, area: Rect, state: &State, style: Style) {
    let rate_hz = state.rate_hz();
    let window_s = TRACE_LEN as f64 / rate_hz;
    let pieces = pieces(&state.trace, rate_hz);
    let (low, high) = bounds(&pieces);
    let lines = pieces.iter().map(|piece| {
        let colour = if piece.slips { Color::LightYellow } else { Color::White };
        Dataset::default()
            .marker(Marker::Braille)
            .graph_type(GraphType::Line)
            .style(style.fg(colour))
            .data(&piece.points)
    });
    let start = format!("-{window_s:.0} s");
    let x = Axis::default().bounds([-window_s, 0.0]).labels([start, "now".to_string()]);
    let chart = Chart::new(lines.collect()).x_axis(x).y_axis(axis((low, high), "N"));
    frame.render_widget(chart, area);
}

/// Range of the axis: zero is always included, and the upper end changes in steps to avoid jumps.
fn bounds(pieces: &[Piece]) -> (f64, f64) {
    let forces = || pieces.iter().flat_map(|piece| &piece.points).map(|point| point.1);
    let step = |force: f64| {
        let size = 10_f64.powf(force.log10().floor());
        [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
            .map(|factor| factor * size)
            .into_iter()
            .find(|&limit| limit >= force)
            .unwrap_or(force)
    };
    let high = forces().fold(1.0, f64::max);
    let low = forces().fold(0.0, f64::min);
    // A small offset of the zero is no force.
    let low = if low < -0.05 * high { -step(-low) } else { low };
    (low, step(high))
}
