//! Doubts that a replay reports, and errors in writing a table.

use std::fs;
use std::process::{Command, Output};

#[path = "../support/command.rs"]
mod command;
mod given;
use command::{assert_refused, directory, text};

fn floe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floe")).args(arguments).output().unwrap()
}

#[test]
fn what_hardly_belongs_together_is_asked_about() {
    let dir = directory("doubts");
    let log = fs::read_to_string("logs/fig6-7.csv").unwrap();
    let kilonewtons = log.replacen("force_n", "force", 1).replacen("# weight_n: 630", "", 1);
    let path = dir.join("kilonewtons.csv");
    fs::write(&path, kilonewtons).unwrap();
    let said = |arguments: &[&str]| {
        let output = floe(&[&["replay", path.to_str().unwrap(), "--json"], arguments].concat());
        json_with_warnings(&output)
    };
    let small = said(&["--weight-n", "630000"]);
    assert!(
        small.contains("hardly friction: is the force in N, and the weight 630000.0 N?"),
        "{small}"
    );
    let right = said(&["--weight-n", "630", "--unit", "N"]);
    assert!(!right.contains("hardly"), "{right}");
    let other = floe(&["replay", "logs/fig6-7.csv", "--weight-n", "700", "--json"]);
    let other = json_with_warnings(&other);
    assert!(
        other.contains("weight 700.0 N as given, not the '# weight_n: 630' of line 5"),
        "{other}"
    );
}

/// A simulated log in a directory of its own.
fn simulated(test: &str, scene: &str) -> String {
    let path = directory(test).join("pull.csv").to_str().unwrap().to_string();
    let made = floe(&["simulate", scene, "-o", &path]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    path
}

/// The cable is softer during a slip than during loading: weight and winch speed are right.
#[test]
fn a_cable_that_sags_has_two_stiffnesses() {
    let path = simulated("sag", "scenes/hard/sag_flop.toml");
    let told = floe(&["replay", &path, "--summary"]);
    let said = text(&told.stdout);
    assert!(said.contains("of the two: a cable that sags is softer in the slip"), "{said}");
    assert!(!text(&told.stderr).contains("stiffness"), "{}", text(&told.stderr));
}

/// Both stiffnesses agree if weight and winch speed are right.
#[test]
fn a_weight_that_the_winch_contradicts_is_asked_about() {
    let path = simulated("stiffness", "scenes/dff8-13.toml");
    let said = |weight: &str| {
        let json = json_with_warnings(&floe(&["replay", &path, "--weight-n", weight, "--json"]));
        let summary = floe(&["replay", &path, "--weight-n", weight, "--summary"]);
        (json, text(&summary.stdout))
    };
    for weight in ["570", "700"] {
        let (asked, line) = said(weight);
        assert!(asked.contains("weight or winch speed may be wrong by that much, or"), "{asked}");
        assert!(line.contains("of the two: differ by more than their ±"), "{line}");
    }
    let (asked, line) = said("800");
    assert!(asked.contains("the stiffness from the winch speed is 0.7"), "{asked}");
    assert!(asked.contains("weight or winch speed is wrong, or"), "{asked}");
    assert!(line.contains("of the two: they disagree") && !line.contains("checks both"), "{line}");
    let (told, line) = said("630");
    assert!(
        !told.contains("stiffness") && line.contains("of the two: checks both"),
        "{told} {line}"
    );
}

/// With right inputs, errors that shift omega by more than its ± accuse neither weight nor winch.
#[test]
fn slips_that_are_no_ellipses_accuse_no_input() {
    let path = directory("no-ellipses").join("pull.csv").to_str().unwrap().to_string();
    for scene in ["jitter_10", "lag_30", "rocking", "jitter_2", "base"] {
        for seed in ["1", "2", "3", "4"] {
            let toml = format!("scenes/honesty/{scene}.toml");
            let made = floe(&["simulate", &toml, "--seed", seed, "-o", &path]);
            assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
            let said = floe(&["replay", &path, "--summary"]);
            assert!(!text(&said.stderr).contains("is wrong"), "{}", text(&said.stderr));
            assert!(!text(&said.stdout).contains("disagree"), "{}", text(&said.stdout));
        }
    }
}

/// Where rests are brief, only slips with a large drop have coefficients: not those of all slips.
#[test]
fn means_of_a_choice_are_called_so() {
    let dir = directory("choice");
    let (scene, log) = (dir.join("choice.toml"), dir.join("choice.csv"));
    let brief = "duration_s = 20.0\nweight_n = 12500.0\nmu_s = 0.42\nmu = 0.28\n\
                 stiffness_n_per_m = 472000.0\nwinch_m_per_s = 0.1255\n\
                 [variation]\nmu_s_fraction = 0.1\nmu_fraction = 0.02\n[measurement]\nwhite_n = 10.0\n";
    fs::write(&scene, brief).unwrap();
    let (scene, log) = (scene.to_str().unwrap(), log.to_str().unwrap());
    assert_eq!(floe(&["simulate", scene, "-o", log]).status.code(), Some(0));
    let said = json_with_warnings(&floe(&["replay", log, "--json"]));
    assert!(said.contains("events have coefficients: the means are those of a choice"), "{said}");
    let all = json_with_warnings(&floe(&["replay", "logs/fig6-7.csv", "--json"]));
    assert!(!all.contains("of a choice"), "{all}");
}

/// Of tops near the end of the range only the lower ones are read, however many those are.
#[test]
fn means_below_the_end_of_the_range_are_called_so() {
    let dir = directory("below-the-range");
    let path = |name: &str| dir.join(name).to_str().unwrap().to_owned();
    let (scene, log, page) = (path("scene.toml"), path("log.csv"), path("report.html"));
    let varied = "\n[variation]\nmu_s_fraction = 0.01\nmu_fraction = 0.01\n";
    fs::write(&scene, include_str!("../../scenes/dff8-13.toml").to_owned() + varied).unwrap();
    assert_eq!(floe(&["simulate", &scene, "-o", &log]).status.code(), Some(0));
    let said = |limit: &str| {
        let with = ["replay", &log, "--range-n", limit];
        let json = json_with_warnings(&floe(&[&with[..], &["--json"]].concat()));
        let table = text(&floe(&[&with[..], &["--summary", "--report", &page]].concat()).stdout);
        [json, table, fs::read_to_string(&page).unwrap()]
    };
    let cut_off = said("785");
    for it in &cut_off {
        assert!(it.contains("the means are those of a choice"), "{it}");
        assert!(it.contains("mu_s is that of the slips below the limit, a lower bound"), "{it}");
    }
    let counts = cut_off[1].split_once(" events have coefficients").unwrap().0;
    let counts: Vec<u32> = counts.rsplitn(4, ' ').filter_map(|it| it.parse().ok()).collect();
    assert!(counts[0] > counts[1] && 2 * counts[1] > counts[0], "{counts:?}");
    assert!(said("900").iter().all(|it| !it.contains("of a choice")));
}

/// A slip every few samples may be an alias of faster slips: only the speed of the winch decides.
#[test]
fn fast_slips_without_the_speed_of_the_winch_are_asked_about() {
    let dir = directory("alias");
    let (known, unknown) = (dir.join("known.csv"), dir.join("unknown.csv"));
    let path = |path: &std::path::Path| path.to_str().unwrap().to_owned();
    let made = floe(&["simulate", "scenes/linear/fast.toml", "-o", &path(&known)]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let log = fs::read_to_string(&known).unwrap();
    let lines = log.lines().filter(|line| !line.starts_with("# winch_"));
    fs::write(&unknown, lines.collect::<Vec<_>>().join("\n")).unwrap();
    let said = |path: &str| json_with_warnings(&floe(&["replay", path, "--json"]));
    let asked = said(&path(&unknown));
    assert!(asked.contains("samples may be the alias of faster ones"), "{asked}");
    let told = said(&path(&known));
    assert!(!told.contains("alias"), "{told}");
    let with = |log: &str, speed: &str| {
        json_with_warnings(&floe(&["replay", log, "--winch-m-per-s", speed, "--json"]))
    };
    let given = with(&path(&unknown), "0.04");
    assert!(!given.contains("alias"), "{given}");
    let other = with(&path(&known), "0.3");
    assert!(other.contains("m/s as given, not the '# winch_m_per_s:"), "{other}");
    let slow = said("logs/fig6-7.csv");
    assert!(!slow.contains("alias"), "{slow}");
}

/// A likely limit of the sensor is reported; once the range is given, no slip beyond it counts.
#[test]
fn a_limit_that_the_log_does_not_name_is_asked_about() {
    let dir = directory("rails");
    let path = dir.join("cut.csv");
    let path = path.to_str().unwrap();
    let report = dir.join("cut.html");
    for log in ["logs/dff8-13.csv", "logs/fig6-7.csv"] {
        let whole = fs::read_to_string(log).unwrap();
        let forces = whole.lines().filter_map(|line| line.split_once(',')?.1.parse::<f64>().ok());
        let largest_n = forces.fold(0.0, f64::max);
        assert!(!warned_of_a_limit(&["replay", log, "--json"]), "{log}");
        for percent in [60, 75, 90, 95, 98] {
            let limit_n = (largest_n * f64::from(percent)).round() / 100.0;
            let cut = |line: &str| match line.split_once(',').map(|(t, f)| (t, f.parse::<f64>())) {
                Some((time_s, Ok(force_n))) => format!("{time_s},{}\n", force_n.min(limit_n)),
                _ => format!("{line}\n"),
            };
            fs::write(path, whole.lines().map(cut).collect::<String>()).unwrap();
            let said = json_with_warnings(&floe(&["replay", path, "--json"]));
            assert!(said.contains(&format!("--range-n {limit_n},")), "{log} {percent} %: {said}");
        }
        // The limit is that of the cell, whatever its zero.
        let zeros = ["--zero-before-n", "-20", "--zero-after-n", "35"];
        let said = json_with_warnings(&floe(&[&["replay", path, "--json"], &zeros[..]].concat()));
        let limit_n = (largest_n * 98.0).round() / 100.0;
        assert!(said.contains(&format!("--range-n {limit_n},")), "{log}: {said}");
        let refused = floe(&["replay", path, "--range-n", "400", "--json"]);
        let refused: serde_json::Value = serde_json::from_slice(&refused.stdout).unwrap();
        assert_eq!(refused["estimate"]["events"], 0);
        let hidden = "samples lie at the end of the cell's range of 400 N, its 'range_n': the tops of the slips";
        assert!(refused["log"]["warnings"].to_string().contains(hidden), "{}", refused["log"]);
        assert!(refused["log"]["saturated"].as_u64().unwrap() > 900, "{}", refused["log"]);
    }
    let output = floe(&["replay", path, "--report", report.to_str().unwrap()]);
    for said in [text(&output.stderr), text(&output.stdout), fs::read_to_string(report).unwrap()] {
        assert!(said.contains("samples lie exactly at"), "{said}");
    }
    let refused = floe(&["replay", path, "--range-n", "0"]);
    assert_refused(&refused, &["--range-n must be a number above zero"]);
}

/// No scene has a likely limit: coarse steps, forces at rest, swings, spikes, a range in the log.
#[test]
fn no_scene_is_asked_about_a_limit() {
    let made = directory("no-rails").join("made.csv");
    let made = made.to_str().unwrap();
    let mut scenes = 0;
    for folder in ["scenes", "scenes/hard", "scenes/honesty", "scenes/linear", "scenes/paper"] {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        for scene in entries.filter(|path| path.extension().is_some_and(|it| it == "toml")) {
            let scene = scene.to_str().unwrap();
            let output = floe(&["simulate", scene, "-o", made, "--duration-s", "60"]);
            assert_eq!(output.status.code(), Some(0), "{scene}: {}", text(&output.stderr));
            assert!(!warned_of_a_limit(&["replay", made, "--json"]), "{scene}");
            scenes += 1;
        }
    }
    assert!(scenes > 70, "{scenes} scenes");
}

fn warned_of_a_limit(arguments: &[&str]) -> bool {
    json_with_warnings(&floe(arguments)).contains("samples lie exactly at")
}

fn json_with_warnings(output: &Output) -> String {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    json["log"]["warnings"].to_string()
}

/// The error message is not the one of the Parquet library.
#[cfg(target_os = "linux")]
#[test]
fn a_table_that_does_not_fit_says_so_plainly() {
    let dir = directory("full");
    let full = dir.join("full.parquet");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let full = full.to_str().unwrap();
    fs::write(dir.join("list.txt"), concat!(env!("CARGO_MANIFEST_DIR"), "/logs/fig6-7.csv\n"))
        .unwrap();
    let list = dir.join("list.txt");
    for arguments in [
        ["replay", "logs/fig6-7.csv", "--samples", full],
        ["campaign", list.to_str().unwrap(), "--parquet", full],
    ] {
        let refused = floe(&arguments);
        assert_refused(&refused, &["full.parquet: cannot be written: No space left"]);
    }
}

/// Refused events give neither omega nor stiffness, and show no effect.
#[test]
fn a_record_without_an_event_that_counts_says_why_and_no_more() {
    let path = directory("refused").join("fast.csv");
    let path = path.to_str().unwrap();
    let made = floe(&["simulate", "scenes/honesty/aliased_fast.toml", "-o", path, "--seed", "1"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let json: serde_json::Value =
        serde_json::from_slice(&floe(&["replay", path, "--json"]).stdout).unwrap();
    assert_eq!(json["estimate"]["events"], 0);
    for name in ["omega_rad_per_s", "loading_rate_n_per_s", "stiffness_n_per_m", "recurrence_s"] {
        assert!(json[name].is_null(), "{name}: {}", json[name]);
    }
    let said = text(&floe(&["replay", path, "--summary"]).stdout);
    let refused = json["events"].as_array().unwrap().len();
    assert!(said.contains(&format!("0 of {refused} events count\n       ")), "{said}");
    assert!(said.contains(" not counted: ") && !said.contains("shows "), "{said}");
}

/// The code of the HX711's data sheet gives zero force as 8388608.
#[test]
fn codes_around_8388608_are_read_or_the_remedy_is_said() {
    let path = directory("codes").join("codes.csv");
    let log = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let (head, rows) = log.split_once("time_s,force_n\n").unwrap();
    let replayed = |zero: i32, tare: i32| {
        let code = |row: &str| {
            let (time_s, force_n) = row.split_once(',').unwrap();
            let counts = (force_n.parse::<f64>().unwrap() * 812.5).round() as i32;
            format!("{time_s},{}\n", zero + counts)
        };
        let rows = rows.lines().map(code).collect::<String>();
        let text =
            format!("{head}# tare_counts: {tare}\n# counts_per_n: 812.5\ntime_s,counts\n{rows}");
        fs::write(&path, text).unwrap();
        let output = floe(&["replay", path.to_str().unwrap(), "--json"]);
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let signed = replayed(4120, 4120);
    assert_eq!(signed["estimate"]["events"], 66);
    for zero in [8_388_608 + 4120, 100_000_000] {
        let other = replayed(zero, zero);
        assert_eq!(other["estimate"], signed["estimate"], "{zero}");
        assert_eq!(other["log"]["saturated"], 0);
    }
    let below = replayed(8_388_608 - 4120, 8_388_608 - 4120)["log"]["warnings"].to_string();
    assert!(below.contains("subtract 8388608 from codes that have their zero near it"), "{below}");
}

/// A log without forces is distinguished from a log without slips.
#[test]
fn samples_that_cannot_be_used_are_said() {
    let dir = directory("no-force");
    let log = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let (head, rows) = log.split_once("time_s,force_n\n").unwrap();
    let count = rows.lines().count();
    let no_numbers: String =
        rows.lines().map(|row| format!("{},NaN\n", row.split(',').next().unwrap())).collect();
    let shifted: String = rows
        .lines()
        .map(|row| row.split_once(',').unwrap())
        .map(|(time, force)| format!("{time},{}\n", force.parse::<f64>().unwrap() + 6000.0))
        .collect();
    for (name, head, rows, why) in [
        ("nan.csv", head.to_string(), no_numbers, format!("{count} of {count} are no number")),
        (
            "range.csv",
            format!("{head}# range_n: 5\n"),
            shifted,
            format!("{count} lie at the end of the cell's range of 5 N, its 'range_n'"),
        ),
    ] {
        let path = dir.join(name);
        fs::write(&path, format!("{head}time_s,force_n\n{rows}")).unwrap();
        let output = floe(&["replay", path.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let said = text(&output.stdout);
        assert!(said.contains("No events: no sample of this log can be used"), "{said}");
        assert!(said.contains("no sample is a force: ") && said.contains(&why), "{said}");
        let json = json_with_warnings(&floe(&["replay", path.to_str().unwrap(), "--json"]));
        assert!(json.contains(&why), "{json}");
    }
}
