//! Error budget on the command line: options, metadata, JSON.

mod derived;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

const LOG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/logs/dff8-13.csv");
/// Options for exactly known inputs.
const EXACT: [&str; 10] = [
    "--weight-std-n",
    "0",
    "--slope-std-deg",
    "0",
    "--zero-std-n",
    "0",
    "--span-std",
    "0",
    "--damping-std",
    "0",
];

fn replay(options: &[&str]) -> Value {
    replay_of(LOG.as_ref(), options)
}

fn replay_of(log: &Path, options: &[&str]) -> Value {
    let program = Command::new(env!("CARGO_BIN_EXE_floe"))
        .arg("replay")
        .arg(log)
        .args(["--json", "-"])
        .args(options)
        .output()
        .unwrap();
    assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
    serde_json::from_slice(&program.stdout).unwrap()
}

/// A log of one of the scenes in `scenes/honesty`.
fn simulated(folder: &TempDir, name: &str, seed: &str) -> PathBuf {
    let scene = format!("{}/scenes/honesty/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    simulated_from(folder, scene.as_ref(), seed)
}

fn simulated_from(folder: &TempDir, scene: &Path, seed: &str) -> PathBuf {
    let log = folder.path().join("log.csv");
    let made = Command::new(env!("CARGO_BIN_EXE_floe"))
        .arg("simulate")
        .arg(scene)
        .args(["--seed", seed, "-o"])
        .arg(&log)
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    log
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn line<'a>(result: &'a Value, input: &str) -> &'a Value {
    let lines = result["budget"].as_array().unwrap();
    lines.iter().find(|line| line["input"] == input).unwrap()
}

#[test]
fn the_usual_uncertainties_are_in_every_interval() {
    let result = replay(&[]);
    assert_eq!(result["schema"], "floe-replay/2");
    for (name, lines) in [("mu_s", "mu_s"), ("mu", "mu")] {
        let mean = &result["estimate"][name];
        let (random, combined) = (number(&mean["std_error"]), number(&mean["combined_std"]));
        let systematic = number(&mean["systematic_std"]);
        assert!((combined - random.hypot(systematic)).abs() < 1e-6);
        let own = result["budget"].as_array().unwrap().iter();
        let own = own.map(|line| number(&line[lines]["contribution"]).powi(2)).sum::<f64>();
        assert!((own.sqrt() / systematic - 1.0).abs() < 1e-3, "{own} {systematic}");
        let ci95 = mean["ci95"].as_array().unwrap();
        let half = (number(&ci95[1]) - number(&ci95[0])) / 2.0;
        assert!((half / combined - 1.96).abs() < 0.02, "{half} {combined}");
        let event = &result["events"][5];
        let of = |part: &str| number(&event[format!("{name}_{part}")]);
        assert!((of("combined_std") - of("std").hypot(of("systematic_std"))).abs() < 1e-6);
    }
    assert!((number(&line(&result, "weight_n")["std"]) - 1.89).abs() < 1e-3);
    assert!((number(&line(&result, "damping")["std"]) - 0.005).abs() < 1e-6);
}

#[test]
fn a_loading_rate_is_as_unsure_as_the_span() {
    let of = |options: &[&str]| {
        let result = replay(options);
        ["loading_rate_n_per_s", "loading_rate_n_per_s_std"].map(|name| number(&result[name]))
    };
    let [rate, own] = of(&EXACT);
    let [_, all] = of(&["--span-std", "1"]);
    assert!((all / own.hypot(0.01 * rate) - 1.0).abs() < 1e-3, "{all} {own} {rate}");
}

#[test]
fn what_is_exactly_known_contributes_nothing() {
    let result = replay(&EXACT);
    for input in ["weight_n", "slope_rad", "zero_n", "span", "damping"] {
        assert!(number(&line(&result, input)["mu"]["contribution"]) < 1e-12, "{input}");
    }
    let usual = replay(&["--weight-from", "same_cell"]);
    assert!(number(&line(&usual, "span")["mu"]["contribution"]) < 1e-12, "it cancels");
}

#[test]
fn a_zero_before_and_after_is_taken_off_linearly() {
    let plain = replay(&EXACT);
    let zeroed = replay(&["--zero-before-n", "0", "--zero-after-n", "12.6"]);
    // On average half of 12.6 N, over 630 N.
    let mean = |result: &Value| number(&result["estimate"]["mu"]["mean"]);
    let moved = mean(&plain) - mean(&zeroed);
    assert!((moved - 0.01).abs() < 5e-4, "{moved}");
    assert!((number(&line(&zeroed, "zero_n")["std"]) - 12.6 / 12_f64.sqrt()).abs() < 1e-3);
}

/// Friction that drifts looks like a drift of the zero. With the zero measured before and after the
/// test no drift is estimated, and no interval includes one.
#[test]
fn a_zero_that_was_taken_twice_is_asked_of_no_event() {
    let folder = tempfile::tempdir().unwrap();
    let log = simulated(&folder, "wandering", "1");
    let read = |zeros: &[&str]| {
        let result = replay_of(&log, &[&EXACT, zeros].concat());
        let drift = result["effects"].as_array().unwrap().iter().find(|it| it["name"] == "drift");
        let enabled = drift.unwrap()["enabled"].as_bool().unwrap();
        let moved = line(&result, "zero_drift_n")["std"].as_f64().unwrap();
        let last = result["events"].as_array().unwrap().last().unwrap();
        (enabled, moved > 0.0, number(&last["mu_combined_std"]) < 1.01 * number(&last["mu_std"]))
    };
    assert_eq!(read(&[]), (true, true, false));
    assert_eq!(read(&["--zero-before-n", "0", "--zero-after-n", "0"]), (false, false, true));
    assert_eq!(read(&["--zero-before-n", "0"]), (true, true, false));
}

#[test]
fn a_winch_speed_that_nobody_said_is_not_known_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let known = std::fs::read_to_string(LOG).unwrap();
    let kept = |line: &&str| !line.starts_with("# winch_m_per_s");
    std::fs::write(&log, known.lines().filter(kept).collect::<Vec<_>>().join("\n")).unwrap();
    let result = replay_of(&log, &[]);
    let winch = line(&result, "winch_m_per_s");
    assert!(winch["value"].is_null() && winch["std"].is_null(), "{winch}");
}

#[test]
fn both_stiffnesses_and_the_recurrence_agree_with_the_scene() {
    let result = replay(&[]);
    let within = |name: &str, truth: f64| {
        let (value, std) = (number(&result[name]), number(&result[format!("{name}_std")]));
        assert!((value - truth).abs() < 4.0 * std && std < 0.03 * truth, "{name} {value} {std}");
    };
    within("stiffness_from_omega_n_per_m", 23_000.0);
    within("stiffness_from_rate_n_per_m", 23_000.0);
    within("stiffness_ratio", 1.0);
    let (seen, model) =
        (number(&result["recurrence_s"]), number(&result["recurrence_predicted_s"]));
    assert!((seen / model - 1.0).abs() < 0.01, "{seen} {model}");
    let [seen_std, model_std] =
        ["recurrence_s_std", "recurrence_predicted_s_std"].map(|name| number(&result[name]));
    assert!((seen - model).abs() < 3.0 * seen_std.hypot(model_std), "{seen_std} {model_std}");
    for (name, off) in [("slip_length_m", 0.03), ("energy_j", 0.03)] {
        let part = number(&result[format!("{name}_std")]) / number(&result[name]);
        let event = &result["events"][3];
        let of_event = number(&event[format!("{name}_std")]) / number(&event[name]);
        assert!((0.001..off).contains(&part) && (0.001..off).contains(&of_event), "{name} {part}");
    }
    let event = &result["events"][3];
    let length_m = number(&event["slip_length_m"]);
    assert!((number(&event["energy_j"]) / length_m - 491.4).abs() < 3.0 && length_m > 0.025);
}

#[test]
fn every_event_holds_the_losses_that_the_whole_test_tells() {
    let folder = tempfile::tempdir().unwrap();
    let log = simulated(&folder, "damping_5", "3");
    let result = replay_of(&log, &EXACT[..8]);
    let std = number(&line(&result, "damping")["std"]);
    assert!(std > 0.03, "{std}");
    let events = result["events"].as_array().unwrap();
    for event in [&events[0], &events[events.len() - 1]] {
        let of = |name: &str| number(&event[name]);
        let own = 0.5 * std::f64::consts::PI * (of("mu_s") - of("mu")) * std;
        assert!((of("mu_systematic_std") / own - 1.0).abs() < 1e-4, "{event}");
        let half = (number(&event["mu_ci95"][1]) - number(&event["mu_ci95"][0])) / 2.0;
        assert!((half / of("mu_combined_std") - 1.96).abs() < 0.01, "{event}");
    }
}

#[test]
fn a_standard_deviation_that_cannot_be_is_refused() {
    for (option, value, why) in [
        ("--weight-std-n", "-1", "a number from 0 up to 1e9, not -1"),
        ("--slope-std-deg", "-1", "a number from 0 up to 1e9, not -1"),
        ("--zero-std-n", "nan", "a number from 0 up to 1e9, not NaN"),
        ("--span-std", "-1", "a number from 0 up to 1e9, not -1"),
        ("--winch-std-m-per-s", "-1", "a number from 0 up to 1e9, not -1"),
        ("--damping-std", "5", "a number from 0 up to 0.3, not 5"),
    ] {
        let program = Command::new(env!("CARGO_BIN_EXE_floe"))
            .args(["replay", LOG, option, value])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&program.stderr);
        assert_eq!((program.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert_eq!(said, format!("floe: {LOG}: {option} must be {why}\n"));
    }
}

/// A drift that is seen late also widens the intervals of the earlier events.
#[test]
fn what_the_test_tells_of_the_zero_reaches_its_first_events() {
    let folder = TempDir::new().unwrap();
    let scene = format!("{}/scenes/honesty/drift_1.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(scene).unwrap();
    let text = text.replace("_fraction = 0.01", "_fraction = 0.03");
    let text = text.replace("zero_n_per_s = 0.125", "zero_n_per_s = 0.5");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("scene.toml"), text).unwrap();
    let made = Command::new(env!("CARGO_BIN_EXE_floe"))
        .args(["simulate", "scene.toml", "-o", "log.csv", "--truth", "truth.json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let truth: Value =
        serde_json::from_str(&std::fs::read_to_string(path("truth.json")).unwrap()).unwrap();
    let result = replay_of(&path("log.csv"), &[]);
    let (found, truths) =
        (result["events"].as_array().unwrap(), truth["events"].as_array().unwrap());
    assert!(result["zero_n"].as_f64().unwrap() > 20.0 && found.len() > 50, "{}", result["zero_n"]);
    let number = |event: &Value, key: &str| event[key].as_f64().unwrap();
    let mut judged = 0;
    for event in found.iter().filter(|event| !event["mu"].is_null()) {
        let is_same = |it: &&Value| (number(it, "onset_s") - number(event, "onset_s")).abs() < 0.3;
        let Some(truth) = truths.iter().find(is_same) else { continue };
        judged += 1;
        for key in ["mu_s", "mu"] {
            let off = number(event, key) - number(truth, key);
            let std = number(event, &format!("{key}_combined_std"));
            assert!(off.abs() < 4.0 * std, "{key}: {off} {std} in {event}");
        }
    }
    assert!(judged * 10 > truths.len() * 9, "{judged} of {}", truths.len());
}

/// The printed line that begins with a name, and the report.
fn printed(name: &str, options: &[&str]) -> (String, String) {
    let folder = TempDir::new().unwrap();
    let report = folder.path().join("report.html");
    let program = Command::new(env!("CARGO_BIN_EXE_floe"))
        .args(["replay", LOG, "--summary", "--report"])
        .arg(&report)
        .args(options)
        .output()
        .unwrap();
    assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
    let text = String::from_utf8(program.stdout).unwrap();
    let line = text.lines().find(|line| line.starts_with(name)).unwrap().to_string();
    (line, std::fs::read_to_string(&report).unwrap())
}

/// The coefficient has the digits of its uncertainty, and those of the report.
#[test]
fn the_printed_result_is_that_of_the_report() {
    for (options, mean) in [(&[][..], "1.2399"), (&["--weight-std-n", "30"], "1.240")] {
        let (line, page) = printed("mu_s ", options);
        let cells: Vec<&str> = line.split_whitespace().collect();
        assert_eq!((cells[1], cells[2]), (mean, "±"), "{line}");
        let headline = format!("{mean}<span class=\"error\"> ± {}</span>", cells[3]);
        assert!(page.contains(&headline), "{headline}");
    }
}

/// A drift of the zero that nobody measured is not printed as none; the JSON stays as it is.
#[test]
fn a_drift_that_was_not_measured_is_said_to_be() {
    let both = ["--zero-before-n", "0", "--zero-after-n", "0.5"];
    for (options, is_said) in [(&[][..], true), (&both[..2], true), (&both, false)] {
        let (row, page) = printed("zero_drift_n", options);
        assert_eq!(row.contains("not measured, and none is seen"), is_said, "{row}");
        assert_eq!(row.contains("0.0%"), !is_said, "{row}");
        assert_eq!(page.contains("not measured, and none is seen"), is_said);
        assert!(number(&line(&replay(options), "zero_drift_n")["std"]).abs() < 1e-12);
    }
}
