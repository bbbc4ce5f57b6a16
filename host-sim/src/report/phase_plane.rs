//! The force against its rate: a line while the block rests, an ellipse while
//! it moves.

use std::f64::consts::PI;

use super::context::{Context, Focus};
use super::figure::{Figure, both, dot_key, line_key, mark_keys};
use super::fit::{Ellipse, rest_s};
use super::number::{Unit, fixed, quantity};
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, extent};
use super::svg::{Mark, symbol, text};

/// Most samples drawn, those nearest to the event.
const MOST_SAMPLES: usize = 1200;
/// Cycles drawn to either side of the event.
const CYCLES: f64 = 25.0;

/// The figure; none without samples. Without an event only the samples.
pub(super) fn phase_plane(context: &Context<'_>, focus: Option<&Focus<'_>>) -> Option<Figure> {
    let plane = Plane::new(context, focus)?;
    let drawing = both(|layout| plane.draw(layout));
    let mut keys = vec![dot_key("cloud", "samples")];
    let Some(focus) = focus else {
        let caption = "Force against its rate, the central difference over ±1 sample.".into();
        return Some(Figure { class: "plane", drawings: vec![drawing], keys, caption });
    };
    keys.push(dot_key("sample", &format!("samples of event {}", focus.event.index)));
    keys.push(line_key("model", "fitted model"));
    if plane.seen().is_some() {
        keys.push(line_key("seen", "the ellipse as ±1 sample sees it"));
    }
    keys.extend(mark_keys());
    let caption = plane.caption() + &focus.refused();
    Some(Figure { class: "plane", drawings: vec![drawing], keys, caption })
}

/// The data of the figure.
struct Plane<'a> {
    context: &'a Context<'a>,
    focus: Option<&'a Focus<'a>>,
    ellipse: Option<Ellipse>,
    rate: Unit,
    /// Time, s, force, N, and its rate, N/s.
    samples: Vec<(f64, f64, f64)>,
}

impl<'a> Plane<'a> {
    fn new(context: &'a Context<'a>, focus: Option<&'a Focus<'a>>) -> Option<Self> {
        let samples = samples(context, focus);
        let ellipse = focus.and_then(|focus| Ellipse::of(focus.event));
        let steepest = samples.iter().map(|s| s.2.abs()).fold(0.0, f64::max);
        let steepest = ellipse.map_or(steepest, |e| steepest.max(e.a_n * e.omega));
        let rate = Unit::suited(steepest, "N/s");
        (!samples.is_empty()).then_some(Self { context, focus, ellipse, rate, samples })
    }

    fn shown(&self, (force_n, rate_n_per_s): (f64, f64)) -> (f64, f64) {
        (force_n * self.context.force.factor, rate_n_per_s * self.rate.factor)
    }

    /// The full ellipse; `seen`: attenuation of the rate.
    fn turn(&self, ellipse: &Ellipse, from: f64, to: f64, seen: f64) -> Vec<(f64, f64)> {
        let point = |phase| {
            let (force_n, rate) = ellipse.at(phase);
            self.shown((force_n, rate * seen))
        };
        Ellipse::phases(from, to).map(point).collect()
    }

    fn spec(&self, layout: Layout) -> Spec<'static> {
        let outline = self.ellipse.map(|e| self.turn(&e, 0.0, 2.0 * PI, 1.0)).unwrap_or_default();
        let near = self.samples.iter().filter(|s| self.focus.is_none() || self.of_event(s.0));
        let near: Vec<_> = near.map(|&(_, force, rate)| self.shown((force, rate))).collect();
        let all = || outline.iter().chain(&near);
        let force = &self.context.force.name;
        Spec {
            id: "plane",
            layout,
            size: layout.pick((570.0, 520.0), (360.0, 350.0)),
            title: "Phase plane",
            description: "Rate of the force against the force: a horizontal line from the \
                          re-stick to the slip onset, then an ellipse, run clockwise, back.",
            x: Axis {
                domain: extent(all().map(|p| p.0), 0.12),
                steps: Steps::Decimal,
                label: self.context.force_label(),
                readout: ("F", force.clone()),
            },
            y: Axis {
                domain: extent(all().map(|p| p.1), 0.08),
                steps: Steps::Decimal,
                label: format!("rate <tspan class=\"sym\">F</tspan>′ ({})", self.rate.name),
                readout: ("F′", self.rate.name.clone()),
            },
        }
    }

    /// Whether a moment belongs to the cycle of the event in focus.
    fn of_event(&self, time_s: f64) -> bool {
        let Some(focus) = self.focus else { return false };
        let event = focus.event;
        let before_s = rest_s(event);
        let after_s = (focus.period_s - event.slip_s) / 2.0;
        (event.onset_s - before_s..=event.stop_s + after_s).contains(&time_s)
    }

    fn draw(&self, layout: Layout) -> String {
        let mut plot = Plot::new(&self.spec(layout));
        let (low, high) = plot.x.domain;
        plot.line("zero", [(low, 0.0), (high, 0.0)]);
        let cloud = self.samples.iter().filter(|s| !self.of_event(s.0));
        plot.dots("cloud", cloud.map(|s| self.shown((s.1, s.2))));
        self.draw_model(&mut plot);
        let own: Vec<_> = self.samples.iter().filter(|s| self.of_event(s.0)).collect();
        plot.line("loop", own.iter().map(|s| self.shown((s.1, s.2))));
        plot.dots("sample", own.iter().map(|s| self.shown((s.1, s.2))));
        self.draw_marks(&mut plot);
        plot.finish()
    }

    fn draw_model(&self, plot: &mut Plot) {
        let Some(focus) = self.focus else { return };
        let event = focus.event;
        let rate = event.loading_rate_n_per_s;
        let stick = [event.restick_force_n, event.static_force_n].map(|f| self.shown((f, rate)));
        if let Some(e) = &self.ellipse {
            if let Some(seen) = self.seen() {
                plot.line("seen", self.turn(e, 0.0, 2.0 * PI, seen));
            }
            plot.line("rest-of-ellipse", self.turn(e, e.stop_phase, e.onset_phase + 2.0 * PI, 1.0));
            plot.line("model", self.turn(e, e.onset_phase, e.stop_phase, 1.0));
            let (x, y) = plot.at(self.shown(e.at(PI / 2.0)));
            plot.draw(&arrow(x, y, -1.0));
            plot.annotate(&text("note mid", (x, y - 14.0), "slip"));
        }
        plot.line("model", stick);
        let middle = ((stick[0].0 + stick[1].0) / 2.0, stick[0].1);
        let (x, y) = plot.at(middle);
        plot.draw(&arrow(x, y, 1.0));
        let label = "stick: <tspan class=\"sym\">F</tspan>′ = <tspan class=\"sym\">k w</tspan>";
        plot.annotate(&text("note mid", (x, y - 12.0), label));
    }

    fn draw_marks(&self, plot: &mut Plot) {
        let Some(focus) = self.focus else { return };
        let event = focus.event;
        let rate = event.loading_rate_n_per_s;
        let marks = [
            (Mark::Static, "s", (event.static_force_n, rate), "note", (10.0, -9.0)),
            (Mark::Dynamic, "p", (event.dynamic_force_n, 0.0), "note", (10.0, 17.0)),
            (Mark::Restick, "e", (event.restick_force_n, rate), "note end", (-9.0, -9.0)),
        ];
        for (mark, subscript, place, class, (dx, dy)) in marks {
            let (x, y) = plot.at(self.shown(place));
            plot.annotate(&mark.at((x, y)));
            plot.annotate(&text(class, (x + dx, y + dy), &symbol("F", subscript)));
        }
    }

    /// Attenuation of the rate by a difference over ±1 sample, where both samples can lie within
    /// the slip.
    fn seen(&self) -> Option<f64> {
        let period_s = self.context.recorder.period_s();
        let (ellipse, focus) = self.ellipse.zip(self.focus)?;
        (focus.event.slip_s > 2.0 * period_s).then(|| ellipse.attenuation(period_s))
    }

    fn caption(&self) -> String {
        let Some((ellipse, focus)) = self.ellipse.zip(self.focus) else {
            return "Force against its rate. The samples do not show the ellipse of this slip: \
                    <i>F</i><sub>p</sub> is half-way between <i>F</i><sub>s</sub> and \
                    <i>F</i><sub>e</sub>."
                .into();
        };
        let seen = match self.seen() {
            Some(seen) => format!(
                "sees {} of the ellipse's height: the centre, and with it <i>μ</i>, is untouched",
                fixed(seen, 2)
            ),
            None => "reaches across a slip this short and stays inside the ellipse".into(),
        };
        format!(
            "Force against its rate, run clockwise. The fitted ellipse ((<i>F</i> − \
             <i>F</i><sub>p</sub>)/<i>a</i>)² + (<i>F</i>′/<i>ωa</i>)² = 1 has <i>a</i> = {} and \
             <i>ω</i> = {}; the stick line lies at <i>k w</i> = {}. The samples' rate is the \
             central difference over ±1 sample, which {seen}.",
            quantity(ellipse.a_n, "N"),
            quantity(ellipse.omega, "rad/s"),
            quantity(focus.event.loading_rate_n_per_s, "N/s"),
        )
    }
}

/// An arrow head; `along` is 1 to the right and -1 to the left.
fn arrow(x: f64, y: f64, along: f64) -> String {
    let tail = 6.0 * along;
    format!(
        "<path class=\"arrow\" d=\"M{:.1} {y:.1}L{:.1} {:.1}L{:.1} {:.1}Z\"/>",
        x + tail,
        x - tail,
        y - 5.5,
        x - tail,
        y + 5.5
    )
}

/// Samples around the event, or from the start of the log without one.
fn samples(context: &Context<'_>, focus: Option<&Focus<'_>>) -> Vec<(f64, f64, f64)> {
    let (start_s, end_s) = context.recorder.span_s().unwrap_or((0.0, 0.0));
    let (from_s, to_s, centre_s) = focus.map_or((start_s, end_s, start_s), |focus| {
        let around_s = CYCLES * focus.period_s;
        let event = focus.event;
        (event.onset_s - around_s, event.stop_s + around_s, event.onset_s)
    });
    let window = context.recorder.clips.window(from_s, to_s);
    let apart_s = 2.5 * context.recorder.period_s();
    let difference = |w: &[(f64, f64)]| match *w {
        [(t0, before), (t, force), (t1, after)] if t1 - t0 < apart_s => {
            let rate = (after - before) / (t1 - t0);
            (force.is_finite() && rate.is_finite()).then_some((t, force, rate))
        }
        _ => None,
    };
    // The samples must hold one whole cycle, also at a high rate.
    let per_cycle = focus.map_or(0.0, |focus| 1.5 * focus.period_s / context.recorder.period_s());
    let step = (per_cycle as usize).div_ceil(MOST_SAMPLES).max(1);
    let all: Vec<_> = window.windows(3).step_by(step).filter_map(difference).collect();
    let centre = all.partition_point(|s| s.0 < centre_s);
    let from = centre.saturating_sub(MOST_SAMPLES / 2).min(all.len().saturating_sub(MOST_SAMPLES));
    all.into_iter().skip(from).take(MOST_SAMPLES).collect()
}
