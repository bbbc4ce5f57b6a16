use super::*;
use crate::replay::budget::{BudgetLine, BudgetShare};
use crate::replay::events::Events;
use crate::replay::quantities::Quantities;
use crate::replay::result::{ChangeSummary, EstimateSummary, LogSummary, SCHEMA, TestSummary};

fn mean(mean: f64) -> CoefficientSummary {
    CoefficientSummary {
        mean: Some(mean),
        std_error: Some(0.0003),
        spread: Some(0.0008),
        systematic_std: Some(0.0004),
        combined_std: Some(0.0005),
        ci95: Some([mean - 0.001, mean + 0.001]),
        reason: None,
    }
}

fn weight() -> BudgetLine {
    let share =
        |by: f64| BudgetShare { sensitivity: Some(by), contribution: Some((0.2 * by).abs()) };
    BudgetLine {
        input: "weight_n",
        value: Some(630.0),
        std: Some(0.2),
        stated_std: None,
        is_unmeasured: false,
        mu_s: share(-0.001_968),
        mu: share(-0.001_238),
    }
}

fn quantities() -> Quantities {
    Quantities {
        loading_rate_n_per_s: Some(361.1234),
        loading_rate_n_per_s_std: Some(0.2),
        omega_rad_per_s: Some(18.91),
        omega_rad_per_s_std: Some(0.02),
        stiffness_from_omega_n_per_m: Some(23_012.3),
        stiffness_from_omega_n_per_m_std: Some(73.0),
        recurrence_predicted_s: Some(1.783),
        recurrence_predicted_s_std: Some(0.014),
        slip_length_m: Some(0.0295),
        slip_length_m_std: Some(0.0003),
        energy_j: Some(14.63),
        ..Quantities::default()
    }
}

fn result(listed: Vec<EventSummary>) -> ReplayResult {
    let mut events = Events::default();
    listed.into_iter().for_each(|it| events.push(it, Default::default).unwrap());
    events.finish(Quantities::default(), Default::default());
    ReplayResult {
        schema: SCHEMA,
        log: LogSummary {
            path: "x.csv".to_string(),
            format: "csv".to_string(),
            rate_hz: 16.0,
            samples: 1920,
            duration_s: 119.9375,
            missing: 3,
            warnings: vec!["line 9 is odd".to_string()],
            ..LogSummary::default()
        },
        test: TestSummary { test_id: None, weight_n: 630.0, slope_rad: 0.0, mass_kg: None },
        estimate: EstimateSummary { mu_s: mean(1.2401), mu: mean(0.78), events: 1 },
        noise_n: Some(1.98765),
        quantities: quantities(),
        budget: vec![weight()],
        zero_n: None,
        changes: Vec::new(),
        stretches: Stretches::default(),
        effects: Vec::new(),
        events,
    }
}

pub(in crate::replay) fn event() -> EventSummary {
    EventSummary {
        onset_s: 2.16345,
        stop_s: 2.3364,
        static_force_n: 781.23,
        dynamic_force_n: 491.4,
        peak_force_n: 781.8,
        restick_force_n: 201.6,
        mu: Some(0.78),
        mu_std: Some(0.0005),
        slip_s: 0.173,
        loading_rate_n_per_s: 361.1,
        omega_rad_per_s: Some(18.9),
        quality: "clipped".to_string(),
        reason: Some("a gap".to_string()),
        mu_systematic_std: Some(0.0012),
        mu_combined_std: Some(0.0013),
        mu_ci95: Some([0.7774, 0.7826]),
        ..EventSummary::default()
    }
}

#[test]
fn the_whole_text() {
    let expected = "\
log    x.csv (csv), 1920 samples at 16 Hz, 119.94 s
test   weight 630.0 N, slope 0.00°

 event    onset s     stop s     mu_s       ±  random       mu       ±  random     Fs N     Fp N     \
Fe N  stick s  slip s  quality
     0      2.163      2.336        -       -       -   0.7800  0.0013  0.0005    781.2    491.4    \
201.6        -   0.173  clipped: a gap

mu_s   1.24010 ± 0.00050   random 0.00030, systematic 0.00040; 95 % 1.23910 to 1.24110; spread \
between events 0.00080
mu     0.78000 ± 0.00050   random 0.00030, systematic 0.00040; 95 % 0.77900 to 0.78100; spread \
between events 0.00080
       ± one standard deviation, all that is known of it; 1 of 1 events count

budget             value       std     mu_s by 1     mu_s ±  share       mu by 1       mu ±  share
weight_n           630.0      0.20      -0.00197    0.00039  62.0%      -0.00124    0.00025  24.5%
random                                              0.00030  36.0%                  0.00030  36.0%

noise         1.988 N
loading rate  361.12 ± 0.20 N/s
omega         18.910 ± 0.020 rad/s
stiffness     unknown from the winch speed
stiffness     23012 ± 73 N/m from omega and the weight
ratio         unknown
recurrence    unknown
by the model  1.783 ± 0.014 s, (22) to (25)
slip length   0.02950 ± 0.00030 m, mean of the events
energy        14.63 ± ? J against friction, mean of the events

samples       1920 read, 3 missing, 0 duplicates, 0 rejected, 0 saturated
note          line 9 is odd
";
    assert_eq!(text(&result(vec![event()])).unwrap(), expected);
}

#[test]
fn the_columns_of_a_budget_stay_apart() {
    let mut result = result(vec![event()]);
    result.budget[0].value = Some(4.2e-5);
    result.budget[0].std = Some(4.2e-7);
    let line =
        |text: &str| text.lines().find(|line| line.starts_with("weight_n")).unwrap().to_string();
    let said = line(&text(&result).unwrap());
    assert!(said.starts_with("weight_n         4.20e-5    4.2e-7      -0.00197"), "{said}");
    result.budget[0].std = Some(1.3e-9);
    result.estimate.mu.combined_std = None;
    let said = line(&text(&result).unwrap());
    assert!(said.contains("    1.3e-9 ") && said.ends_with("      -"), "{said}");
}

#[test]
fn a_deviation_that_was_widened_is_said_at_its_row() {
    let mut result = result(vec![event()]);
    result.budget[0].stated_std = Some(0.1);
    let said = text(&result).unwrap();
    let row = said.lines().find(|line| line.starts_with("weight_n")).unwrap();
    assert!(row.ends_with("%   stated 0.10, widened by what the slips show"), "{row}");
}

#[test]
fn what_was_not_measured_has_no_numbers() {
    let mut result = result(vec![event()]);
    result.budget[0].is_unmeasured = true;
    let said = text(&result).unwrap();
    let row = said.lines().find(|line| line.starts_with("weight_n")).unwrap();
    assert_eq!(
        row,
        "weight_n           630.0         -      -0.00197          -      -      -0.00124          -      \
         -   not measured, and none is seen: take the zero before and after"
    );
}

#[test]
fn without_events_nothing_is_said_of_their_deviation() {
    let said = text(&result(Vec::new())).unwrap();
    assert!(!said.contains("events count") && !said.contains("one standard deviation"), "{said}");
}

#[test]
fn a_change_is_said() {
    let mut result = result(vec![event()]);
    result.changes.push(ChangeSummary {
        event: 33,
        onset_s: 60.271,
        cause: "mass",
        weight_ratio: 0.671,
        weight_ratio_std: 0.006,
    });
    let line = "\nchange at 60.27 s (event 33) the block's weight changed to 0.671 ± 0.006 of \
                the given one, 422.7 N; the coefficients from there on use it\n\nmu_s ";
    let text = text(&result).unwrap();
    assert!(text.contains(line), "{text}");
}

/// A log with a steady stretch every minute for hours.
#[test]
fn the_coefficients_stand_near_the_top_whatever_the_log() {
    let mut result = result(vec![event()]);
    let reason = "the force falls evenly: the winch turned back".to_string();
    result.stretches.not_understood =
        vec![NotUnderstood { start_s: 60.0, stop_s: 63.0, reason }; 400];
    let text = text(&result).unwrap();
    assert!(text.lines().count() < 50, "{text}");
    assert!(text.contains("\nnot understood and 390 more; floe replay --json"), "{text}");
}

#[test]
fn a_zero_that_may_have_moved_is_said() {
    let mut result = result(vec![event()]);
    result.zero_n = Some(14.2);
    let line = "\nzero   the zero of the load cell may have moved by 14 N, which is in the \
                budget; take it before and after a test (--zero-before-n, --zero-after-n)\n\n\
                mu_s ";
    let text = text(&result).unwrap();
    assert!(text.contains(line), "{text}");
}

#[test]
fn no_events_is_said() {
    let result = ReplayResult { noise_n: Some(2.0), ..result(Vec::new()) };
    let line = "\nNo events: no slip was found in this log; one that falls by less than 16 N, 8 times the \
                noise, hides in it.\n";
    let text = text(&result).unwrap();
    assert!(text.contains(line), "{text}");
}
