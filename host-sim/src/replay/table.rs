//! The result as text for a person.

use std::fmt::Write;

use super::result::{CoefficientSummary, EventSummary, LogSummary, ReplayResult};

/// Events, then the result with its uncertainty, then what to know about it.
#[must_use]
pub fn text(result: &ReplayResult) -> String {
    let mut out = String::new();
    let force = Force::for_weight(result.test.weight_n);
    // Writing to a String cannot fail.
    let _ = header(&mut out, result, force);
    let _ = match result.events.as_slice() {
        [] => writeln!(out, "No events: no slip was found in this log.\n"),
        events => event_lines(&mut out, events, force),
    };
    let _ = coefficients(&mut out, result);
    let _ = quantities(&mut out, result, force);
    let _ = samples(&mut out, &result.log);
    out
}

/// How forces are written: four digits at the block's weight.
#[derive(Clone, Copy, Debug)]
struct Force {
    decimals: usize,
}

impl Force {
    fn for_weight(weight_n: f64) -> Self {
        Self { decimals: (3.0 - weight_n.log10().floor()).clamp(0.0, 8.0) as usize }
    }

    fn cell(self, force_n: f64) -> String {
        format!("{force_n:.*}", self.decimals)
    }
}

fn cell(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_string(), |value| format!("{value:.decimals$}"))
}

fn header(out: &mut String, result: &ReplayResult, force: Force) -> std::fmt::Result {
    let (log, test) = (&result.log, &result.test);
    writeln!(
        out,
        "log    {} ({}), {} samples at {} Hz, {:.2} s",
        log.path,
        log.format,
        log.samples,
        significant(log.rate_hz),
        log.duration_s
    )?;
    let id = test.test_id.as_ref().map(|id| format!("{id}, ")).unwrap_or_default();
    let weight = force.cell(test.weight_n);
    writeln!(out, "test   {id}weight {weight} N, slope {:.2}°\n", test.slope_rad.to_degrees())
}

/// A number with up to seven digits and no idle zeros.
fn significant(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

fn event_lines(out: &mut String, events: &[EventSummary], force: Force) -> std::fmt::Result {
    let titles = [
        "event", "onset s", "stop s", "mu_s", "±", "mu", "±", "Fs N", "Fp N", "Fe N", "stick s",
        "slip s",
    ];
    line(out, &titles.map(str::to_string), "quality")?;
    for event in events {
        let reason = event.reason.as_ref().map(|r| format!(": {r}")).unwrap_or_default();
        let cells = [
            event.index.to_string(),
            cell(Some(event.onset_s), 3),
            cell(Some(event.stop_s), 3),
            cell(event.mu_s, 4),
            cell(event.mu_s_std, 4),
            cell(event.mu, 4),
            cell(event.mu_std, 4),
            force.cell(event.static_force_n),
            force.cell(event.dynamic_force_n),
            force.cell(event.restick_force_n),
            cell(event.stick_s, 3),
            cell(Some(event.slip_s), 3),
        ];
        line(out, &cells, &format!("{}{reason}", event.quality))?;
    }
    writeln!(out)
}

/// One line of the event table; `±` takes part of its width from `mu`.
fn line(out: &mut String, cells: &[String; 12], last: &str) -> std::fmt::Result {
    const WIDTHS: [usize; 12] = [6, 11, 11, 9, 8, 9, 8, 9, 9, 9, 9, 8];
    for (cell, width) in cells.iter().zip(WIDTHS) {
        write!(out, "{cell:>width$}")?;
    }
    writeln!(out, "  {last}")
}

fn coefficients(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    let estimate = &result.estimate;
    coefficient(out, "mu_s", &estimate.mu_s)?;
    coefficient(out, "mu", &estimate.mu)?;
    let found = result.events.len();
    writeln!(
        out,
        "       ± standard error of the mean; {} of {found} events count\n",
        estimate.events
    )
}

fn coefficient(out: &mut String, name: &str, value: &CoefficientSummary) -> std::fmt::Result {
    let Some(mean) = value.mean else { return writeln!(out, "{name:<6} unknown") };
    let error = cell(value.std_error, 4);
    let spread = cell(value.spread, 4);
    writeln!(out, "{name:<6} {mean:.4} ± {error}   spread between events {spread}")
}

fn quantities(out: &mut String, result: &ReplayResult, force: Force) -> std::fmt::Result {
    let fine = Force { decimals: force.decimals + 1 };
    let kilo = result.stiffness_n_per_m.map(|k| k / 1e3);
    let lines = [
        ("noise", result.noise_n.map(|n| format!("{} N", fine.cell(n)))),
        ("loading rate", result.loading_rate_n_per_s.map(|r| format!("{} N/s", force.cell(r)))),
        ("omega", result.omega_rad_per_s.map(|o| format!("{o:.2} rad/s"))),
        ("stiffness", kilo.map(|k| format!("{k:.4} kN/m"))),
        ("recurrence", result.recurrence_s.map(|t| format!("{t:.3} s"))),
    ];
    for (name, value) in lines {
        writeln!(out, "{name:<14}{}", value.as_deref().unwrap_or("unknown"))?;
    }
    writeln!(out)
}

fn samples(out: &mut String, log: &LogSummary) -> std::fmt::Result {
    writeln!(
        out,
        "samples       {} read, {} missing, {} duplicates, {} rejected, {} saturated",
        log.samples, log.missing, log.duplicates, log.rejected, log.saturated
    )?;
    log.warnings.iter().try_for_each(|warning| writeln!(out, "note          {warning}"))
}
