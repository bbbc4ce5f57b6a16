//! Residuals of the fits: samples minus model, all events superposed.

use super::context::Context;
use super::figure::{Figure, both, dot_key, tint_key};
use super::fit::{model_n, reach_s};
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, extent};
use super::svg::rectangle;
use crate::log::timing::median;
use crate::replay::result::EventSummary;

/// Most samples drawn, in full events from the beginning.
const MOST_SAMPLES: usize = 4000;
/// Time shown on either side of a slip, in slip lengths.
const BESIDE: f64 = 2.0;
/// Residual, in standard deviations of the noise, beyond which a point is drawn at the edge.
const EDGE: f64 = 12.0;

/// The figure; none without an event whose samples are kept.
pub(super) fn residuals(context: &Context<'_>) -> Option<Figure> {
    let slips_s = context.result.events.iter().map(|e| e.slip_s).collect();
    let slip_s = median(slips_s).filter(|slip_s| slip_s.is_finite())?;
    let beside_s = (BESIDE * slip_s).max(4.0 * context.recorder.period_s());
    let points = points(context, beside_s);
    if points.is_empty() {
        return None;
    }
    let drawing = both(|layout| draw(context, &points, (slip_s, beside_s), layout));
    let mut keys =
        vec![dot_key("cloud", "samples minus model"), tint_key("slip", "slip, usual length")];
    if context.result.noise_n.is_some() {
        keys.push(tint_key("noise", "±2 standard deviations of the noise"));
    }
    let caption = "Residuals of the fits around every slip, against the time after its onset. Where \
                   the model holds they scatter as the noise does, about 95 in 100 within the band; \
                   those far outside are drawn at the edge."
        .into();
    Some(Figure { class: "residuals", drawings: vec![drawing], keys, caption })
}

/// Time after the onset, s, and residual, N.
fn points(context: &Context<'_>, beside_s: f64) -> Vec<(f64, f64)> {
    let events = &context.result.events;
    let mut points = Vec::new();
    for (position, event) in events.iter().enumerate() {
        if points.len() >= MOST_SAMPLES {
            break;
        }
        points.extend(of_event(context, event, reach_s(events, position), beside_s));
    }
    points
}

fn of_event(
    context: &Context<'_>,
    event: &EventSummary,
    (before_s, after_s): (f64, f64),
    beside_s: f64,
) -> Vec<(f64, f64)> {
    let (from_s, to_s) =
        (event.onset_s - before_s.min(beside_s), event.stop_s + after_s.min(beside_s));
    let samples = context.recorder.clips.window(from_s, to_s).into_iter();
    let residual =
        |(time_s, force_n): (f64, f64)| (time_s - event.onset_s, force_n - model_n(event, time_s));
    samples.map(residual).filter(|point| point.1.is_finite()).collect()
}

fn draw(
    context: &Context<'_>,
    points: &[(f64, f64)],
    (slip_s, beside_s): (f64, f64),
    layout: Layout,
) -> String {
    let factor = context.force.factor;
    let noise_n = context.result.noise_n.filter(|&noise_n| noise_n > 0.0);
    let widest = points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
    let edge = noise_n.map_or(widest, |noise_n| widest.min(EDGE * noise_n)) * factor;
    let mut plot = Plot::new(&Spec {
        id: "residuals",
        layout,
        size: layout.pick((1160.0, 240.0), (360.0, 230.0)),
        title: "Residuals",
        description: "Samples minus the fitted model around every slip, against the time after its \
                      onset.",
        x: Axis {
            domain: (-beside_s, slip_s + beside_s),
            steps: Steps::Decimal,
            label: "time after the onset (s)".into(),
            readout: ("t − onset", "s".into()),
        },
        y: Axis {
            domain: extent([-edge, edge], 0.08),
            steps: Steps::Decimal,
            label: format!("residual ({})", context.force.name),
            readout: ("residual", context.force.name.clone()),
        },
    });
    plot.shade("slip", 0.0, slip_s);
    if let Some(noise_n) = noise_n {
        let (low, high) = (plot.y.at(-2.0 * noise_n * factor), plot.y.at(2.0 * noise_n * factor));
        let band = rectangle("noise", (plot.x.range.0, high), (plot.x.range.1, low));
        plot.draw(&band);
    }
    plot.line("zero", [(-beside_s, 0.0), (slip_s + beside_s, 0.0)]);
    plot.dots("cloud", points.iter().map(|&(t, r)| (t, (r * factor).clamp(-edge, edge))));
    plot.finish()
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn residuals_of_the_right_model_are_the_noise() {
        let log = SampleLog::dff8_13(120.0);
        let recorder = log.recorder();
        let points = points(&Context::new(&log.result, &recorder), 0.4);
        let n = points.len() as f64;
        let std = (points.iter().map(|p| p.1 * p.1).sum::<f64>() / n).sqrt();
        assert!(points.len() > 500 && (1.8..2.2).contains(&std), "{n} {std}");
    }

    #[test]
    fn no_event_no_figure() {
        let log = SampleLog::dff8_13(40.0).without_events();
        assert!(residuals(&Context::new(&log.result, &log.recorder())).is_none());
    }
}
