//! The display: few numbers, large, and what is wrong in one line.

use std::time::Duration;

use floe_core::{Coefficient, Estimate, Phase};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::ask::Ask;
use super::digits::{self, big};
use super::state::State;
use super::trace;
use super::verdict::{Level, verdict};

/// Below this size the numbers are small.
const LARGE: (u16, u16) = (74, 15);
/// A trace of fewer rows shows nothing.
const TRACE_ROWS: u16 = 4;

/// Draws everything, into a terminal of any size.
pub fn draw(frame: &mut Frame<'_>, state: &State, ask: &Ask, place: &str, now: Duration) {
    let area = frame.area();
    let large = area.width >= LARGE.0 && area.height >= LARGE.1;
    let [top, wrong, numbers, words, force, last] = rows(area, large, ask.is_open());
    frame.render_widget(title(state, place), top);
    frame.render_widget(verdict_row(state, now), wrong);
    if large {
        draw_large(frame, numbers, state)
    } else {
        draw_small(frame, numbers, state)
    }
    let lines =
        vec![Line::from(event(state)), about(state), quantities(state).into(), samples(state)];
    frame.render_widget(Paragraph::new(lines), words);
    if force.height >= TRACE_ROWS {
        trace::draw(frame, force, state);
    }
    frame.render_widget(last_row(state, ask, now), last);
}

/// A question, else what came of the last answer, else the keys.
fn last_row(state: &State, ask: &Ask, now: Duration) -> Paragraph<'static> {
    let reply = state.reply(now).filter(|_| !ask.is_open());
    let style = if ask.is_open() {
        Modifier::REVERSED
    } else if reply.is_some() {
        Modifier::BOLD
    } else {
        Modifier::DIM
    };
    Paragraph::new(reply.unwrap_or_else(|| ask.text())).style(style)
}

/// Title, verdict, numbers, words, trace, keys. Where there is no room for all, an
/// open question stays longest, then the verdict, then the numbers.
fn rows(area: Rect, large: bool, asking: bool) -> [Rect; 6] {
    let mut left = area.height;
    let mut grant = |wanted: u16| {
        let granted = wanted.min(left);
        left -= granted;
        granted
    };
    let question = grant(u16::from(asking));
    let wrong = grant(1);
    let numbers = grant(if large { digits::ROWS as u16 + 2 } else { 3 });
    let last = question + grant(u16::from(!asking));
    let top = grant(1);
    let words = grant(4);
    let trace = grant(area.height);
    Layout::vertical([top, wrong, numbers, words, trace, last].map(Constraint::Length)).areas(area)
}

fn title(state: &State, place: &str) -> Paragraph<'static> {
    let mut text = format!(" floe {place}");
    if let Some((run, settings)) = &state.test {
        let name = if settings.name.is_empty() { "" } else { " " };
        text += &format!("   test {run}{name}{}", settings.name);
        let slope = settings.config.slope_rad.to_degrees();
        text += &format!("   {} N", settings.config.weight_n);
        if slope != 0.0 {
            text += &format!(", {slope:.1}°");
        }
    }
    if let Some(last) = state.trace.back() {
        let seconds = (last.index as f64 / state.rate_hz()) as u64;
        text += &format!("   {}:{:02}", seconds / 60, seconds % 60);
    }
    Paragraph::new(text).style(Modifier::BOLD)
}

fn verdict_row(state: &State, now: Duration) -> Paragraph<'static> {
    let verdict = verdict(state, now);
    let (ink, ground) = match verdict.level {
        Level::Bad => (Color::White, Color::Red),
        Level::Note => (Color::Black, Color::Yellow),
        Level::Good => (Color::Black, Color::Green),
    };
    let style = Style::new().fg(ink).bg(ground).add_modifier(Modifier::BOLD);
    Paragraph::new(format!(" {}", verdict.text)).style(style)
}

/// A number: what it is, its digits, what stands below.
type Number = (String, Option<String>, String);

fn force(state: &State) -> Number {
    let last = state.trace.back().filter(|_| state.testing == Some(true));
    let text = last.and_then(|sample| sample.force_n).map(|force| fit(force, 5));
    let phase = match last.map(|sample| sample.phase) {
        Some(Phase::Stick) => "sticks",
        Some(Phase::Slip) => "SLIPS",
        Some(Phase::Unknown) => "learning the noise",
        None => "",
    };
    ("force, N".to_string(), text, phase.to_string())
}

fn mean(name: &str, estimate: Option<Estimate>) -> Number {
    let text = estimate.map(|estimate| format!("{:.4}", estimate.mean));
    let below = estimate.map(|estimate| {
        let events = estimate.events;
        match estimate.combined_std() {
            Some(std) => format!("± {std:.4} ({events} events)"),
            None => "one event: no ± yet".to_string(),
        }
    });
    (format!("{name}, mean"), text, below.unwrap_or_default())
}

fn numbers(state: &State) -> [Number; 3] {
    let report = state.report.as_ref();
    [
        force(state),
        mean("mu_s", report.and_then(|report| report.mu_s)),
        mean("mu", report.and_then(|report| report.mu)),
    ]
}

/// At most so many characters, the decimals first to go.
fn fit(value: f32, width: usize) -> String {
    let texts = [1, 0].map(|decimals| format!("{value:.decimals$}"));
    let [long, short] = texts;
    if long.len() <= width { long } else { short }
}

fn draw_large(frame: &mut Frame<'_>, area: Rect, state: &State) {
    let thirds = [Constraint::Ratio(1, 3); 3];
    let [left, middle, right] = Layout::horizontal(thirds).areas(area);
    for (area, (name, text, below)) in [left, middle, right].into_iter().zip(numbers(state)) {
        let rows = big(text.as_deref().unwrap_or("---"));
        let mut lines = vec![Line::from(name)];
        lines.extend(rows.map(|row| Line::from(Span::styled(row, Modifier::BOLD))));
        lines.push(Line::from(Span::styled(below, Modifier::BOLD)));
        frame.render_widget(Paragraph::new(lines), area);
    }
}

fn draw_small(frame: &mut Frame<'_>, area: Rect, state: &State) {
    let rows = numbers(state).map(|(name, text, below)| {
        let text = text.unwrap_or("---".to_string());
        Line::from(vec![
            Span::raw(format!("{name:<10} ")),
            Span::styled(format!("{text:>7} {below}"), Modifier::BOLD),
        ])
    });
    frame.render_widget(Paragraph::new(rows.to_vec()), area);
}

fn event(state: &State) -> String {
    let Some(event) = &state.event else { return "no slip yet".to_string() };
    let at = state.seconds(event.onset);
    let text = |name: &str, value: Option<Coefficient>| match value {
        Some(value) => format!("   {name} {:.4} ± {:.4}", value.value, value.combined_std()),
        None => format!("   {name} -"),
    };
    let reason = event.reason.map(|reason| format!(": {reason}")).unwrap_or_default();
    let (number, quality) = (event.index + 1, event.quality);
    let (mu_s, mu) = (text("mu_s", event.mu_s), text("mu", event.mu));
    format!("slip {number} at {at:.1} s{mu_s}{mu}   {quality}{reason}")
}

/// The newest slip, as long as the board has no more than a first answer on it.
fn about(state: &State) -> Line<'static> {
    let Some(about) = &state.about else { return Line::default() };
    let at = about.index as f64 / state.rate_hz();
    let text = |name: &str, value: &Coefficient| {
        format!("   {name} ~ {:.3} ± {:.3}", value.value, value.combined_std())
    };
    let mu_s = text("mu_s", &about.answer.mu_s);
    let mu = about.answer.mu.map(|mu| text("mu", &mu)).unwrap_or_default();
    Line::from(format!("provisional at {at:.1} s{mu_s}{mu}")).dim()
}

fn quantities(state: &State) -> String {
    let Some(report) = &state.report else { return String::new() };
    let parts = [
        ("noise", report.noise_n, "N", 1),
        ("loading", report.loading_rate_n_per_s.map(|rate| rate.value), "N/s", 0),
        ("a slip every", report.recurrence_s, "s", 2),
        ("k", report.stiffness_n_per_m.map(|k| k / 1000.0), "kN/m", 1),
    ];
    let parts = parts.iter().filter_map(|&(name, value, unit, decimals)| {
        value.map(|value| format!("{name} {value:.decimals$} {unit}"))
    });
    parts.collect::<Vec<_>>().join("   ")
}

/// Counters, those above zero marked.
fn samples(state: &State) -> Line<'static> {
    let counters = state.report.map(|report| report.counters).unwrap_or_default();
    let health = state.health.unwrap_or_default();
    let (marked, plain) = (Style::new().fg(Color::LightRed).bold(), Style::new());
    let mut spans = vec![Span::raw(card(state))];
    for (name, count) in [
        ("lost", u64::from(health.overruns)),
        ("missing", counters.missing),
        ("bad", counters.rejected),
        ("out of range", counters.saturated),
        ("damaged lines", state.damaged),
        ("unknown lines", state.unknown),
    ] {
        if count > 0 || !name.ends_with("lines") {
            let style = if count > 0 { marked } else { plain };
            spans.push(Span::styled(format!("   {name} {count}"), style));
        }
    }
    if let Some(period_s) = health.period_s.filter(|&period_s| period_s > 0.0) {
        spans.push(Span::raw(format!("   {:.3} Hz", 1.0 / period_s)));
    }
    Line::from(spans)
}

fn card(state: &State) -> String {
    match &state.health {
        None => "card ?".to_string(),
        Some(health) if health.store_failures > 0 => {
            format!("CARD: {} not written", health.store_failures)
        }
        Some(health) if health.sectors == 0 => "card: nothing written yet".to_string(),
        Some(health) => format!("card ok, {} kB", health.sectors / 2),
    }
}
