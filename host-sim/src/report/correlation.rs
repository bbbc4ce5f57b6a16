//! Correlation of `mu` with `mu_s`: whether an event of high static friction also slides with more.

use super::context::Context;
use super::figure::{Figure, both, dot_key, line_key};
use super::number::{count, fixed};
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, extent};
use crate::replay::events::Events;
use crate::replay::result::EventSummary;
use crate::rounding::digits;

/// Fewest events for a correlation.
const FEWEST: usize = 5;
/// Most events drawn, evenly spread over the log.
const MOST: usize = 600;

/// Sample correlation of two lists.
#[derive(Clone, Copy, Debug)]
struct Correlation {
    value: f64,
    /// 95 % interval.
    ci95: [f64; 2],
    means: [f64; 2],
}

/// The figure; none with fewer than five events that have both coefficients.
pub(super) fn correlation(context: &Context<'_>) -> Option<Figure> {
    let pairs: Vec<_> = context.result.events.iter().filter_map(pair).collect();
    let found = Correlation::of(&pairs)?;
    let drawing = both(|layout| draw(&pairs, &found, layout));
    let keys = vec![dot_key("sample", "events"), line_key("moment", "means of the events")];
    let decimals = decimals(found.ci95);
    let [low, high] = found.ci95.map(|r| fixed(r, decimals));
    let caption = format!(
        "<i>μ</i> against <i>μ</i><sub>s</sub> of {} that have both: correlation {} (95 % \
         interval {low} to {high}, from Fisher's transformation; events counted as independent). The \
         errors of an event are in it as well: <i>F</i><sub>s</sub> is in both coefficients, and a \
         wrong weight or zero moves both alike.",
        which(pairs.len(), &context.result.events),
        fixed(found.value, decimals),
    );
    Some(Figure { class: "pair", drawings: vec![drawing], keys, caption })
}

/// The events used, in words: of a long log not all are kept.
fn which(pairs: usize, events: &Events) -> String {
    let pairs = count(pairs as u64);
    match events.found() {
        all if all > events.len() => {
            format!("{pairs} events, spread evenly over all {},", count(all as u64))
        }
        _ => format!("the {pairs} events"),
    }
}

/// Decimals for both ends of an interval.
fn decimals([low, high]: [f64; 2]) -> usize {
    digits((high - low) / 4.0).saturating_sub(1).clamp(2, 6)
}

fn pair(event: &EventSummary) -> Option<(f64, f64)> {
    event.mu_s.zip(event.mu)
}

impl Correlation {
    /// The correlation of pairs that scatter; Fisher's interval, `tanh(atanh r ± 1.96/√(n − 3))`.
    fn of(pairs: &[(f64, f64)]) -> Option<Self> {
        let n = pairs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n;
        let means = [mean(|p| p.0), mean(|p| p.1)];
        let mut sums = [0.0; 3];
        for (a, b) in pairs.iter().map(|p| (p.0 - means[0], p.1 - means[1])) {
            sums = [sums[0] + a * a, sums[1] + b * b, sums[2] + a * b];
        }
        let value = sums[2] / (sums[0] * sums[1]).sqrt();
        let half = 1.96 / (n - 3.0).sqrt();
        let ci95 = [-half, half].map(|by| (value.atanh() + by).tanh());
        (pairs.len() >= FEWEST && value.is_finite()).then_some(Self { value, ci95, means })
    }
}

fn draw(pairs: &[(f64, f64)], found: &Correlation, layout: Layout) -> String {
    let x = axis(pairs.iter().map(|p| p.0), "static coefficient", "μs");
    let y = axis(pairs.iter().map(|p| p.1), "dynamic coefficient", "μ");
    let ((left, right), (low, high)) = (x.domain, y.domain);
    let mut plot = Plot::new(&Spec {
        id: "pair",
        layout,
        size: layout.pick((570.0, 420.0), (360.0, 330.0)),
        title: "Dynamic against static coefficient",
        description: "One dot for every event: to the right its static, upwards its dynamic \
                      coefficient.",
        x,
        y,
    });
    let [mu_s, mu] = found.means;
    plot.line("moment", [(left, mu), (right, mu)]);
    plot.line("moment", [(mu_s, low), (mu_s, high)]);
    plot.dots("sample", pairs.iter().copied().step_by(pairs.len().div_ceil(MOST)));
    plot.finish()
}

fn axis(values: impl Iterator<Item = f64>, label: &str, symbol: &'static str) -> Axis {
    Axis {
        domain: extent(values, 0.08),
        steps: Steps::Decimal,
        label: label.into(),
        readout: (symbol, String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn correlation_is_pearsons_and_its_interval_fishers() {
        let pairs = [(1.0, 2.0), (2.0, 1.0), (3.0, 4.0), (4.0, 3.0), (5.0, 5.0)];
        let found = Correlation::of(&pairs).expect("five pairs");
        // By hand: 8 / √(10 · 10); atanh .8 ± 1.96/√2.
        assert!((found.value - 0.8).abs() < 1e-12);
        assert!((found.ci95[0] - (1.098_612_f64 - 1.385_929).tanh()).abs() < 1e-5);
        assert!((found.ci95[1] - (1.098_612_f64 + 1.385_929).tanh()).abs() < 1e-5);
        assert!(Correlation::of(&pairs[..4]).is_none());
        assert!(Correlation::of(&[(1.0, 1.0); 9]).is_none(), "what does not scatter has none");
    }

    #[test]
    fn an_interval_near_one_is_told_from_one() {
        let intervals = [[-0.23, 0.16], [0.976, 0.986], [0.999_1, 0.999_5], [1.0, 1.0]];
        assert_eq!(intervals.map(decimals), [2, 3, 4, 2]);
    }

    #[test]
    fn of_a_long_log_it_says_of_how_many_events() {
        let log = SampleLog::dff8_13(60.0);
        assert_eq!(which(5, &log.result.events), "the 5 events");
        let mut events = Events::default();
        for index in 0..30_000 {
            let event = EventSummary { index, ..log.result.events[0].clone() };
            events.push(event, Default::default).unwrap();
        }
        let said = which(events.len(), &events);
        assert!(said.ends_with("events, spread evenly over all 29\u{202f}744,"), "{said}");
    }

    #[test]
    fn the_figure_says_how_many_events() {
        let log = SampleLog::dff8_13(120.0);
        let recorder = log.recorder();
        let figure = correlation(&Context::new(&log.result, &recorder)).expect("events");
        assert!(figure.caption.contains("events that have both"), "{}", figure.caption);
        let none = SampleLog::dff8_13(40.0).without_events();
        assert!(correlation(&Context::new(&none.result, &none.recorder())).is_none());
    }
}
