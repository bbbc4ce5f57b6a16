//! The result in numbers.

use super::budget::budget;
use super::number::{count, decimals_of_error, fixed, quantity, significant};
use super::svg::escape;
use crate::replay::abridged::abridged;
use crate::replay::check::Check;
use crate::replay::result::{CoefficientSummary, ReplayResult, zero_sentence};
use crate::replay::stretches::{NotUnderstood, SteadySummary};
use crate::rounding::{LEAST, own_digits, part_of, plus_minus_known};

/// Both coefficients in large type, then all other numbers.
pub(super) fn summary(result: &ReplayResult) -> String {
    let estimate = &result.estimate;
    format!(
        "<section class=\"result\">{}<div class=\"coefficients\">{}{}</div>{}{}</section>\n",
        notices(result),
        coefficient("static", "<i>μ</i><sub>s</sub>", &estimate.mu_s, "Static coefficient"),
        coefficient("dynamic", "<i>μ</i>", &estimate.mu, "Dynamic coefficient"),
        facts("Measured", &measured(result)) + &budget(result),
        definitions() + &log_health(result),
    )
}

/// Definitions of the coefficients, and the rule for events that count.
fn definitions() -> String {
    "<p class=\"small definitions\"><i>μ</i><sub>s</sub>: force at which the slip begins over the normal force \
     (the peak of the force where the onset is smooth). <i>μ</i>: friction averaged over the \
     distance slid. ±: one standard deviation of all that is known, random and systematic. Every \
     event with a value counts; an <i>unresolved</i> one, whose slip is too short for the \
     sampling, with its wider ±, a third of which is taken to be the same in all such events.</p>"
        .into()
}

/// Notices: no result, a change of the block or of its friction, a drift of the zero.
fn notices(result: &ReplayResult) -> String {
    let notice = |kind: &str, safe: &str| format!("<p class=\"notice\">{kind}: {safe}.</p>");
    let refused = result.events.counts.refused().map(|it| notice("Events", &escape(&it)));
    let steady = abridged(&result.stretches.steady, SteadySummary::sentence);
    let steady = steady.map(|it| notice("Steady", &escape(&it.replace("F/W -", "F/W −"))));
    let unclear = abridged(&result.stretches.not_understood, NotUnderstood::sentence);
    let unclear = unclear.map(|it| notice("Not understood", &escape(&it)));
    let change = abridged(&result.changes, |it| it.sentence(result.test.weight_n));
    let change = change.map(|it| notice("Change", &escape(&it)));
    let zero = result.zero_n.map(zero_sentence);
    let zero = zero.map(|it| notice("Zero", &with_whole_options(&it)));
    let all = refused.chain(steady).chain(unclear).chain(change).chain(zero);
    nothing(result).to_string() + &all.collect::<String>()
}

/// Marks the names of options so that no line breaks within them.
fn with_whole_options(text: &str) -> String {
    let whole = |word: &str| match word.starts_with("--") {
        true => format!("<span class=\"option\">{word}</span>"),
        false => word.to_string(),
    };
    text.split_inclusive([' ', '(']).map(whole).collect()
}

/// The sentence for a test without a result.
fn nothing(result: &ReplayResult) -> &'static str {
    match (result.events.is_empty(), result.estimate.events) {
        (true, _) => {
            "<p class=\"notice\">No stick-slip event was found in this log, so there is no \
             coefficient.</p>"
        }
        (false, 0) => "<p class=\"notice\">No event gives a coefficient.</p>",
        (false, _) => "",
    }
}

fn coefficient(class: &str, symbol: &str, value: &CoefficientSummary, name: &str) -> String {
    let decimals = decimals_of_error(value.combined_std);
    let show = |x: f64| fixed(x, decimals);
    let large = match (value.mean, value.combined_std) {
        (Some(mean), Some(error)) => {
            format!("{}<span class=\"error\"> ± {}</span>", show(mean), show(error))
        }
        (Some(mean), None) => show(mean),
        (None, _) => "–".into(),
    };
    let parts = match (value.std_error, value.systematic_std) {
        (Some(random), Some(systematic)) => {
            let whole = value.combined_std.unwrap_or(random);
            let [random, systematic] = [random, systematic].map(|it| escape(&part_of(it, whole)));
            format!("random {random}, systematic {systematic} · ")
        }
        _ if value.mean.is_none() => String::new(),
        (_, systematic) => {
            let why = value.reason.map(|reason| format!("no ±: {reason} · "));
            let systematic = systematic.map(|it| format!("systematic {} · ", own_digits(it)));
            why.unwrap_or_default() + &systematic.unwrap_or_default()
        }
    };
    let spread = match (value.mean, value.spread) {
        (None, _) => format!("not measured: {}", value.reason.unwrap_or("no event gives a value")),
        (_, Some(spread)) if spread < LEAST => "no spread between events beyond the noise".into(),
        (_, Some(spread)) => format!("spread between events {}", own_digits(spread)),
        (_, None) => "spread between events unknown".into(),
    };
    let interval = value.ci95.map_or_else(String::new, |[low, high]| {
        format!("<p class=\"small\">95 % {} to {}</p>", show(low), show(high))
    });
    format!(
        "<div class=\"coefficient {class}\"><h2>{name}</h2><p class=\"large\">{symbol}\
         <span class=\"{}\">{large}</span></p>{interval}<p class=\"small\">{parts}{spread}</p></div>",
        if value.mean.is_some() { "value" } else { "none" },
    )
}

/// Name, value, and whether it deserves attention.
type Fact = (&'static str, String, bool);

fn measured(result: &ReplayResult) -> Vec<Fact> {
    let (used, found) = (result.estimate.events, result.events.found() as u64);
    let without = found.saturating_sub(used);
    let events = match without {
        0 => count(used),
        n => format!("{} <small>and {} without a value</small>", count(used), count(n)),
    };
    let noise = result.noise_n.map_or_else(|| "–".into(), |noise_n| quantity(noise_n, "N"));
    let counts = [("Events", events, without > 0), ("Noise on the force", noise, false)];
    let derived = if found > 0 { derived(result) } else { Vec::new() };
    counts.into_iter().chain(derived).collect()
}

/// Quantities of cable, winch and slips.
fn derived(result: &ReplayResult) -> Vec<Fact> {
    let q = &result.quantities;
    let disagree = q.check().is_some_and(Check::is_asked) && !result.sags();
    let hertz = q.omega_rad_per_s.map_or_else(String::new, |omega| {
        format!(" <small>{} Hz</small>", significant(omega / std::f64::consts::TAU))
    });
    let (from_rate, from_omega) = (
        with_std(q.stiffness_from_rate_n_per_m, q.stiffness_from_rate_n_per_m_std, "N/m"),
        with_std(q.stiffness_from_omega_n_per_m, q.stiffness_from_omega_n_per_m_std, "N/m"),
    );
    let loading = with_std(q.loading_rate_n_per_s, q.loading_rate_n_per_s_std, "N/s");
    let omega = with_std(q.omega_rad_per_s, q.omega_rad_per_s_std, "rad/s") + &hertz;
    let predicted = with_std(q.recurrence_predicted_s, q.recurrence_predicted_s_std, "s");
    vec![
        ("Loading rate <i>k w</i>", loading, false),
        ("Natural frequency <i>ω</i>", omega, false),
        ("Stiffness from <i>k w</i>", from_rate, false),
        ("Stiffness from <i>ω</i>", from_omega, false),
        ("Ratio of the two", with_std(q.stiffness_ratio, q.stiffness_ratio_std, ""), disagree),
        ("Recurrence", with_std(q.recurrence_s, q.recurrence_s_std, "s"), false),
        ("Recurrence by the model", predicted, false),
        ("Slip length, mean", with_std(q.slip_length_m, q.slip_length_m_std, "m"), false),
        ("Energy of a slip, mean", with_std(q.energy_j, q.energy_j_std, "J"), false),
    ]
}

fn with_std(value: Option<f64>, std: Option<f64>, unit: &str) -> String {
    let Some(value) = value else { return "–".into() };
    let text = plus_minus_known(value, std).replace('-', "−");
    // No line begins with the unit.
    format!("{text}\u{a0}{unit}").trim_end().to_string()
}

fn log_health(result: &ReplayResult) -> String {
    let log = &result.log;
    let counted = |n: u64| (count(n), n > 0);
    let fact = |name, (value, attention): (String, bool)| (name, value, attention);
    let hours = match log.duration_s / 3600.0 {
        hours if hours < 1.0 => String::new(),
        hours => format!(" <small>{} h</small>", significant(hours)),
    };
    let length = format!("{} s{hours}", fixed(log.duration_s, usize::from(log.duration_s < 1e4)));
    let list = [
        ("Length", length, false),
        ("Sample rate", format!("{} Hz", (log.rate_hz * 1e4).round() / 1e4), false),
        ("Samples", count(log.samples), false),
        fact("Missing", counted(log.missing)),
        fact("Duplicates", counted(log.duplicates)),
        fact("Rejected", counted(log.rejected)),
        fact("Saturated", counted(log.saturated)),
    ];
    let warning = |text: &String| format!("<li>{}</li>", escape(text));
    let warnings: String = log.warnings.iter().map(warning).collect();
    let warnings = match log.warnings.is_empty() {
        true => String::new(),
        false => format!("<ul class=\"notice\">{warnings}</ul>"),
    };
    facts("Log", &list) + &warnings
}

fn facts(name: &str, facts: &[Fact]) -> String {
    let item = |(name, value, attention): &Fact| {
        let (class, sign) = if *attention { (" class=\"attention\"", "⚠ ") } else { ("", "") };
        format!("<div{class}><dt>{name}</dt><dd>{sign}{value}</dd></div>")
    };
    let items: String = facts.iter().map(item).collect();
    format!("<h2>{name}</h2><dl class=\"facts\">{items}</dl>")
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn what_one_event_tells_of_its_deviation_is_said() {
        let one = CoefficientSummary {
            mean: Some(1.2722),
            systematic_std: Some(0.0057),
            reason: Some("one event does not tell"),
            ..CoefficientSummary::default()
        };
        let said = coefficient("static", "m", &one, "Static coefficient");
        assert!(said.contains("no ±: one event does not tell · systematic 0.0057 · "), "{said}");
    }

    /// A log with a steady stretch every minute for hours.
    #[test]
    fn the_coefficients_stand_near_the_top_whatever_the_log() {
        let held = SteadySummary {
            start_s: 60.0,
            stop_s: 80.0,
            force_over_weight: 0.78,
            std: 0.001,
            moving: None,
            sliding: (0.78, 0.001),
        };
        let mut result = SampleLog::dff8_13(20.0).result;
        result.stretches.steady = vec![held; 391];
        let said = notices(&result);
        assert!(said.matches("class=\"notice\"").count() < 20, "{said}");
        assert!(said.contains("Steady: and 381 more; floe replay --json"), "{said}");
    }

    #[test]
    fn the_name_of_an_option_stays_on_one_line() {
        let said = with_whole_options("take it (--zero-before-n, --zero-after-n)");
        let [before, after] = ["--zero-before-n, ", "--zero-after-n)"]
            .map(|name| format!("<span class=\"option\">{name}</span>"));
        assert_eq!(said, format!("take it ({before}{after}"));
    }
}
