//! Stick and slip as tints behind the force.

use super::context::Context;
use super::fit::rest_s;
use super::plot::Plot;
use crate::replay::result::EventSummary;

/// Mean spacing of slips, px, below which their share of time is shown instead.
const APART_PX: f64 = 4.5;
/// Cycles per column of such a share, so that adjacent columns do not differ at random.
const CYCLES: f64 = 4.0;
/// Least width of a column, px.
const COLUMN_PX: f64 = 4.0;
/// Levels of tint; the level is proportional to the square root of the share.
const LEVELS: f64 = 5.0;

/// Tints stick and slip in a plot.
pub(super) fn shade(context: &Context<'_>, plot: &mut Plot) {
    let events = &context.result.events;
    let Some(first) = events.first() else { return };
    if slips_apart(context, plot) {
        shade_each(context, plot, events);
    } else {
        shade_shares(context, plot, first.onset_s - rest_s(first) - context.zero_s);
    }
}

/// Tints every slip of `events`, and the rest from before the first event of the log on.
pub(super) fn shade_each(context: &Context<'_>, plot: &mut Plot, events: &[EventSummary]) {
    let Some(first) = context.result.events.first() else { return };
    let zero_s = context.zero_s;
    shade_rest(context, plot, (first.onset_s - rest_s(first) - zero_s, plot.x.domain.1));
    events.iter().for_each(|e| plot.shade("slip", e.onset_s - zero_s, e.stop_s - zero_s));
}

/// Tints a rest, except where it is not known that the block rests.
fn shade_rest(context: &Context<'_>, plot: &mut Plot, (mut from, to): (f64, f64)) {
    for (start_s, stop_s) in unclear(context) {
        plot.shade("stick", from, to.min(start_s - context.zero_s));
        from = from.max(stop_s - context.zero_s);
    }
    plot.shade("stick", from, to);
}

/// Stretches in which the block may slide, in order: a constant force, unless the winch was held,
/// falls that are not slips, and gaps in which a slip finds room.
pub(super) fn unclear(context: &Context<'_>) -> Vec<(f64, f64)> {
    let stretches = &context.result.stretches;
    let steady = stretches.steady.iter().filter(|it| it.moving != Some(false));
    let steady = steady.map(|it| (it.start_s, it.stop_s));
    let others = stretches.not_understood.iter().map(|it| (it.start_s, it.stop_s));
    let slip_s = context.result.events.first().map_or(0.0, |event| event.slip_s);
    let gaps = context.recorder.gaps_s();
    let gaps = gaps.into_iter().filter(|(from_s, to_s)| to_s - from_s > slip_s);
    let mut all: Vec<_> = steady.chain(others).chain(gaps).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Whether slips are far enough apart to be drawn one by one.
fn slips_apart(context: &Context<'_>, plot: &Plot) -> bool {
    let events = &context.result.events;
    let Some((first, last)) = events.first().zip(events.last()) else { return true };
    let spread_px = plot.x.at(last.onset_s) - plot.x.at(first.onset_s);
    events.found() < 2 || spread_px / (events.found() - 1) as f64 >= APART_PX
}

/// Tints columns by the share of time spent slipping.
fn shade_shares(context: &Context<'_>, plot: &mut Plot, rest_from: f64) {
    let (low, high) = plot.x.domain;
    let width_px = plot.x.range.1 - plot.x.range.0;
    let events = &context.result.events;
    let spacing_px = width_px / events.found() as f64;
    let columns = (width_px / (CYCLES * spacing_px).max(COLUMN_PX)).max(1.0) as usize;
    let width = (high - low) / columns as f64;
    let mut shares = vec![0.0; columns];
    let next = events.iter().skip(1).map(|event| event.index);
    for (event, next) in events.iter().zip(next.chain([events.found() as u32])) {
        // Each event that is kept stands for those up to the next.
        let weight = f64::from(next.saturating_sub(event.index));
        add_share(&mut shares, (event, weight), low + context.zero_s, width);
    }
    let level = |share: &f64| (share.clamp(0.0, 1.0).sqrt() * LEVELS).ceil() as usize;
    let levels: Vec<usize> = shares.iter().map(level).collect();
    let mut from = 0;
    for run in levels.chunk_by(|a, b| a == b) {
        let (start, end) = (low + from as f64 * width, low + (from + run.len()) as f64 * width);
        match run.first() {
            Some(0) => shade_rest(context, plot, (start.max(rest_from), end)),
            Some(level) => plot.shade(&format!("slip level-{level}"), start, end),
            None => {}
        }
        from += run.len();
    }
}

fn add_share(
    shares: &mut [f64],
    (event, weight): (&EventSummary, f64),
    start_s: f64,
    width_s: f64,
) {
    let column = |time_s: f64| ((time_s - start_s) / width_s).max(0.0) as usize;
    let (from, to) = (column(event.onset_s), column(event.stop_s));
    for (i, share) in shares.iter_mut().enumerate().take(to + 1).skip(from) {
        let begins = start_s + i as f64 * width_s;
        let overlap_s = event.stop_s.min(begins + width_s) - event.onset_s.max(begins);
        *share += weight * overlap_s.max(0.0) / width_s;
    }
}

#[cfg(test)]
mod tests {
    use super::super::history::history;
    use super::super::sample_log::SampleLog;
    use super::*;
    use crate::replay::stretches::SteadySummary;

    /// Width that is tinted as rest.
    fn tinted_px(log: &SampleLog) -> f64 {
        let recorder = log.recorder();
        let figure = history(&Context::new(&log.result, &recorder), None).unwrap();
        let width = |tint: &str| {
            let width = tint.split("width=\"").nth(1).unwrap().split('"').next().unwrap();
            width.parse::<f64>().unwrap()
        };
        let tints = figure.drawings[0][0].split("<rect ");
        tints.filter(|it| it.starts_with("class=\"stick\"")).map(width).sum::<f64>()
    }

    /// What the block did where samples are missing is not known.
    #[test]
    fn a_gap_is_no_rest() {
        let mut log = SampleLog::dff8_13(60.0);
        log.result.events.kept.retain(|event| event.stop_s < 30.0);
        let whole = tinted_px(&log);
        log.times_s.drain(512..832);
        log.steps.drain(512..832);
        let less = whole - tinted_px(&log);
        assert!((350.0..380.0).contains(&less), "20 of 60 s: {less}");
    }

    /// A block that may slide is not tinted as one at rest, whether slips are drawn one by one or
    /// not.
    #[test]
    fn a_steady_stretch_is_no_rest() {
        for duration_s in [60.0, 3600.0] {
            let mut log = SampleLog::dff8_13(duration_s);
            let half_s = duration_s / 2.0;
            log.result.events.kept.retain(|event| event.stop_s < half_s);
            let steady = |moving| SteadySummary {
                start_s: half_s,
                stop_s: duration_s,
                force_over_weight: 0.78,
                std: 0.001,
                moving,
                sliding: (0.78, 0.001),
            };
            log.result.stretches.steady = vec![steady(Some(false))];
            let held = tinted_px(&log);
            for moving in [Some(true), None] {
                log.result.stretches.steady = vec![steady(moving)];
                let less = held - tinted_px(&log);
                assert!((500.0..600.0).contains(&less), "{duration_s} s, {moving:?}: {less}");
            }
        }
    }
}
