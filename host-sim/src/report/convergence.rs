//! How both coefficients settle as events come in.

use super::context::Context;
use super::figure::{Figure, both, dot_key, line_key, tint_key};
use super::number::count;
use super::plot::{Axis, Layout, Plot, Spec};
use super::running::{Measured, Running, course, measured};
use super::scale::extent;
use super::svg::Path;
use crate::replay::result::CoefficientSummary;

/// Events drawn at most; beyond it every second, third, ...
const MOST_EVENTS: usize = 2500;
/// Events up to which each has its error bar.
const MOST_BARS: usize = 800;
/// Values up to which none is left outside the axis.
const ALL_INSIDE: usize = 100;

/// The figure; none without a coefficient.
pub(super) fn convergence(context: &Context<'_>) -> Option<Figure> {
    let (events, estimate) = (&context.result.events, &context.result.estimate);
    let panels = [
        Panel::new("static", "s", measured(events, |e| (e.mu_s, e.mu_s_std)), &estimate.mu_s),
        Panel::new("dynamic", "", measured(events, |e| (e.mu, e.mu_std)), &estimate.mu),
    ];
    let drawn: Vec<&Panel> = panels.iter().filter(|panel| !panel.values.is_empty()).collect();
    if drawn.is_empty() {
        return None;
    }
    let bars = drawn.iter().all(|panel| panel.values.len() <= MOST_BARS);
    let keys = vec![
        dot_key("event static", if bars { "events with ±1 standard deviation" } else { "events" }),
        line_key("mean static", "mean so far"),
        tint_key("band-1 static", "±1 standard error"),
        tint_key("band-2 static", "±2 standard errors"),
    ];
    let outside: usize = drawn.iter().map(|panel| panel.outside()).sum();
    let note = match outside {
        0 => String::new(),
        1 => " One value lies outside the axes.".into(),
        n => format!(" {} values lie outside the axes.", count(n as u64)),
    };
    let caption = format!(
        "Static (above) and dynamic (below) coefficient of each event, and their mean with its \
         standard error, which includes the variation between events.{note}"
    );
    let drawings = drawn.iter().map(|panel| both(|layout| panel.draw(layout))).collect();
    Some(Figure { class: "convergence", drawings, keys, caption })
}

/// One coefficient.
struct Panel {
    kind: &'static str,
    subscript: &'static str,
    values: Vec<Measured>,
    course: Vec<Running>,
    domain: (f64, f64),
}

impl Panel {
    fn new(
        kind: &'static str,
        subscript: &'static str,
        values: Vec<Measured>,
        end: &CoefficientSummary,
    ) -> Self {
        let mut course = course(&values, end);
        if let [only] = course[..] {
            let beside = |step| Running { event: only.event + step, ..only };
            course = vec![beside(-0.3), beside(0.3)];
        }
        let domain = domain(&values, course.last());
        Self { kind, subscript, values, course, domain }
    }

    fn outside(&self) -> usize {
        let (low, high) = self.domain;
        self.values.iter().filter(|v| !(low..=high).contains(&v.value)).count()
    }

    fn draw(&self, layout: Layout) -> String {
        let mut plot = Plot::new(&self.spec(layout));
        for (class, width) in [("band-2", 2.0), ("band-1", 1.0)] {
            let outline = self.band(&plot, width);
            plot.draw(&outline.element(&format!("{class} {}", self.kind)));
        }
        let step = self.values.len().div_ceil(MOST_EVENTS).max(1);
        if self.values.len() <= layout.pick(MOST_BARS, MOST_BARS / 3) {
            let mut bars = Path::default();
            for v in &self.values {
                bars.bar(
                    plot.x.at(v.event),
                    plot.y.at(v.value - v.std),
                    plot.y.at(v.value + v.std),
                );
            }
            plot.draw(&bars.element(&format!("bar {}", self.kind)));
        }
        let crowd = if self.values.len() > layout.pick(400, 120) { " crowd" } else { "" };
        let values = self.values.iter().step_by(step).map(|v| (v.event, v.value));
        plot.dots(&format!("event {}{crowd}", self.kind), values);
        let means = self.course.iter().map(|r| (r.event, r.mean));
        plot.line(&format!("mean {}", self.kind), means);
        plot.finish()
    }

    /// Mean ± `width` standard errors, there and back.
    fn band(&self, plot: &Plot, width: f64) -> Path {
        let edge = |r: &Running, side: f64| plot.at((r.event, r.mean + side * width * r.std_error));
        let upper = self.course.iter().map(|r| edge(r, 1.0));
        let lower = self.course.iter().rev().map(|r| edge(r, -1.0));
        let mut path = Path::line(upper.chain(lower));
        path.close();
        path
    }

    fn spec(&self, layout: Layout) -> Spec<'static> {
        let events = self.values.iter().map(|v| v.event);
        let (first, last) = extent(events, 0.0);
        let beside = ((last - first) * 0.015).max(0.6);
        let is_static = self.kind == "static";
        let pick = |a, b| if is_static { a } else { b };
        Spec {
            id: pick("convergence-static", "convergence-dynamic"),
            layout,
            size: layout.pick((570.0, 292.0), (360.0, 230.0)),
            title: pick(
                "Convergence of the static coefficient",
                "Convergence of the dynamic coefficient",
            ),
            description: "Coefficient of every event against its number, with the mean so far \
                          and the band of its standard error.",
            x: Axis {
                domain: (first - beside, last + beside),
                least_step: 1.0,
                label: "event".into(),
                readout: ("event", String::new()),
            },
            y: Axis {
                domain: self.domain,
                least_step: 0.0,
                label: format!(
                    "{} coefficient <tspan class=\"sym\">μ</tspan><tspan class=\"sub\" dy=\"3\">{}</tspan>",
                    self.kind, self.subscript
                ),
                readout: (pick("μs", "μ"), String::new()),
            },
        }
    }
}

/// The values with their errors and the result; the strays of many left out.
fn domain(values: &[Measured], end: Option<&Running>) -> (f64, f64) {
    let mut sorted: Vec<&Measured> = values.iter().collect();
    sorted.sort_by(|a, b| a.value.total_cmp(&b.value));
    let stray = if sorted.len() > ALL_INSIDE { sorted.len() / 100 } else { 0 };
    let kept = sorted.get(stray..sorted.len() - stray).unwrap_or_default();
    let mut stds: Vec<f64> = kept.iter().map(|v| v.std).collect();
    stds.sort_by(f64::total_cmp);
    let std = stds.get(stds.len() / 2).copied().unwrap_or(0.0);
    let ends = [kept.first(), kept.last()].into_iter().flatten();
    let ends = ends.flat_map(|v| [v.value - 1.2 * std, v.value + 1.2 * std]);
    let result =
        end.into_iter().flat_map(|r| [r.mean - 2.0 * r.std_error, r.mean + 2.0 * r.std_error]);
    extent(ends.chain(result), 0.1)
}
