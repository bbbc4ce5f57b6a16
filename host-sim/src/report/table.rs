//! The table of events, one per row.

use super::context::Context;
use super::number::{count, decimals_for, decimals_of_error, fixed, significant};
use super::svg::escape;
use crate::replay::events::Events;
use crate::replay::result::EventSummary;

/// Events shown from the start and from the end of a long list.
const EDGE: usize = 200;
/// Troubled events shown from in between.
const MOST_TROUBLED: usize = 200;

/// The table with its heading.
pub(super) fn table(context: &Context<'_>) -> String {
    let events = &context.result.events;
    if events.is_empty() {
        return String::new();
    }
    let columns = Columns::new(context);
    let mut rows = String::new();
    let mut last = None;
    for (_, event) in chosen(events) {
        if last.is_some_and(|last| event.index > last + 1) {
            rows.push_str("<tr class=\"skip\"><td colspan=\"13\">⋯</td></tr>");
        }
        rows.push_str(&columns.row(event));
        last = Some(event.index);
    }
    format!(
        "<section><h2>Events</h2>{}<div class=\"scroll\" tabindex=\"0\" role=\"region\" \
         aria-label=\"Table of events\"><table><thead>{}</thead><tbody>\n{rows}</tbody></table>\
         </div></section>\n",
        remark(events),
        columns.head()
    )
}

/// The first and last events and the troubled ones in between, in order.
pub(super) fn chosen(events: &[EventSummary]) -> impl Iterator<Item = (usize, &EventSummary)> {
    let tail = events.len().saturating_sub(EDGE).max(EDGE);
    let mut troubled = 0;
    events.iter().enumerate().filter(move |(position, event)| {
        let edge = *position < EDGE || *position >= tail;
        let shown = edge || (event.is_odd() && troubled < MOST_TROUBLED);
        troubled += usize::from(shown && !edge);
        shown
    })
}

fn remark(events: &Events) -> String {
    let troubled = events.odd() as u64;
    let shown = chosen(events).count();
    let mut text = match events.found() {
        1 => String::from("<p>One event"),
        n => format!("<p>{} events", count(n as u64)),
    };
    if troubled > 0 {
        text.push_str(&format!(", {} with a remark", count(troubled)));
    }
    text.push_str(
        ". ±: one standard deviation of all that is known, the random part of the event and what \
         all events share.",
    );
    if shown < events.found() {
        text.push_str(&format!(
            " Shown are the first and the last {EDGE}, and up to {MOST_TROUBLED} with a remark \
             in between; <code>floe replay --events FILE.csv</code> writes all."
        ));
    }
    text.push_str("</p>");
    text
}

/// Input of the cells.
struct Columns<'a> {
    context: &'a Context<'a>,
    force_decimals: usize,
    time_decimals: usize,
}

impl<'a> Columns<'a> {
    fn new(context: &'a Context<'a>) -> Self {
        let largest = context.result.events.iter().map(|e| e.peak_force_n.abs());
        let largest = largest.fold(0.0, f64::max) * context.force.factor;
        let time_decimals = decimals_for(context.recorder.period_s() / 100.0, 1);
        Self { context, force_decimals: decimals_for(largest, 4), time_decimals }
    }

    fn head(&self) -> String {
        let unit = &self.context.force.name;
        let per_second = format!("{unit}/s");
        let columns = [
            ("event", ""),
            ("onset", "s"),
            ("<i>μ</i><sub>s</sub>", ""),
            ("<i>μ</i>", ""),
            ("<i>F</i><sub>s</sub>", unit),
            ("<i>F</i><sub>p</sub>", unit),
            ("<i>F</i><sub>e</sub>", unit),
            ("peak", unit),
            ("stick", "s"),
            ("slip", "s"),
            ("<i>k w</i>", &per_second),
            ("<i>ω</i>", "rad/s"),
            ("remark", ""),
        ];
        let cell = |(name, unit): &(&str, &str)| {
            format!("<th scope=\"col\">{name}<small>{unit}</small></th>")
        };
        format!("<tr>{}</tr>", columns.iter().map(cell).collect::<String>())
    }

    fn row(&self, e: &EventSummary) -> String {
        let force = |f: f64| fixed(f * self.context.force.factor, self.force_decimals);
        let time = |t: f64| fixed(t, self.time_decimals);
        let cells = [
            e.index.to_string(),
            time(e.onset_s),
            coefficient(e.mu_s, e.mu_s_combined_std),
            coefficient(e.mu, e.mu_combined_std),
            force(e.static_force_n),
            force(e.dynamic_force_n),
            force(e.restick_force_n),
            force(e.peak_force_n),
            optional(e.stick_s, time),
            time(e.slip_s),
            significant(e.loading_rate_n_per_s * self.context.force.factor),
            optional(e.omega_rad_per_s, |omega| fixed(omega, 2)),
            remark_cell(e),
        ];
        let class = if e.reason.is_some() { " class=\"bad\"" } else { "" };
        let event = format!(" data-event=\"{}\"", e.index);
        format!("<tr{class}{event}><td>{}</td></tr>\n", cells.join("</td><td>"))
    }
}

fn optional(value: Option<f64>, show: impl Fn(f64) -> String) -> String {
    value.map_or("–".into(), show)
}

fn coefficient(value: Option<f64>, std: Option<f64>) -> String {
    let decimals = decimals_of_error(std);
    match (value, std) {
        (Some(value), Some(std)) => {
            format!("{} ± {}", fixed(value, decimals), fixed(std, decimals))
        }
        (Some(value), None) => fixed(value, decimals),
        (None, _) => "–".into(),
    }
}

fn remark_cell(event: &EventSummary) -> String {
    match &event.reason {
        Some(reason) => format!("⚠ {}: {}", escape(&event.quality), escape(reason)),
        None if event.quality == "good" => String::new(),
        None => escape(&event.quality),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn long_lists_show_their_ends_and_the_troubled() {
        let mut events = SampleLog::dff8_13(1800.0).result.events;
        assert!(events.len() > 900);
        events.kept[500].quality = "unresolved".into();
        let shown: Vec<usize> = chosen(&events).map(|(position, _)| position).collect();
        assert_eq!(shown.len(), 2 * EDGE + 1);
        assert!(shown.contains(&500) && shown.is_sorted());
        assert!(remark(&events).contains("--events FILE.csv"));
        assert_eq!(chosen(&events[..300]).count(), 300);
    }

    #[test]
    fn a_missing_coefficient_is_a_dash() {
        assert_eq!(coefficient(None, None), "–");
        assert_eq!(coefficient(Some(1.24), Some(0.00123)), "1.2400 ± 0.0012");
    }
}
