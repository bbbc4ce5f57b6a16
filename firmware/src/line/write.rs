//! Formatting of lines.

use core::fmt;

use floe_core::{
    Change, Coefficient, Config, Estimate, Event, Provisional, Report, SampleTime, Stretch,
    StretchKind,
};

use super::fields::Writer;
use super::{About, Health, Line, LiveSample, Mean, Text, Weighed, checksum};
use crate::settings::Settings;
use crate::text::{Hex, Out, Show};

impl Line<'_> {
    /// The line with its checksum, without its end.
    ///
    /// # Errors
    /// The line is too long, which only a long text can cause.
    pub fn to_text(&self) -> Result<Text, fmt::Error> {
        let mut text = Text::new();
        let mut out = Writer(Out::new(&mut text));
        self.kind().show(&mut out.0);
        self.put_fields(&mut out);
        let sum = checksum(out.0.as_str());
        ("*", Hex(sum.into(), 4)).show(&mut out.0);
        out.0.end().map(|()| text)
    }

    fn kind(&self) -> &'static str {
        match self {
            Line::Start { .. } => "T",
            Line::Sample(_) => "S",
            Line::Spike(_) => "P",
            Line::About(_) => "A",
            Line::Event(_) => "E",
            Line::Change(_) => "C",
            Line::Stretch(_) => "F",
            Line::Report(_) => "R",
            Line::End { .. } => "Z",
            Line::Health(_) => "H",
            Line::Mean(_) => "M",
            Line::Weighed(_) => "G",
            Line::Note(_) => "N",
            Line::Mark { .. } => "W",
            Line::Sync { .. } => "Y",
            Line::Climate { .. } => "K",
            Line::Info(_) => "I",
            Line::Trouble(_) => "!",
        }
    }

    fn put_fields(&self, out: &mut Writer<'_>) {
        match self {
            Line::Start { run, settings } => start(out, *run, settings),
            Line::Sample(sample) => live_sample(out, sample),
            Line::Spike(index) => out.put(*index),
            Line::About(a) => about(out, a),
            Line::Event(e) => event(out, e),
            Line::Change(c) => change(out, c),
            Line::Stretch(s) => stretch(out, s),
            Line::Report(r) => report(out, r),
            Line::End { run } => out.put(*run),
            Line::Health(h) => health(out, h),
            Line::Mean(m) => mean(out, m),
            Line::Weighed(w) => weighed(out, w),
            Line::Mark { index, winch } => {
                out.put(*index);
                out.put_word(*winch);
            }
            Line::Sync { index, unix_ms } => {
                out.put(*index);
                out.put(*unix_ms);
            }
            Line::Climate { index, temperature_c, supply_v } => {
                out.put(*index);
                out.put_some_f32(*temperature_c);
                out.put_some_f32(*supply_v);
            }
            Line::Note(text) | Line::Info(text) | Line::Trouble(text) => out.put(*text),
        }
    }
}

fn start(out: &mut Writer<'_>, run: u32, settings: &Settings) {
    out.put(run);
    out.put(settings.name.as_str());
    let Config { rate_hz, weight_n, slope_rad, winch_m_per_s, range_n, calibration, .. } =
        settings.config;
    out.put_f32(rate_hz);
    out.put_f32(weight_n);
    out.put_f32(slope_rad);
    out.put_some_f32(winch_m_per_s);
    out.put_some_f32(range_n);
    out.put(calibration.tare_counts);
    out.put_f32(calibration.counts_per_n);
    out.put(calibration.range_counts.0);
    out.put(calibration.range_counts.1);
    around(out, settings);
}

/// Writes the settings outside the core's basic configuration: uncertainties, zero, notes, effects.
fn around(out: &mut Writer<'_>, settings: &Settings) {
    let Settings { effects, stds, weight_from, zero, notes, .. } = settings;
    out.put_some_word(*weight_from);
    stds.first().iter().for_each(|&std| out.put_some_f32(std));
    out.put_some_f32(zero.before_n);
    out.put_some_f32(zero.after_n);
    out.put_some_word(notes.kind);
    out.put_some_word(notes.track);
    notes.lengths().iter().for_each(|&length| out.put_some_f32(length));
    out.put_some(effects.enabled);
    out.put_some(effects.compiled);
    out.put_some_f32(stds.winch_m_per_s);
}

fn live_sample(out: &mut Writer<'_>, sample: &LiveSample) {
    out.put(sample.index);
    out.put_some_f32(sample.force_n);
    out.put_word(sample.flag);
    out.put_word(sample.phase);
    out.put(sample.gap);
    out.put_some_f32(sample.rate_n_per_s);
}

fn weighed(out: &mut Writer<'_>, weighed: &Weighed) {
    let load = weighed.load.ok();
    let swing = load.and_then(|load| load.swing);
    out.put_f32(weighed.duration_s);
    out.put_some_f32(load.map(|load| load.value));
    out.put_some_f32(load.map(|load| load.std));
    out.put_some_f32(swing.map(|swing| swing.period_s));
    out.put_some_f32(swing.map(|swing| swing.amplitude_rad));
    out.put_some_f32(swing.map(|swing| swing.excess));
    out.put_some_word(weighed.load.err());
}

fn about(out: &mut Writer<'_>, about: &About) {
    out.put(about.index);
    let Provisional { mu_s, mu } = about.answer;
    coefficient(out, Some(mu_s));
    coefficient(out, mu);
    systematic(out, Some(mu_s));
    systematic(out, mu);
}

fn event(out: &mut Writer<'_>, event: &Event) {
    out.put(event.index);
    time(out, event.onset);
    time(out, event.stop);
    out.put_f32(event.static_force_n);
    out.put_f32(event.dynamic_force_n);
    out.put_f32(event.peak_force_n);
    out.put_f32(event.restick_force_n);
    coefficient(out, event.mu_s);
    coefficient(out, event.mu);
    out.put_some_f32(event.stick_s);
    out.put_f32(event.slip_s);
    out.put_f32(event.loading_rate_n_per_s);
    out.put_some_f32(event.omega_rad_per_s);
    out.put_word(event.slack);
    out.put_word(event.quality);
    out.put_some_word(event.reason);
    systematic(out, event.mu_s);
    systematic(out, event.mu);
}

fn time(out: &mut Writer<'_>, time: SampleTime) {
    out.put(time.index);
    out.put_f32(time.fraction);
}

fn coefficient(out: &mut Writer<'_>, value: Option<Coefficient>) {
    out.put_some_f32(value.map(|c| c.value));
    out.put_some_f32(value.map(|c| c.std));
}

/// Writes the systematic standard deviation, apart from its coefficient because a later version
/// added it.
fn systematic(out: &mut Writer<'_>, value: Option<Coefficient>) {
    out.put_some_f32(value.map(|c| c.systematic_std));
}

fn report(out: &mut Writer<'_>, report: &Report) {
    let counters = &report.counters;
    out.put(counters.samples);
    out.put(counters.missing);
    out.put(counters.duplicates);
    out.put(counters.rejected);
    out.put(counters.saturated);
    out.put(report.events);
    estimate(out, report.mu_s);
    estimate(out, report.mu);
    out.put_some_f32(report.noise_n);
    out.put_some_f32(report.loading_rate_n_per_s.map(|q| q.value));
    out.put_some_f32(report.omega_rad_per_s.map(|q| q.value));
    out.put_some_f32(report.stiffness_n_per_m);
    out.put_some_f32(report.recurrence_s);
    match &report.change {
        Some(it) => change(out, it),
        None => out.put(""),
    };
    out.put_some_f32(report.zero_n);
    for estimate in [report.mu_s, report.mu] {
        out.put_some_f32(estimate.map(|e| e.freedom));
        out.put_some_f32(estimate.map(|e| e.systematic_std));
        out.put_some_f32(estimate.map(|e| e.common_std));
    }
    out.put_some_f32(report.loading_rate_n_per_s.map(|q| q.std));
    out.put_some_f32(report.omega_rad_per_s.map(|q| q.std));
    out.put_f32(report.zero_std_n);
    out.put_f32(report.zero_drift_n);
    out.put_f32(report.weight_ratio);
    out.put_f32(report.weight_ratio_std);
    out.put_f32(report.damping_std);
    out.put(report.found.mask());
}

fn change(out: &mut Writer<'_>, change: &Change) {
    out.put(change.event);
    time(out, change.onset);
    out.put_word(change.cause);
    out.put_f32(change.weight_ratio);
    out.put_f32(change.weight_ratio_std);
}

/// Writes a stretch; the first field is the reason it was not understood, empty for a steady one.
fn stretch(out: &mut Writer<'_>, stretch: &Stretch) {
    let (reason, steady) = match stretch.kind {
        StretchKind::NotUnderstood(reason) => (Some(reason), None),
        StretchKind::Steady { force_over_weight, std, moving } => {
            (None, Some((force_over_weight, std, moving)))
        }
    };
    out.put_some_word(reason);
    time(out, stretch.start);
    time(out, stretch.stop);
    let Some((force_over_weight, std, moving)) = steady else { return };
    out.put_f32(force_over_weight);
    out.put_f32(std);
    out.put_some_word(moving);
}

fn estimate(out: &mut Writer<'_>, estimate: Option<Estimate>) {
    out.put_some_f32(estimate.map(|e| e.mean));
    out.put_some_f32(estimate.and_then(|e| e.std_error));
    out.put_some_f32(estimate.and_then(|e| e.spread));
    out.put_some(estimate.map(|e| e.events));
}

fn health(out: &mut Writer<'_>, health: &Health) {
    out.put(health.samples);
    out.put(health.overruns);
    out.put(health.deepest);
    out.put(health.adc_faults);
    out.put(health.saturated);
    out.put_some_f32(health.period_s);
    out.put_some_f32(health.jitter_s);
    out.put(health.sectors);
    out.put(health.store_failures);
}

fn mean(out: &mut Writer<'_>, mean: &Mean) {
    out.put_word(mean.input);
    out.put(mean.count);
    out.put(mean.failed);
    out.put_f32(mean.mean);
    out.put_f32(mean.deviation);
    out.put(mean.different);
}
