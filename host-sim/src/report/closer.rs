//! Data for the script of the page, which shows values and close-ups: samples and events as
//! numbers, in the displayed units.

use super::context::Context;
use super::fit::reach_s;
use super::table::chosen;
use crate::replay::result::EventSummary;
use crate::rounding::trimmed;

/// Largest number of samples; a log at 16 Hz has all that are kept at full resolution.
const MOST_SAMPLES: usize = 1 << 16;
/// Largest number of events.
const MOST_EVENTS: usize = 3000;
/// Upper limit of the quantization step of forces, as a share of the log's range.
const RESOLUTION: f64 = 2e-4;

/// The data block of the page: numbers only, so that it holds no text of a log.
pub(super) fn data(context: &Context<'_>) -> String {
    let Some((low_n, high_n)) = context.recorder.range_n() else { return String::new() };
    let range = ((high_n - low_n) * context.force.factor).max(1e-9);
    let step = 10_f64.powf((range * RESOLUTION).log10().floor());
    let stretches = stretches(context);
    let clips: Vec<String> = stretches.iter().map(|stretch| clip(context, stretch, step)).collect();
    let covered = |event: &EventSummary| {
        let within = |s: &Stretch<'_>| (s.start_s..s.end_s).contains(&event.onset_s);
        stretches.iter().any(within)
    };
    let events = &context.result.events;
    let mut wanted: Vec<usize> = chosen(events).map(|(position, _)| position).collect();
    // Each row of the table opens a closer look; the others are left out first.
    let room = MOST_EVENTS.saturating_sub(wanted.len());
    let is_other = |i: &usize| wanted.binary_search(i).is_err();
    let others = (0..events.len()).filter(|i| is_other(i) && events.get(*i).is_some_and(covered));
    let others: Vec<usize> = others.take(room).collect();
    wanted.extend(others);
    wanted.sort_unstable();
    let events: Vec<String> = wanted.into_iter().filter_map(|i| event(context, i, step)).collect();
    format!(
        "<script type=\"application/json\" id=\"data\">{{\"zero\":{},\"period\":{},\"step\":{step:e},\
         \"noise\":{},\"unit\":\"{}\",\"clips\":[{}],\"events\":[{}]}}</script>\n",
        context.zero_s,
        context.recorder.period_s(),
        context.result.noise_n.map_or("null".into(), |n| short(n * context.force.factor)),
        context.force.name,
        clips.join(","),
        events.join(",\n"),
    )
}

/// Consecutive samples.
struct Stretch<'a> {
    first: u64,
    start_s: f64,
    end_s: f64,
    forces_n: &'a [f32],
}

/// The stretches at full resolution; if not all fit, those nearest to the event in focus.
fn stretches<'a>(context: &Context<'a>) -> Vec<Stretch<'a>> {
    let period_s = context.recorder.period_s();
    let stretch = |(first, start_s, forces_n): (u64, f64, &'a [f32])| {
        let end_s = start_s + forces_n.len() as f64 * period_s;
        Stretch { first, start_s, end_s, forces_n }
    };
    let mut all: Vec<_> = context.recorder.clips.stretches().map(stretch).collect();
    let near_s = context.focus().map_or(0.0, |focus| focus.event.onset_s);
    let away_s = |s: &Stretch<'_>| (s.start_s - near_s).max(near_s - s.end_s).max(0.0);
    all.sort_by(|a, b| away_s(a).total_cmp(&away_s(b)));
    let mut samples = 0;
    all.retain(|s| {
        samples += s.forces_n.len();
        samples <= MOST_SAMPLES
    });
    all.sort_by_key(|s| s.first);
    all
}

/// Number of the first sample, its time, and every force in steps.
fn clip(context: &Context<'_>, stretch: &Stretch<'_>, step: f64) -> String {
    let force = |&force_n: &f32| {
        let steps = (f64::from(force_n) * context.force.factor / step).round();
        if steps.is_finite() { format!("{steps}") } else { "null".into() }
    };
    let forces: Vec<String> = stretch.forces_n.iter().map(force).collect();
    let start = moment(stretch.start_s - context.zero_s);
    format!("[{},{start},[{}]]", stretch.first, forces.join(","))
}

/// The fields of an event, in the order of the script: index, time of the fit before the slip, onset,
/// length of the slip, time of the fit after it, fs, fp, fe, pull, omega, slack, mu_s and mu.
fn event(context: &Context<'_>, position: usize, step: f64) -> Option<String> {
    let events = &context.result.events;
    let e = events.get(position)?;
    let (before_s, after_s) = reach_s(events, position);
    let force = |f: f64| short((f * context.force.factor / step * 10.0).round() * step / 10.0);
    let maybe = |value: Option<f64>| value.map_or("null".into(), short);
    Some(format!(
        "[{},{},{},{},{},{},{},{},{},{},{},{},{}]",
        e.index,
        decimal(before_s, 3),
        moment(e.onset_s - context.zero_s),
        short(e.stop_s - e.onset_s),
        decimal(after_s, 3),
        force(e.static_force_n),
        force(e.dynamic_force_n),
        force(e.restick_force_n),
        short(e.loading_rate_n_per_s * context.force.factor),
        maybe(e.omega_rad_per_s),
        u8::from(e.slack),
        maybe(e.mu_s),
        maybe(e.mu),
    ))
}

/// A number with seven significant digits, without trailing zeros.
fn short(x: f64) -> String {
    let decimals = if x == 0.0 { 0 } else { (6 - x.abs().log10().floor() as i32).clamp(0, 12) };
    decimal(x, decimals as usize)
}

/// A time to a microsecond, however late in the log: in a slip the force falls by kilonewtons in a
/// second, and a residual is the difference of two forces at one time.
fn moment(time_s: f64) -> String {
    decimal(time_s, 6)
}

fn decimal(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return "null".into();
    }
    trimmed(&format!("{x:.decimals$}")).into()
}

#[cfg(test)]
mod tests {
    use super::super::recorder::Recorder;
    use super::super::sample_log::SampleLog;
    use super::*;
    use crate::replay::result::ReplayResult;

    fn parsed(result: &ReplayResult, recorder: &Recorder) -> serde_json::Value {
        let block = data(&Context::new(result, recorder));
        let json = block.split_once('>').unwrap().1.rsplit_once("</script>").unwrap().0;
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn samples_and_events_are_told_as_they_are() {
        let log = SampleLog::dff8_13(60.0);
        let data = parsed(&log.result, &log.recorder());
        let step = data["step"].as_f64().unwrap();
        let told = data["clips"][0][2][100].as_f64().unwrap() * step;
        let force = f64::from(log.steps[100].sample.force_n.unwrap());
        assert!((told - force).abs() <= step / 2.0 + 1e-9, "{told} {force}");
        let events = data["events"].as_array().unwrap();
        assert_eq!(events.len(), log.result.events.len());
        assert!((events[3][2].as_f64().unwrap() - log.result.events[3].onset_s).abs() < 1e-4);
    }

    /// The script adds `zero` to every time that it shows.
    #[test]
    fn times_from_the_start_of_the_log_come_with_it() {
        let log = SampleLog::dff8_13(10.0);
        let mut recorder = Recorder::new(16.0);
        let times_s = (0..).map(|i| 1_712_345_678.25 + f64::from(i) / 16.0);
        times_s.zip(&log.steps).for_each(|(time_s, step)| recorder.push(time_s, step));
        let data = parsed(&log.result, &recorder);
        assert_eq!((&data["zero"], &data["clips"][0][1]), (&1_712_345_678.into(), &0.25.into()));
        assert_eq!(parsed(&log.result, &log.recorder())["zero"], 0);
    }

    /// After hours of record the residuals of the script are still those of the fit.
    #[test]
    fn a_late_time_is_as_exact_as_an_early_one() {
        let late_s = 80_000.0;
        let mut log = SampleLog::dff8_13(20.0);
        let mut recorder = Recorder::new(16.0);
        log.times_s.iter().zip(&log.steps).for_each(|(t, step)| recorder.push(late_s + t, step));
        for event in &mut log.result.events.kept {
            (event.onset_s, event.stop_s) = (event.onset_s + late_s, event.stop_s + late_s);
        }
        let data = parsed(&log.result, &recorder);
        for (told, event) in data["events"].as_array().unwrap().iter().zip(log.result.events.iter())
        {
            assert!((told[2].as_f64().unwrap() - event.onset_s).abs() < 1e-6, "{told}");
        }
    }

    #[test]
    fn the_rows_of_the_table_are_told_whatever_the_number_of_events() {
        let mut log = SampleLog::dff8_13(3600.0);
        let first = log.result.events[0].clone();
        let event = |index: u32| {
            let onset_s = 0.7 * f64::from(index);
            EventSummary { index, onset_s, stop_s: onset_s + 0.2, ..first.clone() }
        };
        log.result.events.kept = (0..5000).map(event).collect();
        let data = parsed(&log.result, &log.recorder());
        let told: Vec<u64> =
            data["events"].as_array().unwrap().iter().map(|e| e[0].as_u64().unwrap()).collect();
        assert!(told.len() == MOST_EVENTS && told.is_sorted());
        for (_, row) in chosen(&log.result.events) {
            assert!(told.contains(&row.index.into()), "{}", row.index);
        }
    }

    #[test]
    fn what_has_no_force_is_null() {
        let log = SampleLog::troubled(40.0);
        let data = parsed(&log.result, &log.recorder());
        let hidden = log.steps.iter().position(|step| step.sample.force_n.is_none()).unwrap();
        assert!(data["clips"][0][2][hidden].is_null());
        assert!(data["events"][1][9].is_null(), "no omega");
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, 1.0, -0.25, 1234.56789, 86_400.062_5, 0.000_123_456_78];
        let texts = ["0", "1", "-0.25", "1234.568", "86400.06", "0.0001234568"];
        assert_eq!(numbers.map(short), texts);
        assert_eq!(short(f64::NAN), "null");
    }
}
