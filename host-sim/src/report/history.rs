//! The force over the whole log.

use super::context::{Context, Focus};
use super::envelope::Bucket;
use super::figure::{Figure, both, line_key, tint_key};
use super::number::fixed;
use super::plot::{Axis, Layout, Plot, Spec};
use super::scale::{Steps, TimeUnit, extent};
use super::shading::{shade, unclear};
use super::svg::{Path, rectangle};
use super::zoom::window_s;

/// Largest number of samples per px for which every sample is drawn.
const SAMPLES_PER_PX: usize = 4;

/// The figure; none if no sample had a force.
pub(super) fn history(context: &Context<'_>, focus: Option<&Focus<'_>>) -> Option<Figure> {
    context.recorder.range_n()?;
    let drawing = both(|layout| draw(context, focus, layout));
    let mut keys = vec![line_key("force", "force")];
    if !context.result.events.is_empty() {
        keys.push(tint_key("stick", "at rest (stick)"));
        keys.push(tint_key("slip", "moving (slip)"));
    }
    if context.recorder.lost_s().next().is_some() {
        keys.push(line_key("lost", "samples missing, rejected or saturated"));
    }
    let zoomed = if focus.is_some() { " The box is the stretch of the next figure." } else { "" };
    let tint = match context.result.events.is_empty() {
        true => "",
        false => ", and a tint that deepens with the share of time in motion",
    };
    let unclear = match context.result.events.is_empty() || unclear(context).is_empty() {
        true => "",
        false => " Where it is not known whether the block rests there is no tint.",
    };
    let caption = format!(
        "Force in the cable over the whole log; where the samples do not fit, a band from the \
         smallest to the largest{tint}.{unclear}{zoomed}"
    );
    Some(Figure { class: "history", drawings: vec![drawing], keys, caption })
}

fn draw(context: &Context<'_>, focus: Option<&Focus<'_>>, layout: Layout) -> String {
    let mut plot = Plot::new(&spec(context, layout));
    shade(context, &mut plot);
    let width_px = (plot.x.range.1 - plot.x.range.0) as usize;
    let buckets = context.recorder.envelope.buckets();
    let every =
        context.recorder.envelope.width() == 1 && buckets.len() <= SAMPLES_PER_PX * width_px;
    if every {
        let force = |b: &Bucket| if b.used > 0 { f64::from(b.max_n) } else { f64::NAN };
        plot.line("force", buckets.iter().map(|b| context.shown((b.start_s, force(b)))));
    } else {
        let columns: Vec<Bucket> = grouped(buckets, buckets.len().div_ceil(width_px));
        let band = band(context, &plot, &columns);
        plot.draw(&band);
    }
    draw_lost(context, &mut plot);
    if let Some(focus) = focus {
        let (from_s, to_s) = window_s(context, focus, layout);
        let (from, to) = (plot.x.at(from_s - context.zero_s), plot.x.at(to_s - context.zero_s));
        let (bottom, top) = plot.y.range;
        plot.draw(&rectangle("box", (from, top + 1.0), (to.max(from + 3.0), bottom - 1.0)));
    }
    plot.finish()
}

fn spec(context: &Context<'_>, layout: Layout) -> Spec<'static> {
    let (start_s, end_s) = context.recorder.span_s().unwrap_or((0.0, 1.0));
    let (low_n, high_n) = context.recorder.range_n().unwrap_or((0.0, 1.0));
    let factor = context.force.factor;
    let unit = TimeUnit::of(end_s - start_s);
    Spec {
        id: "history",
        layout,
        size: layout.pick((1160.0, 310.0), (360.0, 250.0)),
        title: "Force history",
        description: "Force in the cable against time for the whole log, with the times at rest \
                      and in motion tinted.",
        x: Axis {
            domain: (start_s - context.zero_s, end_s - context.zero_s),
            steps: Steps::Time(unit),
            label: context.time_label(unit.name),
            readout: ("t", "s".into()),
        },
        y: Axis {
            domain: extent([low_n * factor, high_n * factor], 0.06),
            steps: Steps::Decimal,
            label: context.force_label(),
            readout: ("F", context.force.name.clone()),
        },
    }
}

fn grouped(buckets: &[Bucket], size: usize) -> Vec<Bucket> {
    let merge = |group: &[Bucket]| group.iter().copied().reduce(Bucket::merged);
    buckets.chunks(size.max(1)).filter_map(merge).collect()
}

/// An outline from smallest to largest force, one for every stretch without a gap.
fn band(context: &Context<'_>, plot: &Plot, columns: &[Bucket]) -> String {
    let mut path = Path::default();
    for run in columns.chunk_by(|a, b| a.used > 0 && b.used > 0) {
        let at = |b: &Bucket, force: f32| plot.at(context.shown((b.start_s, force.into())));
        let upper = run.iter().filter(|b| b.used > 0).map(|b| at(b, b.max_n));
        let lower = run.iter().rev().filter(|b| b.used > 0).map(|b| at(b, b.min_n));
        let mut outline = upper.chain(lower);
        let Some(first) = outline.next() else { continue };
        path.move_to(first);
        outline.for_each(|point| path.line_to(point));
        path.close();
    }
    path.element("band")
}

/// Bars along the top where samples have no force.
fn draw_lost(context: &Context<'_>, plot: &mut Plot) {
    let mut path = Path::default();
    let mut drawn = String::new();
    let top = plot.y.range.1;
    for time_s in context.recorder.lost_s() {
        let x = plot.x.at(time_s - context.zero_s);
        let place = fixed(x, 0);
        if place != drawn {
            path.bar(x, top, top + 9.0);
            drawn = place;
        }
    }
    plot.draw(&path.element("lost"));
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    /// In a short log, whose samples have a bucket each, and in a long one.
    #[test]
    fn a_gap_is_marked() {
        for duration_s in [60.0, 1800.0] {
            let mut log = SampleLog::dff8_13(duration_s);
            let bars = |log: &SampleLog| {
                let recorder = log.recorder();
                let figure = history(&Context::new(&log.result, &recorder), None).unwrap();
                figure.drawings[0][0].matches("class=\"lost\"").count()
            };
            assert_eq!(bars(&log), 0);
            log.times_s.drain(400..405);
            log.steps.drain(400..405);
            assert_eq!(bars(&log), 1, "{duration_s} s");
        }
    }
}
