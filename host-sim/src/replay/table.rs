//! The result as text for a person.

use std::fmt::Write;
use std::io;

use super::abridged::abridged;
use super::budget::BudgetLine;
use super::check::Check;
use super::doubts::why_no_event;
use super::result::{
    CoefficientSummary, EffectSummary, EventSummary, ParameterSummary, ReplayResult, zero_sentence,
};
use super::stretches::{NotUnderstood, SteadySummary, Stretches};
use crate::error::printable_line;
use crate::rounding::{
    self, LEAST, counted, decimals, digits, own_digits, part_of, plus_minus_known, significant,
};

/// The result as text: events, coefficients with their uncertainty, then remarks.
///
/// # Errors
/// The events cannot be read.
pub fn text(result: &ReplayResult) -> io::Result<String> {
    let mut out = Vec::new();
    write(&mut out, result, true)?;
    Ok(String::from_utf8_lossy(&out).into_owned())
}

/// Writes the text of a result, with or without its events.
///
/// # Errors
/// `out` cannot be written, or the events cannot be read.
pub fn write(out: &mut dyn io::Write, result: &ReplayResult, each_event: bool) -> io::Result<()> {
    let force = decimals(result.test.weight_n);
    let mut head = String::new();
    // Writing to a String cannot fail.
    let _ = header(&mut head, result, force);
    let listed = each_event && !result.events.is_empty();
    let _ = match (result.events.is_empty(), listed) {
        (true, _) => writeln!(head, "No events: {}.\n", why_no_event(result)),
        (false, true) => titles(&mut head),
        (false, false) => Ok(()),
    };
    out.write_all(head.as_bytes())?;
    if listed {
        result.events.for_each(|event| {
            let mut line = String::new();
            let _ = event_line(&mut line, &event, force);
            out.write_all(line.as_bytes())
        })?;
        out.write_all(b"\n")?;
    }
    let mut rest = String::new();
    for part in [notices, coefficients, budget, quantities, samples] {
        let _ = part(&mut rest, result);
    }
    out.write_all(rest.as_bytes())
}

fn cell(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_string(), |value| format!("{value:.decimals$}"))
}

/// An uncertainty with two significant digits.
fn part(std: Option<f64>) -> String {
    std.map_or_else(|| "-".to_string(), own_digits)
}

/// A part of an uncertainty, printed with as many decimals as the whole, if there is one.
fn part_beside(own: Option<f64>, whole: Option<f64>) -> String {
    own.zip(whole).map_or_else(|| part(own), |(own, whole)| part_of(own, whole))
}

fn narrow(std: Option<f64>) -> String {
    std.map_or_else(|| "-".to_string(), rounding::narrow)
}

fn header(out: &mut String, result: &ReplayResult, force: usize) -> std::fmt::Result {
    let (log, test) = (&result.log, &result.test);
    writeln!(
        out,
        "log    {} ({}), {} at {} Hz, {:.2} s",
        printable_line(&log.path),
        log.format,
        counted(log.samples, "sample"),
        significant(log.rate_hz),
        log.duration_s
    )?;
    if let Some(synthetic) = &log.synthetic {
        writeln!(out, "       SIMULATED: {synthetic}")?;
    }
    let id = test.test_id.as_ref().map(|id| format!("{id}, ")).unwrap_or_default();
    let weight = cell(Some(test.weight_n), force);
    match test.mass_kg {
        Some(mass_kg) => {
            let mass = cell(Some(mass_kg), decimals(mass_kg));
            writeln!(out, "test   {id}under the ice: normal force {weight} N, mass {mass} kg\n")
        }
        None => {
            let slope_deg = test.slope_rad.to_degrees();
            writeln!(out, "test   {id}weight {weight} N, slope {slope_deg:.2}°\n")
        }
    }
}

fn titles(out: &mut String) -> std::fmt::Result {
    let titles = [
        "event", "onset s", "stop s", "mu_s", "±", "random", "mu", "±", "random", "Fs N", "Fp N",
        "Fe N", "stick s", "slip s",
    ];
    line(out, &titles.map(str::to_string), "quality")
}

fn event_line(out: &mut String, event: &EventSummary, force: usize) -> std::fmt::Result {
    let reason = event.reason.as_ref().map(|r| format!(": {r}")).unwrap_or_default();
    let cells = [
        event.index.to_string(),
        cell(Some(event.onset_s), 3),
        cell(Some(event.stop_s), 3),
        cell(event.mu_s, 4),
        narrow(event.mu_s_combined_std),
        narrow(event.mu_s_std),
        cell(event.mu, 4),
        narrow(event.mu_combined_std),
        narrow(event.mu_std),
        cell(Some(event.static_force_n), force),
        cell(Some(event.dynamic_force_n), force),
        cell(Some(event.restick_force_n), force),
        cell(event.stick_s, 3),
        cell(Some(event.slip_s), 3),
    ];
    line(out, &cells, &format!("{}{reason}", event.quality))
}

fn line(out: &mut String, cells: &[String; 14], last: &str) -> std::fmt::Result {
    const WIDTHS: [usize; 14] = [6, 11, 11, 9, 8, 8, 9, 8, 8, 9, 9, 9, 9, 8];
    for (cell, width) in cells.iter().zip(WIDTHS) {
        write!(out, "{cell:>width$}")?;
    }
    writeln!(out, "  {last}")
}

fn notices(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    let before = out.len();
    for it in abridged(&result.changes, |it| it.sentence(result.test.weight_n)) {
        writeln!(out, "change {it}")?;
    }
    if let Some(zero_n) = result.zero_n {
        writeln!(out, "zero   {}", zero_sentence(zero_n))?;
    }
    let found: Vec<String> = result.effects_found().map(effect).collect();
    if !found.is_empty() {
        writeln!(out, "shows  {}", found.join("; "))?;
    }
    let Stretches { steady, not_understood } = &result.stretches;
    for it in abridged(steady, SteadySummary::sentence) {
        writeln!(out, "steady {it}")?;
    }
    for it in abridged(not_understood, NotUnderstood::sentence) {
        writeln!(out, "not understood {it}")?;
    }
    if out.len() == before { Ok(()) } else { writeln!(out) }
}

fn coefficients(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    let estimate = &result.estimate;
    coefficient(out, "mu_s", &estimate.mu_s)?;
    coefficient(out, "mu", &estimate.mu)?;
    let found = result.events.found();
    if found > 0 {
        writeln!(
            out,
            "       ± one standard deviation, all that is known of it; {} of {found} events count",
            estimate.events
        )?;
    }
    result.events.counts.refused().try_for_each(|it| writeln!(out, "       {it}"))?;
    writeln!(out)
}

fn coefficient(out: &mut String, name: &str, value: &CoefficientSummary) -> std::fmt::Result {
    let Some(mean) = value.mean else { return writeln!(out, "{name:<6} unknown") };
    let systematic = part_beside(value.systematic_std, value.combined_std);
    let spread = match value.spread {
        Some(spread) if spread < LEAST => "none beyond the noise".to_string(),
        spread => part(spread),
    };
    let decimals = value.combined_std.map_or(4, digits);
    match (value.combined_std, value.std_error, value.ci95) {
        (Some(combined), Some(random), Some([low, high])) => writeln!(
            out,
            "{name:<6} {mean:.decimals$} ± {combined:.decimals$}   random {}, systematic {systematic}; \
             95 % {low:.decimals$} to {high:.decimals$}; spread between events {spread}",
            part_of(random, combined)
        ),
        _ => writeln!(
            out,
            "{name:<6} {mean:.4} ± ?   systematic {systematic}; {}",
            value.reason.unwrap_or_default()
        ),
    }
}

/// Name, value, standard deviation, and unit with a remark.
type Quantity = (&'static str, Option<f64>, Option<f64>, &'static str);

fn measured(result: &ReplayResult) -> [Quantity; 9] {
    let q = &result.quantities;
    let checks = match q.check() {
        _ if result.sags() => "of the two: a cable that sags is softer in the slip",
        check => check.map_or("", Check::remark),
    };
    [
        ("loading rate", q.loading_rate_n_per_s, q.loading_rate_n_per_s_std, "N/s"),
        ("omega", q.omega_rad_per_s, q.omega_rad_per_s_std, "rad/s"),
        (
            "stiffness",
            q.stiffness_from_rate_n_per_m,
            q.stiffness_from_rate_n_per_m_std,
            "N/m from the winch speed",
        ),
        (
            "stiffness",
            q.stiffness_from_omega_n_per_m,
            q.stiffness_from_omega_n_per_m_std,
            "N/m from omega and the weight",
        ),
        ("ratio", q.stiffness_ratio, q.stiffness_ratio_std, checks),
        ("recurrence", q.recurrence_s, q.recurrence_s_std, "s"),
        ("by the model", q.recurrence_predicted_s, q.recurrence_predicted_s_std, "s, (22) to (25)"),
        ("slip length", q.slip_length_m, q.slip_length_m_std, "m, mean of the events"),
        ("energy", q.energy_j, q.energy_j_std, "J against friction, mean of the events"),
    ]
}

fn quantities(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    match result.noise_n {
        Some(noise_n) => writeln!(out, "noise         {noise_n:.*} N", decimals(noise_n))?,
        None => writeln!(out, "noise         unknown")?,
    }
    for (name, value, std, unit) in measured(result) {
        let Some(value) = value else {
            writeln!(out, "{name:<14}unknown{}", unit.find(" from").map_or("", |at| &unit[at..]))?;
            continue;
        };
        writeln!(out, "{name:<14}{} {unit}", plus_minus_known(value, std))?;
    }
    writeln!(out)
}

/// The table of systematic uncertainties, input by input.
fn budget(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    if result.budget.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "{:<14}{:>10}{:>10}   {:>11}{:>11}{:>7}   {:>11}{:>11}{:>7}",
        "budget", "value", "std", "mu_s by 1", "mu_s ±", "share", "mu by 1", "mu ±", "share"
    )?;
    let estimate = &result.estimate;
    for line in result.budget.iter().map(BudgetLine::printed) {
        write!(out, "{:<14}{:>10}{:>10}", line.input, number(line.value), small(line.std))?;
        for (share, mean) in [(&line.mu_s, &estimate.mu_s), (&line.mu, &estimate.mu)] {
            let (by, percent) = (number(share.sensitivity), percent(share.contribution, mean));
            let own = part_beside(share.contribution, mean.combined_std);
            write!(out, "   {by:>11}{own:>11}{percent:>7}")?;
        }
        let remark = line.remark().map(|it| format!("   {it}"));
        writeln!(out, "{}", remark.unwrap_or_default())?;
    }
    write!(out, "{:<34}", "random")?;
    for mean in [&estimate.mu_s, &estimate.mu] {
        let percent = percent(mean.std_error, mean);
        let own = part_beside(mean.std_error, mean.combined_std);
        write!(out, "   {:>11}{own:>11}{percent:>7}", "")?;
    }
    writeln!(out, "\n")
}

/// Share of a mean's variance that is due to one contribution.
fn percent(part: Option<f64>, mean: &CoefficientSummary) -> String {
    let parts = part.zip(mean.combined_std);
    parts.map_or_else(|| "-".to_string(), |(a, b)| format!("{:.1}%", 100.0 * (a / b).powi(2)))
}

/// An uncertainty with two digits, in at most eight characters.
fn small(std: Option<f64>) -> String {
    match std {
        Some(std) if std > 0.0 && !(1e-4..1e7).contains(&std) => format!("{std:.1e}"),
        std => part(std),
    }
}

/// A number in at most nine characters.
fn number(value: Option<f64>) -> String {
    value.map_or_else(
        || "-".to_string(),
        |value| match value.abs() {
            0.0 => "0".to_string(),
            size if (1e-3..1e5).contains(&size) => format!("{value:.*}", decimals(value).min(5)),
            _ => format!("{value:.2e}"),
        },
    )
}

fn samples(out: &mut String, result: &ReplayResult) -> std::fmt::Result {
    let log = &result.log;
    writeln!(
        out,
        "samples       {} read, {} missing, {}, {} rejected, {} saturated",
        log.samples,
        log.missing,
        counted(log.duplicates, "duplicate"),
        log.rejected,
        log.saturated
    )?;
    log.warnings.iter().try_for_each(|warning| writeln!(out, "note          {warning}"))
}

/// An effect with its numbers: `corner missing_n 20.70 ± 0.58`.
pub(crate) fn effect(effect: &EffectSummary) -> String {
    let number = |it: &ParameterSummary| match digits(it.std) {
        decimals @ 0..=5 => format!(" {} {:.decimals$} ± {:.decimals$}", it.name, it.value, it.std),
        _ => format!(" {} {:.3e} ± {:.1e}", it.name, it.value, it.std),
    };
    effect.name.to_string() + &effect.parameters.iter().map(number).collect::<String>()
}

#[cfg(test)]
pub(super) mod tests;
