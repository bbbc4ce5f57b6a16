//! `floe stiffness` as a command.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

#[path = "support/command.rs"]
mod command;
use command::{assert_refused, directory, text};

fn floe(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    command.current_dir(directory).arg("stiffness").args(arguments).output().unwrap()
}

/// A pull against a post at this loading rate.
fn pull(rate_n_per_s: f64) -> String {
    let row = |i: i32| {
        let time_s = f64::from(i) / 16.0;
        format!("{time_s},{:.1}\n", rate_n_per_s * time_s + f64::from(i % 3))
    };
    let head = "# winch_m_per_s: 0.0157\n# cable_length_m: 15\ntime_s,force_n\n";
    head.to_string() + &(0..640).map(row).collect::<String>()
}

#[test]
fn json_names_its_form_for_one_pull_and_for_several() {
    let dir = directory("json");
    fs::write(dir.join("a.csv"), pull(80.0)).unwrap();
    fs::write(dir.join("b.csv"), pull(80.5)).unwrap();
    for logs in [&["a.csv"][..], &["a.csv", "b.csv"]] {
        let output = floe(&dir, &[logs, &["--json"]].concat());
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["schema"], "floe-stiffness/1");
        let one = if logs.len() == 1 { &json } else { &json["pulls"][0] };
        assert!(one["stiffness_n_per_m"]["value"].as_f64().unwrap() > 5000.0, "{json}");
    }
}

#[test]
fn a_pull_that_counts_twice_is_said() {
    let dir = directory("twice");
    fs::write(dir.join("a.csv"), pull(80.0)).unwrap();
    fs::write(dir.join("b.csv"), pull(80.0)).unwrap();
    for twice in [["a.csv", "a.csv"], ["a.csv", "b.csv"]] {
        let output = floe(&dir, &twice);
        let why = format!("floe: warning: {}: holds the samples of a.csv: the same", twice[1]);
        assert!(text(&output.stderr).starts_with(&why), "{}", text(&output.stderr));
    }
    fs::write(dir.join("b.csv"), pull(80.5)).unwrap();
    assert_eq!(text(&floe(&dir, &["a.csv", "b.csv"]).stderr), "");
}

/// What the log says of the winch counts, and an option replaces it, also where the log contradicts
/// itself.
#[test]
fn the_deviation_of_the_winch_speed_comes_from_the_log_too() {
    let dir = directory("winch_std");
    let std_error = |head: &str, options: &[&str]| {
        fs::write(dir.join("a.csv"), head.to_string() + &pull(80.0)).unwrap();
        let output = floe(&dir, &[&["a.csv", "--json"], options].concat());
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        json["stiffness_n_per_m"]["std_error"].clone()
    };
    let (said, option) = ("# winch_std_m_per_s: 0.001\n", "--winch-std-m-per-s");
    let given = std_error("", &[option, "0.001"]);
    assert!(given.as_f64().unwrap() > 10.0 * std_error("", &[]).as_f64().unwrap(), "{given}");
    assert_eq!(std_error(said, &[]), given);
    assert_eq!(std_error(said, &[option, "0"]), std_error("", &[]));
    let both = "# winch_std_m_per_s: 0.002\n# winch_m_per_s: 0.02\n";
    let options = [option, "0.001", "--winch-m-per-s", "0.0157"];
    assert_eq!(std_error(&(said.to_string() + both), &options), given);
}

#[test]
fn a_deviation_without_its_length_is_said_to_have_no_use() {
    let dir = directory("length_std");
    fs::write(dir.join("a.csv"), pull(80.0).replace("# cable_length_m: 15\n", "")).unwrap();
    let said = text(&floe(&dir, &["a.csv", "--cable-length-std-m", "0.1"]).stderr);
    let why = "--cable-length-std-m is not used without the length: --cable-length-m L";
    assert_eq!(said, format!("floe: warning: a.csv: {why}\n"));
}

#[test]
fn what_is_assumed_about_the_log_is_said() {
    let dir = directory("assumed");
    fs::write(dir.join("a.csv"), pull(80.0).replace("force_n", "Load")).unwrap();
    let said = text(&floe(&dir, &["a.csv"]).stderr);
    assert_eq!(said, "floe: warning: a.csv: column 'Load' has no unit: taken as N\n");
}

/// A row that stands twice, with the same force or with another, is no second reading.
#[test]
fn a_repeated_row_counts_once() {
    let dir = directory("repeated");
    let once = pull(80.0);
    let twice = once.lines().map(|line| format!("{line}\n{line}\n")).collect::<String>();
    let twice = twice.replace("time_s,force_n\ntime_s,force_n\n", "time_s,force_n\n");
    fs::write(dir.join("once.csv"), &once).unwrap();
    fs::write(dir.join("twice.csv"), twice).unwrap();
    fs::write(dir.join("other.csv"), once.replace("\n5,", "\n4.9375,99\n5,")).unwrap();
    let json = |log: &str| text(&floe(&dir, &[log, "--json"]).stdout);
    assert_eq!(json("twice.csv"), json("once.csv"));
    assert_eq!(json("other.csv"), json("once.csv"));
}

#[test]
fn a_computed_pull_is_said() {
    let dir = directory("simulated");
    fs::write(dir.join("a.csv"), pull(80.0)).unwrap();
    fs::write(dir.join("b.csv"), format!("# SYNTHETIC: computed\n{}", pull(80.5))).unwrap();
    let json = |logs: &[&str]| -> serde_json::Value {
        serde_json::from_slice(&floe(&dir, &[logs, &["--json"]].concat()).stdout).unwrap()
    };
    assert_eq!(
        (json(&["a.csv"])["synthetic"].is_null(), &json(&["b.csv"])["synthetic"]),
        (true, &"computed".into())
    );
    let pulls = &json(&["a.csv", "b.csv"])["pulls"];
    assert!(pulls[0]["synthetic"].is_null() && pulls[1]["synthetic"] == "computed", "{pulls}");
    assert!(text(&floe(&dir, &["b.csv"]).stdout).starts_with("SIMULATED     computed\nstiff"));
    let both = text(&floe(&dir, &["a.csv", "b.csv"]).stdout);
    assert!(
        both.contains("  a.csv\n") && both.contains("  b.csv, SIMULATED: computed\n"),
        "{both}"
    );
}

#[test]
fn what_is_wrong_is_named() {
    let dir = directory("wrong");
    fs::write(dir.join("a.csv"), pull(80.0)).unwrap();
    for (options, why) in [
        (["--winch-m-per-s", "0"], "speed 0: must be a number above zero"),
        (["--winch-m-per-s", "-0.1"], "speed -0.1: must be a number above zero"),
        (["--winch-std-m-per-s", "-1"], "speed ± -1: must be a number not below zero"),
        (["--cable-length-std-m", "nan"], "length ± NaN: must be a number not below zero"),
        (["--extension", "-"], "only --json goes to standard output"),
    ] {
        let refused = floe(&dir, &[&["a.csv"][..], &options].concat());
        assert_refused(&refused, &[why]);
    }
    assert!(text(&floe(&dir, &["a.csv"]).stdout).starts_with("stiffness k"));
    assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
}
