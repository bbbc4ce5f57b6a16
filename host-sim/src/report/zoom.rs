//! A few cycles and one slip, with the fitted model through the samples.

use super::context::{Context, Focus};
use super::figure::{Figure, both, dot_key, line_key, mark_keys, tint_key};
use super::fit::{centre_time_s, line_after, line_before, reach_s, slip_curve};
use super::number::{count, decimals_for, fixed};
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, extent};
use super::shading::shade_each;
use super::svg::{Mark, Path, symbol, text};
use crate::replay::result::EventSummary;

/// Largest number of samples in a panel; of more, every second, third, ...
const MOST_SAMPLES: usize = 3000;
/// Classes of a fitted curve, by whether the samples show the shape of the slip.
const MODEL: &str = "model";
const UNRESOLVED: &str = "model unresolved";

/// The figure.
pub(super) fn zoom(context: &Context<'_>, focus: &Focus<'_>) -> Figure {
    let cycles = both(|layout| draw_cycles(context, focus, layout));
    let slip = both(|layout| draw_slip(context, focus, layout));
    let mut keys =
        vec![dot_key("sample", "samples"), tint_key("stick", "stick"), tint_key("slip", "slip")];
    let shown = touched(context, window_s(context, focus, Layout::Wide));
    let curves: Vec<&str> = shown.iter().filter_map(class_of_fit).collect();
    for (class, name) in [(MODEL, "fitted model"), (UNRESOLVED, "model of an unresolved slip")] {
        keys.extend(curves.contains(&class).then(|| line_key(class, name)));
    }
    keys.extend(mark_keys());
    let caption = format!(
        "Cycles around event {} ({}), and its slip alone. The block rests while the force rises \
         along a line; at <i>F</i><sub>s</sub> it slips, and the force follows \
         <i>F</i><sub>p</sub> + <i>a</i> cos <i>ω</i>(<i>t</i> − <i>t</i><sub>0</sub>) to \
         <i>F</i><sub>e</sub> = 2<i>F</i><sub>p</sub> − <i>F</i><sub>s</sub>.{}",
        count(focus.event.index.into()),
        place(context, focus),
        focus.refused(),
    );
    Figure { class: "zoom", drawings: vec![cycles, slip], keys, caption }
}

fn place(context: &Context<'_>, focus: &Focus<'_>) -> &'static str {
    let event = focus.event;
    let usual = !event.is_odd() && context.result.events.len() > 2;
    if usual { "the one nearest to the mean" } else { "the best one there is" }
}

/// Times of the panel with the cycles, s.
pub(super) fn window_s(context: &Context<'_>, focus: &Focus<'_>, layout: Layout) -> (f64, f64) {
    let half_s = layout.pick(1.65, 0.9) * focus.period_s;
    let centre_s = (focus.event.onset_s + focus.event.stop_s) / 2.0;
    within_log(context, centre_s - half_s, centre_s + half_s)
}

fn within_log(context: &Context<'_>, from_s: f64, to_s: f64) -> (f64, f64) {
    let (start_s, end_s) = context.recorder.span_s().unwrap_or((from_s, to_s));
    (from_s.max(start_s), to_s.min(end_s))
}

fn draw_cycles(context: &Context<'_>, focus: &Focus<'_>, layout: Layout) -> String {
    let panel = Panel {
        context,
        span_s: window_s(context, focus, layout),
        id: "cycles",
        size: layout.pick((770.0, 360.0), (360.0, 280.0)),
        title: "A few cycles",
    };
    panel.draw(focus, layout, false)
}

fn draw_slip(context: &Context<'_>, focus: &Focus<'_>, layout: Layout) -> String {
    let event = focus.event;
    let beside_s = (1.2 * event.slip_s).max(3.0 * context.recorder.period_s());
    let panel = Panel {
        context,
        span_s: within_log(context, event.onset_s - beside_s, event.stop_s + beside_s),
        id: "slip",
        size: layout.pick((380.0, 360.0), (360.0, 300.0)),
        title: "One slip",
    };
    panel.draw(focus, layout, true)
}

/// The events that touch a span of time, with the ones before and after.
fn touched<'a>(context: &Context<'a>, (from_s, to_s): (f64, f64)) -> &'a [EventSummary] {
    let events = &context.result.events;
    let from = events.partition_point(|e| e.stop_s < from_s).saturating_sub(1);
    let to = events.partition_point(|e| e.onset_s < to_s) + 1;
    events.get(from..to.min(events.len())).unwrap_or_default()
}

/// One of the two plots of the figure.
struct Panel<'a> {
    context: &'a Context<'a>,
    span_s: (f64, f64),
    id: &'static str,
    size: (f64, f64),
    title: &'static str,
}

impl Panel<'_> {
    fn samples(&self) -> Vec<(f64, f64)> {
        let samples = self.context.recorder.clips.window(self.span_s.0, self.span_s.1);
        let step = samples.len().div_ceil(MOST_SAMPLES).max(1);
        samples.into_iter().step_by(step).map(|s| self.context.shown(s)).collect()
    }

    fn plot(&self, samples: &[(f64, f64)], events: &[EventSummary], layout: Layout) -> Plot {
        let context = self.context;
        let inside = |e: &&EventSummary| e.onset_s < self.span_s.1 && e.stop_s > self.span_s.0;
        let marks = events.iter().filter(inside);
        let marks = marks.flat_map(|e| [e.peak_force_n, e.static_force_n, e.restick_force_n]);
        let forces = marks.map(|f| f * context.force.factor).chain(samples.iter().map(|s| s.1));
        Plot::new(&Spec {
            id: self.id,
            layout,
            size: self.size,
            title: self.title,
            description: "Samples of the force, the fitted model, and the forces at the slip \
                          onset, the centre and the re-stick.",
            x: Axis {
                domain: (self.span_s.0 - context.zero_s, self.span_s.1 - context.zero_s),
                steps: Steps::Decimal,
                label: context.time_label("s"),
                readout: ("t", "s".into()),
            },
            y: Axis {
                domain: extent(forces, 0.1),
                steps: Steps::Decimal,
                label: context.force_label(),
                readout: ("F", context.force.name.clone()),
            },
        })
    }

    fn draw(&self, focus: &Focus<'_>, layout: Layout, close: bool) -> String {
        let (context, samples) = (self.context, self.samples());
        let events = touched(context, self.span_s);
        let mut plot = self.plot(&samples, events, layout);
        shade_each(context, &mut plot, events);
        moments(context, &mut plot, focus.event, close);
        draw_fits(context, &mut plot, events);
        let room = (plot.x.range.1 - plot.x.range.0) as usize / 3;
        if samples.len() <= room {
            plot.dots("sample", samples);
        } else {
            plot.line("sample-line", samples);
        }
        for event in events {
            draw_marks(context, &mut plot, event);
        }
        label_marks(context, &mut plot, focus.event, close);
        plot.finish()
    }
}

/// Dashed lines at the onset and the re-stick, with their names in a close-up.
fn moments(context: &Context<'_>, plot: &mut Plot, event: &EventSummary, close: bool) {
    let (bottom, top) = plot.y.range;
    let mut path = Path::default();
    let [onset, stop] = [event.onset_s, event.stop_s].map(|t| plot.x.at(t - context.zero_s));
    path.bar(onset, top, bottom);
    path.bar(stop, top, bottom);
    plot.draw(&path.element("moment"));
    if close {
        plot.annotate(&text("note end", (onset + 2.0, top - 6.0), "onset"));
        plot.annotate(&text("note", (stop - 2.0, top - 6.0), "re-stick"));
    }
}

/// Class of an event's fitted curve; none without coefficients.
fn class_of_fit(event: &EventSummary) -> Option<&'static str> {
    event.mu_s?;
    Some(if event.omega_rad_per_s.is_some() { MODEL } else { UNRESOLVED })
}

/// The fit of every event that has coefficients, half-way to its neighbours.
fn draw_fits(context: &Context<'_>, plot: &mut Plot, events: &[EventSummary]) {
    for (i, event) in events.iter().enumerate() {
        let Some(class) = class_of_fit(event) else { continue };
        let (before_s, after_s) = reach_s(events, i);
        let mut curve = line_before(event, before_s);
        curve.extend(slip_curve(event));
        curve.extend(line_after(event, after_s));
        plot.line(class, curve.into_iter().map(|point| context.shown(point)));
    }
}

fn mark_places(event: &EventSummary) -> [(Mark, &'static str, (f64, f64)); 3] {
    [
        (Mark::Static, "s", (event.onset_s, event.static_force_n)),
        (Mark::Dynamic, "p", (centre_time_s(event), event.dynamic_force_n)),
        (Mark::Restick, "e", (event.stop_s, event.restick_force_n)),
    ]
}

fn draw_marks(context: &Context<'_>, plot: &mut Plot, event: &EventSummary) {
    for (mark, _, place) in mark_places(event) {
        plot.draw(&mark.at(plot.at(context.shown(place))));
    }
}

/// `Fs`, `Fp` and `Fe` beside their marks, with their values in a close-up.
fn label_marks(context: &Context<'_>, plot: &mut Plot, event: &EventSummary, close: bool) {
    let offsets = [("note end", -10.0, -8.0), ("note", 11.0, 4.0), ("note", 8.0, 20.0)];
    for ((_, subscript, place), (class, dx, dy)) in mark_places(event).into_iter().zip(offsets) {
        let (shown, mut label) = (context.shown(place), symbol("F", subscript));
        if close {
            let value = fixed(shown.1, decimals_for(shown.1, 4));
            label.push_str(&format!("<tspan dy=\"-3\"> {value}</tspan>"));
        }
        let (x, y) = plot.at(shown);
        // Kept clear of the axis labels.
        let lowest = plot.y.range.0 - 6.0;
        plot.annotate(&text(class, (x + dx, (y + dy).min(lowest)), &label));
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn an_event_without_coefficients_has_no_fitted_curve() {
        let curves = |log: &SampleLog| log.page().matches("class=\"model\"").count();
        let mut log = SampleLog::dff8_13(60.0);
        let all = curves(&log);
        for event in log.result.events.kept.iter_mut().step_by(2) {
            (event.mu_s, event.mu, event.reason) = (None, None, Some("no_fit".into()));
        }
        let some = curves(&log);
        assert!(some > 0 && some < all, "{some} of {all}");
    }

    #[test]
    fn the_keys_name_the_curves_that_are_drawn() {
        let mut log = SampleLog::dff8_13(60.0);
        let keys = |log: &SampleLog| {
            let recorder = log.recorder();
            let context = Context::new(&log.result, &recorder);
            zoom(&context, &context.focus().unwrap()).keys.concat()
        };
        assert!(keys(&log).contains("fitted model") && !keys(&log).contains("unresolved"));
        log.result.events.kept.iter_mut().for_each(|event| event.omega_rad_per_s = None);
        assert!(!keys(&log).contains("fitted model") && keys(&log).contains("unresolved"));
        log.result.events.kept.iter_mut().for_each(|event| event.mu_s = None);
        assert!(!keys(&log).contains("model"), "{}", keys(&log));
    }
}
