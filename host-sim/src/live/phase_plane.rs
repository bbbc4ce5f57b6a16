//! Force and its rate as they arrive: the loop in which the paper reads a slip.

use floe_core::{Phase, SampleFlag};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType};

use super::state::State;

/// Number of samples by which a rate is delayed.
const DELAY: usize = 2;
/// Number of newest samples drawn: eight seconds.
const SHOWN: usize = 128;

/// Force, N, rate, N/s, and whether the block slipped; the oldest first.
#[must_use]
pub fn points(state: &State) -> Vec<(f64, f64, bool)> {
    let samples: Vec<_> = state.trace.iter().collect();
    let pairs = samples.iter().zip(samples.iter().skip(DELAY));
    let known = pairs.filter_map(|(at, later)| {
        let in_a_row = later.index == at.index + DELAY as u32 && at.flag == SampleFlag::Good;
        let (force_n, rate_n_per_s) = at.force_n.zip(later.rate_n_per_s)?;
        let finite = force_n.is_finite() && rate_n_per_s.is_finite();
        let point = (f64::from(force_n), f64::from(rate_n_per_s), at.phase == Phase::Slip);
        (in_a_row && finite).then_some(point)
    });
    let known: Vec<_> = known.collect();
    let first = known.len().saturating_sub(SHOWN);
    known.into_iter().skip(first).collect()
}

/// Factor by which the central difference reduces the rate in a slip: `sin(omega dt) / (omega dt)`.
#[must_use]
pub fn attenuation(state: &State) -> Option<f64> {
    let omega = f64::from(state.report?.omega_rad_per_s?.value);
    let angle = omega / state.rate_hz();
    (angle > 0.0).then(|| angle.sin() / angle)
}

/// Draws the phase plane into an area of any size, with onset and re-stick of the last event
/// marked.
pub fn draw(frame: &mut Frame<'_>, area: Rect, state: &State, style: Style) {
    let points = points(state);
    let of = |slips: bool| -> Vec<(f64, f64)> {
        points.iter().filter(|point| point.2 == slips).map(|point| (point.0, point.1)).collect()
    };
    let (sticks, slips) = (of(false), of(true));
    let loading = |force_n: f32, rate: f32| [(f64::from(force_n), f64::from(rate))];
    let rate = state.event.map_or(0.0, |event| event.loading_rate_n_per_s);
    let onset = state.event.map(|event| loading(event.static_force_n, rate));
    let restick = state.event.map(|event| loading(event.restick_force_n, 0.0));
    let set = |data, colour, marker| {
        let dots = Dataset::default().marker(marker).graph_type(GraphType::Scatter);
        dots.style(style.fg(colour)).data(data)
    };
    let mut sets = vec![
        set(&sticks, Color::White, Marker::Braille),
        set(&slips, Color::LightYellow, Marker::Braille),
    ];
    let marks = [(&onset, Color::LightRed), (&restick, Color::LightGreen)];
    for (mark, colour) in marks.iter().filter_map(|(mark, colour)| Some((mark.as_ref()?, colour))) {
        sets.push(set(mark, *colour, Marker::Dot));
    }
    let forces = points.iter().map(|point| point.0).fold((0.0, 1.0), widen);
    let rates = points.iter().map(|point| point.1).fold((-1.0, 1.0), widen);
    let seen = attenuation(state).map(|part| format!(", a slip's shown x {part:.2}"));
    let title = format!("F' against F{}", seen.unwrap_or_default());
    let chart = Chart::new(sets).x_axis(axis(forces, "N")).y_axis(axis(rates, "N/s"));
    frame.render_widget(chart.block(Block::new().title(title)).legend_position(None), area);
}

/// An axis with its ends and unit; one that begins slightly below zero is labelled 0, not -0.
pub(super) fn axis((low, high): (f64, f64), unit: &str) -> Axis<'static> {
    let labels = [format!("{:.0}", low.round() + 0.0), format!("{high:.0} {unit}")];
    Axis::default().bounds([low, high]).labels(labels)
}

fn widen((low, high): (f64, f64), value: f64) -> (f64, f64) {
    (low.min(value), high.max(value))
}
