//! Convergence of both coefficients with the number of events.

use super::context::Context;
use super::figure::{Figure, both, dot_key, line_key, tint_key};
use super::number::count;
use super::plot::{Axis, Layout, Plot, Spec};
use super::running::{Measured, Running, course, measured};
use super::scale::{Steps, extent};
use super::svg::{Path, symbol};
use crate::replay::events::Events;

/// Largest number of events drawn; of more, every second, third, ...
const MOST_EVENTS: usize = 2500;
/// Largest number of events drawn with error bars.
const MOST_BARS: usize = 800;
/// Half width of the band of a single event, in events.
const BESIDE: f64 = 0.3;
/// Largest number of values all of which lie inside the axis.
const ALL_INSIDE: usize = 100;

/// The figure; none without a coefficient.
pub(super) fn convergence(context: &Context<'_>) -> Option<Figure> {
    let events = &context.result.events;
    let mean_of = |i: usize| course(events.means.iter().map(|mean| &mean[i]), events);
    let panels = [
        Panel::new("static", "s", measured(events, |e| (e.mu_s, e.mu_s_std)), mean_of(0)),
        Panel::new("dynamic", "", measured(events, |e| (e.mu, e.mu_std)), mean_of(1)),
    ];
    let drawn: Vec<&Panel> = panels.iter().filter(|panel| !panel.values.is_empty()).collect();
    if drawn.is_empty() {
        return None;
    }
    let banded = drawn.iter().any(|panel| panel.course.iter().any(|r| r.band.is_some()));
    let bands = match banded {
        true => ", with the uncertainty of weight, slope, zero, span and damping in its bands",
        false => "",
    };
    let caption = format!(
        "Static (above) and dynamic (below) coefficient of each event, and their mean as it was \
         known at that time{bands}.{}",
        outside(&drawn, events)
    );
    let keys = keys(&drawn, banded);
    let drawings = drawn.iter().map(|panel| both(|layout| panel.draw(layout))).collect();
    Some(Figure { class: "convergence", drawings, keys, caption })
}

fn keys(drawn: &[&Panel], banded: bool) -> Vec<String> {
    let events = match drawn.iter().all(|panel| panel.values.len() <= MOST_BARS) {
        true => "events with ±1 standard deviation, random",
        false => "events",
    };
    let mut keys = vec![dot_key("event static", events), line_key("mean static", "mean so far")];
    if banded {
        keys.push(tint_key("band-1 static", "±1 standard deviation, all"));
        keys.push(tint_key("band-2 static", "95 % interval"));
    }
    keys
}

/// The number of values outside the axis, in words.
fn outside(drawn: &[&Panel], events: &Events) -> String {
    // Each event that is kept stands for those up to the next.
    let every = events.found() as f64 / events.len() as f64;
    match drawn.iter().map(|panel| panel.outside()).sum::<usize>() {
        0 => String::new(),
        n if every > 1.0 => {
            format!(" About {} values lie outside the axes.", count((n as f64 * every) as u64))
        }
        1 => " One value lies outside the axes.".into(),
        n => format!(" {} values lie outside the axes.", count(n as u64)),
    }
}

/// The plot of one coefficient.
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
        mut course: Vec<Running>,
    ) -> Self {
        if let [only] = course[..] {
            course = beside(only.event).map(|event| Running { event, ..only }).to_vec();
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
        let one = |r: &Running| r.band.map(|(std, _)| [r.mean - std, r.mean + std]);
        let most = |r: &Running| r.band.map(|(_, ci95)| ci95);
        for (class, outline) in
            [("band-2", self.band(&plot, most)), ("band-1", self.band(&plot, one))]
        {
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

    /// Closed path along the upper ends of the intervals and back along the lower ones.
    fn band(&self, plot: &Plot, ends: impl Fn(&Running) -> Option<[f64; 2]>) -> Path {
        let (low, high) = self.domain;
        let known = self.course.iter().filter_map(|r| Some((r.event, ends(r)?)));
        let mut known: Vec<_> = known.collect();
        if let [(event, ends)] = known[..] {
            known = beside(event).map(|event| (event, ends)).to_vec();
        }
        let edge = |(event, ends): &(f64, [f64; 2]), i: usize| {
            plot.at((*event, ends.get(i).copied().unwrap_or(low).clamp(low, high)))
        };
        let upper = known.iter().map(|it| edge(it, 1));
        let lower = known.iter().rev().map(|it| edge(it, 0));
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
                          and the bands of its uncertainty.",
            x: Axis {
                domain: (first - beside, last + beside),
                steps: Steps::Whole,
                label: "event".into(),
                readout: ("event", String::new()),
            },
            y: Axis {
                domain: self.domain,
                steps: Steps::Decimal,
                label: format!("{} coefficient {}", self.kind, symbol("μ", self.subscript)),
                readout: (pick("μs", "μ"), String::new()),
            },
        }
    }
}

/// Both ends of the band of a single event, in events.
fn beside(event: f64) -> [f64; 2] {
    [event - BESIDE, event + BESIDE]
}

/// Range of the axis: the values with their errors and the result; of many values, the outermost 1
/// % may lie outside where they would take more than half of the range.
fn domain(values: &[Measured], end: Option<&Running>) -> (f64, f64) {
    let sorted = |side: f64| {
        let mut ends: Vec<f64> = values.iter().map(|v| v.value + side * v.std).collect();
        ends.sort_by(f64::total_cmp);
        ends
    };
    let (lows, highs) = (sorted(-1.0), sorted(1.0));
    let result = end.and_then(|r| r.band).map_or([f64::NAN; 2], |(_, ci95)| ci95);
    let without = |strays: usize| {
        let ends = [lows.get(strays), highs.iter().nth_back(strays)].into_iter().flatten().copied();
        extent(ends.chain(result), 0.1)
    };
    let (all, most) = (without(0), without(values.len() / 100));
    let is_roomy = all.1 - all.0 <= 2.0 * (most.1 - most.0);
    if is_roomy || values.len() <= ALL_INSIDE { all } else { most }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(count: u32, strayed: f64) -> (f64, f64) {
        let value = |i: u32| if i == 40 { strayed } else { 1.24 + 0.001 * f64::from(i % 9) };
        let values = (0..count).map(|i| Measured { event: i.into(), value: value(i), std: 0.002 });
        domain(&values.collect::<Vec<_>>(), None)
    }

    #[test]
    fn every_value_and_its_bar_are_inside_but_strays_that_take_the_room() {
        let (low, high) = of(101, 1.25);
        assert!(low < 1.238 && 1.252 < high, "{low} {high}");
        assert!(of(101, 3.0).1 < 1.26);
        assert!(of(100, 3.0).1 > 3.0);
    }

    #[test]
    fn the_key_has_the_bands_that_are_drawn() {
        use super::super::sample_log::SampleLog;
        let figure =
            |log: &SampleLog| convergence(&Context::new(&log.result, &log.recorder())).unwrap();
        let mut log = SampleLog::dff8_13(20.0);
        let many = figure(&log);
        log.keep_events(1);
        let one = figure(&log);
        assert_eq!((one.keys.len(), many.keys.len()), (2, 4));
        assert!(!one.caption.contains("bands") && many.caption.contains("bands"));
    }

    #[test]
    fn the_first_band_has_a_width() {
        let band = Some((0.01, [1.2, 1.3]));
        let course = [(0.0, None), (1.0, band)];
        let course = course.map(|(event, band)| Running { event, mean: 1.25, band });
        let values = [0.0, 1.0].map(|event| Measured { event, value: 1.25, std: 0.002 });
        let panel = Panel::new("static", "s", values.to_vec(), course.to_vec());
        let plot = Plot::new(&panel.spec(Layout::Wide));
        let outline = panel.band(&plot, |r| r.band.map(|(_, ci95)| ci95)).element("band");
        let left = super::super::svg::coordinate(plot.at((1.0 - BESIDE, 1.2)).0);
        assert!(outline.contains(&format!("L{left} ")), "{outline}");
    }
}
