//! The display: few large numbers, and problems in plain words.

use std::time::Duration;

use floe_core::{Coefficient, Effect, Estimate};
use floe_firmware::line::Weighed;
use floe_firmware::weighing::Load;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style, Stylize};
use ratatui::text::{Line, Span, Text};
use ratatui::widgets::Paragraph;

use crate::card;
use crate::rounding::narrow;

use super::ask::Ask;
use super::band::{band, is_stale, is_weighing};
use super::digits::{self, big};
use super::flow::{flow, wrapped};
use super::plain::coefficient;
use super::state::State;
use super::verdict::{Level, verdict};
use super::{phase_plane, trace};

/// Size of the terminal below which the numbers are small.
const LARGE: (u16, u16) = (74, 15);
/// Height of the terminal from which the state is large too.
const LARGE_BAND: u16 = 20;
/// Smallest height of the trace.
const TRACE_ROWS: u16 = 4;
/// Width of the terminal from which the phase plane is drawn next to the trace.
const PLANE_FROM: u16 = 110;
/// Largest number of rows of a verdict or a question.
const MOST_ROWS: usize = 4;

/// Draws all parts, for a terminal of any size.
pub fn draw(frame: &mut Frame<'_>, state: &State, ask: &Ask, place: &str, now: Duration) {
    let area = frame.area();
    let large = area.width >= LARGE.0 && area.height >= LARGE.1;
    let stale = if is_stale(state, now) { Style::new().dim() } else { Style::new() };
    let verdict = verdict_rows(state, now, area.width);
    let last = last_rows(state, ask, now, area.width);
    let words = match ask.keys() {
        Some(keys) => flow(keys.into_iter().map(Span::raw).collect(), area.width),
        None => words(state, area.width),
    };
    let heights = [verdict.height(), last.height(), words.len()].map(|rows| rows as u16);
    let [top, wrong, doing, numbers, below, force, end] = rows(area, large, ask.is_open(), heights);
    frame.render_widget(title(state, place, area.width), top);
    frame.render_widget(verdict, wrong);
    frame.render_widget(band_rows(state, now, doing), doing);
    let shown = self::numbers(state, now);
    if large {
        draw_large(frame, numbers, shown, stale)
    } else {
        draw_small(frame, numbers, shown, stale)
    }
    frame.render_widget(Paragraph::new(words).style(stale), below);
    if force.height >= TRACE_ROWS {
        draw_force(frame, force, state, stale);
    }
    frame.render_widget(last, end);
}

/// Draws the trace, and the phase plane if there is room.
fn draw_force(frame: &mut Frame<'_>, area: Rect, state: &State, style: Style) {
    if area.width < PLANE_FROM {
        return trace::draw(frame, area, state, style);
    }
    let parts = [Constraint::Fill(2), Constraint::Length(1), Constraint::Fill(1)];
    let [left, _, right] = Layout::horizontal(parts).areas(area);
    trace::draw(frame, left, state, style);
    phase_plane::draw(frame, right, state, style);
}

/// A question, else the reply to the last command, else the keys.
fn last_rows(state: &State, ask: &Ask, now: Duration, width: u16) -> Text<'static> {
    let reply = state.reply(now).filter(|_| !ask.is_open());
    if !ask.is_open() && reply.is_none() {
        let keys = ask.text();
        let parts: Vec<Span<'_>> = keys.split("  ").map(|key| Span::raw(key.to_string())).collect();
        let first = flow(parts, width).into_iter().next().unwrap_or_default();
        return Text::from(first).style(Modifier::DIM);
    }
    let style = if ask.is_open() { Modifier::REVERSED } else { Modifier::BOLD };
    rows_of(&reply.unwrap_or_else(|| ask.text()), width).style(style)
}

fn rows_of(text: &str, width: u16) -> Text<'static> {
    let rows = wrapped(text, width).into_iter().take(MOST_ROWS);
    Text::from(rows.map(Line::from).collect::<Vec<_>>())
}

/// Heights of title, verdict, state, numbers, words, trace and keys. If there is not enough room,
/// an open question has priority, then the verdict, then the numbers.
fn rows(area: Rect, large: bool, asking: bool, heights: [u16; 3]) -> [Rect; 7] {
    let [verdict, end, words] = heights;
    let mut left = area.height;
    let mut grant = |wanted: u16| {
        let granted = wanted.min(left);
        left -= granted;
        granted
    };
    let question = grant(if asking { end } else { 0 });
    let wrong = grant(verdict);
    let numbers = grant(if large { digits::ROWS as u16 + 2 } else { 3 });
    let last = question + grant(if asking { 0 } else { end });
    let high = large && area.height >= LARGE_BAND;
    let band = grant(if high { digits::ROWS as u16 } else { 1 });
    let top = grant(1);
    let words = grant(words);
    let trace = grant(area.height);
    let all = [top, wrong, band, numbers, words, trace, last];
    Layout::vertical(all.map(Constraint::Length)).areas(area)
}

/// The title with as many of its parts as fit.
fn title(state: &State, place: &str, width: u16) -> Paragraph<'static> {
    let mut parts = vec![format!(" floe {place}")];
    if let Some((run, settings)) = &state.test {
        let name = if settings.name.is_empty() { "" } else { " " };
        parts.push(format!("test {run}{name}{}", settings.name));
        let slope = settings.config.slope_rad.to_degrees();
        let slope = if slope != 0.0 { format!(", {slope:.1}°") } else { String::new() };
        parts.push(format!("{} N{slope}", card::weight(settings)));
    }
    if let Some(last) = state.trace.back() {
        let seconds = (last.index as f64 / state.rate_hz()) as u64;
        parts.push(format!("{}:{:02}", seconds / 60, seconds % 60));
    }
    let first = flow(parts.into_iter().map(Span::raw).collect(), width).into_iter().next();
    Paragraph::new(first.unwrap_or_default()).style(Modifier::BOLD)
}

fn verdict_rows(state: &State, now: Duration, width: u16) -> Text<'static> {
    let verdict = verdict(state, now);
    let (ink, ground) = match verdict.level {
        Level::Bad => (Color::White, Color::Red),
        Level::Note => (Color::Black, Color::Yellow),
        Level::Good => (Color::Black, Color::Green),
    };
    let style = Style::new().fg(ink).bg(ground).add_modifier(Modifier::BOLD);
    let rows = wrapped(&verdict.text, width.saturating_sub(1)).into_iter().take(MOST_ROWS);
    Text::from(rows.map(|row| Line::from(format!(" {row}"))).collect::<Vec<_>>()).style(style)
}

/// The state of the block, large if there is room.
fn band_rows(state: &State, now: Duration, area: Rect) -> Paragraph<'static> {
    let (word, ground) = band(state, now);
    let style = Style::new().fg(Color::Black).bg(ground).add_modifier(Modifier::BOLD);
    let rows: Vec<String> = if usize::from(area.height) >= digits::ROWS {
        big(word).map(|row| format!("  {row}")).to_vec()
    } else {
        vec![format!(" {word}")]
    };
    Paragraph::new(rows.into_iter().map(Line::from).collect::<Vec<_>>()).style(style)
}

/// A number: its name, its digits, and the text below.
type Number = (String, Option<String>, String);

fn force(state: &State) -> Number {
    let last = state.trace.back().filter(|_| state.testing == Some(true));
    let text = last.and_then(|sample| sample.force_n).map(|force| fit(force, 5));
    let rate = last.and_then(|sample| sample.rate_n_per_s).filter(|rate| rate.is_finite());
    let rate = rate.map(|rate| format!("{rate:+.0} N/s"));
    ("force, N".to_string(), text, rate.unwrap_or_default())
}

fn mean(name: &str, estimate: Option<Estimate>) -> Number {
    let text = estimate.map(|estimate| format!("{:.4}", estimate.mean));
    let below = estimate.map(|estimate| {
        let events = estimate.events;
        match estimate.combined_std() {
            Some(std) => format!("± {} ({events} events)", narrow(std.into())),
            None => "one event: no ± yet".to_string(),
        }
    });
    (format!("{name}, mean"), text, below.unwrap_or_default())
}

fn numbers(state: &State, now: Duration) -> [Number; 3] {
    if let Some((weighed, _)) = state.weighed.filter(|_| is_weighing(state, now)) {
        return weighing(&weighed);
    }
    let report = state.report.as_ref();
    [
        force(state),
        mean("mu_s", report.and_then(|report| report.mu_s)),
        mean("mu", report.and_then(|report| report.mu)),
    ]
}

/// Numbers of a weighing.
fn weighing(weighed: &Weighed) -> [Number; 3] {
    let load = weighed.load.ok();
    let swing = load.and_then(|load| load.swing);
    // As many decimals as fit in large digits.
    let decimals = |load: Load| if load.value < 1000.0 { 2 } else { 1 };
    let seconds = format!("{:.0} s of 64", weighed.duration_s);
    let excess = swing.map(|swing| format!("{:.2} N taken off", swing.excess));
    [
        (
            "weight, N".to_string(),
            load.map(|load| format!("{:.*}", decimals(load), load.value)),
            load.map(|load| format!("± {:.*} N", decimals(load), load.std)).unwrap_or_default(),
        ),
        ("swing, s".to_string(), swing.map(|swing| format!("{:.2}", swing.period_s)), seconds),
        (
            "swing, °".to_string(),
            swing.map(|swing| format!("{:.1}", swing.amplitude_rad.to_degrees())),
            excess.unwrap_or_default(),
        ),
    ]
}

/// A number in at most `width` characters, with decimals removed first.
fn fit(value: f32, width: usize) -> String {
    let [long, short] = [1, 0].map(|decimals| format!("{value:.decimals$}"));
    if long.len() <= width { long } else { short }
}

fn draw_large(frame: &mut Frame<'_>, area: Rect, numbers: [Number; 3], style: Style) {
    let thirds = [Constraint::Ratio(1, 3); 3];
    let [left, middle, right] = Layout::horizontal(thirds).areas(area);
    for (area, (name, text, below)) in [left, middle, right].into_iter().zip(numbers) {
        let rows = big(text.as_deref().unwrap_or("---"));
        let mut lines = vec![Line::from(name)];
        lines.extend(rows.map(|row| Line::from(Span::styled(row, Modifier::BOLD))));
        lines.push(Line::from(Span::styled(below, Modifier::BOLD)));
        frame.render_widget(Paragraph::new(lines).style(style), area);
    }
}

fn draw_small(frame: &mut Frame<'_>, area: Rect, numbers: [Number; 3], style: Style) {
    let rows = numbers.map(|(name, text, below)| {
        let text = text.unwrap_or("---".to_string());
        Line::from(vec![
            Span::raw(format!("{name:<10} ")),
            Span::styled(format!("{text:>7} {below}"), Modifier::BOLD),
        ])
    });
    frame.render_widget(Paragraph::new(rows.to_vec()).style(style), area);
}

/// All text below the numbers, in rows.
fn words(state: &State, width: u16) -> Vec<Line<'static>> {
    let parts = [event(state), about(state), quantities(state), samples(state)];
    parts.into_iter().flat_map(|parts| flow(parts, width)).collect()
}

fn event(state: &State) -> Vec<Span<'static>> {
    let Some(event) = &state.event else { return vec![Span::raw("no slip yet")] };
    let at = state.seconds(event.onset);
    let reason = event.reason.map(|reason| format!(": {reason}")).unwrap_or_default();
    let (number, quality) = (event.index, event.quality);
    let parts = [
        format!("event {number} at {at:.1} s"),
        format!("mu_s {}", coefficient(event.mu_s)),
        format!("mu {}", coefficient(event.mu)),
        format!("{quality}{reason}"),
    ];
    parts.map(Span::raw).to_vec()
}

/// The newest slip, while the board has only a first answer on it.
fn about(state: &State) -> Vec<Span<'static>> {
    let Some(about) = &state.about else { return Vec::new() };
    let at = about.index as f64 / state.rate_hz();
    let text = |name: &str, value: &Coefficient| {
        format!("{name} ~ {:.3} ± {:.3}", value.value, value.combined_std().max(0.001))
    };
    let mut parts = vec![format!("provisional at {at:.1} s"), text("mu_s", &about.answer.mu_s)];
    parts.extend(about.answer.mu.map(|mu| text("mu", &mu)));
    parts.into_iter().map(|part| Span::raw(part).dim()).collect()
}

fn quantities(state: &State) -> Vec<Span<'static>> {
    let report = state.report.as_ref();
    // Rejected events have no coefficients to show.
    let told = report.filter(|report| report.mu_s.or(report.mu).is_some());
    let parts = [
        ("noise", report.and_then(|report| report.noise_n), "N", 1),
        (
            "loading",
            told.and_then(|report| report.loading_rate_n_per_s).map(|rate| rate.value),
            "N/s",
            0,
        ),
        ("a slip every", told.and_then(|report| report.recurrence_s), "s", 2),
        ("k", told.and_then(|report| report.stiffness_n_per_m).map(|k| k / 1000.0), "kN/m", 1),
        ("converter", state.temperature_c, "°C", 1),
    ];
    let parts = parts.iter().filter_map(|&(name, value, unit, decimals)| {
        value.map(|value| format!("{name} {value:.decimals$} {unit}"))
    });
    let shown: Vec<&str> =
        told.iter().flat_map(|report| report.found.iter()).map(Effect::name).collect();
    let shown = (!shown.is_empty()).then(|| format!("shows {}", shown.join(", ")));
    parts.chain(shown).map(Span::raw).collect()
}

/// Counters; those above zero are marked.
fn samples(state: &State) -> Vec<Span<'static>> {
    let counters = state.report.map(|report| report.counters).unwrap_or_default();
    let health = state.health.unwrap_or_default();
    let (marked, plain) = (Style::new().fg(Color::LightRed).bold(), Style::new());
    let mut spans = vec![Span::raw(card(state))];
    for (name, count) in [
        ("lost", u64::from(health.overruns)),
        ("missing", counters.missing.into()),
        ("bad", counters.rejected.into()),
        ("out of range", counters.saturated.into()),
        ("damaged lines", state.damaged),
        ("unknown lines", state.unknown),
    ] {
        if count > 0 || !name.ends_with("lines") {
            let style = if count > 0 { marked } else { plain };
            spans.push(Span::styled(format!("{name} {count}"), style));
        }
    }
    if let Some(period_s) = health.period_s.filter(|&period_s| period_s > 0.0) {
        spans.push(Span::raw(format!("{:.3} Hz", 1.0 / period_s)));
    }
    spans
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
