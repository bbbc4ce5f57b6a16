//! Conditions of a field season other than a block on level ice: a block under the ice, several
//! pulls against a post, dates.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("conditions-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Standard output, standard error and exit code.
fn floe(folder: &Path, arguments: &[&str]) -> (String, String, i32) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    let output = command.current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code().unwrap())
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let (said, error, code) = floe(folder, arguments);
    assert_eq!(code, 0, "{arguments:?}: {error}");
    serde_json::from_str(&said).unwrap()
}

fn simulate(folder: &Path, scene: &str, log: &str) {
    fs::write(folder.join("scene.toml"), scene).unwrap();
    let (_, error, code) =
        floe(folder, &["simulate", "scene.toml", "-o", log, "--truth", "truth.json"]);
    assert_eq!(code, 0, "{error}");
}

/// The bundled scene of a block under the ice: drag of the water adds a few thousandths to `mu`.
#[test]
fn water_that_drags_is_a_little_friction() {
    let folder = folder("drag");
    let scene = fs::read_to_string(SCENES.to_owned() + "/terms/under_ice.toml").unwrap();
    simulate(&folder, &scene, "drag.csv");
    let still = scene.replace("n_s2_per_m2 = 300.0", "n_s2_per_m2 = 0.0");
    simulate(&folder, &still, "still.csv");
    let mean = |log: &str, name: &str| {
        let under = ["replay", log, "--normal-n", "200", "--mass-kg", "203.943", "--json"];
        json(&folder, &under)["estimate"][name]["mean"].as_f64().unwrap()
    };
    let added = mean("drag.csv", "mu") - mean("still.csv", "mu");
    assert!(added > 0.0005 && added < 0.01, "{added}");
    assert!((mean("drag.csv", "mu_s") - 1.2).abs() < 0.004);
}

/// Rests of one second to a hundred: a campaign of tests with different hold times finds the trend
/// of the scenes.
#[test]
fn a_campaign_finds_static_friction_against_the_time_of_rest() {
    let folder = folder("hold");
    let scene = fs::read_to_string(SCENES.to_owned() + "/terms/hold_time.toml").unwrap();
    let steady = scene.split("[winch_profile]").next().unwrap();
    for (test, winch_m_per_s) in [0.0008, 0.0016, 0.0031, 0.0063, 0.0125].into_iter().enumerate() {
        let scene = steady
            .replace("winch_m_per_s = 0.0157", &format!("winch_m_per_s = {winch_m_per_s}"))
            .replace("hold-time", &format!("hold-{test}"));
        simulate(&folder, &scene, &format!("hold-{test}.csv"));
    }
    let found = json(&folder, &["campaign", ".", "--json", "--report", "hold.html"]);
    let trends = found["trends"].as_array().unwrap();
    let is = |trend: &&Value| {
        [&trend["coefficient"], &trend["against"], &trend["group"]]
            == ["mu_s", "hold_decades", "all"]
    };
    let trend = &trends.iter().find(is).expect("a trend")["trend"];
    let slope = trend["slope"].as_f64().unwrap();
    assert!((slope / 0.289 - 1.0).abs() < 0.05, "{trend}");
    let page = fs::read_to_string(folder.join("hold.html")).unwrap();
    assert!(page.contains("id=\"hold-mu-s-wide\""));
}

/// A campaign of several weights shows Rist's law, and the groups of Figs 9 and 10 in its table.
#[test]
fn rist_and_the_groups_of_the_figures_are_in_a_campaign() {
    let folder = folder("figures");
    for (test, kind) in ["rafting", "over-riding", "sliding", "rafting"].into_iter().enumerate() {
        let weight_n = 400 * (test + 1);
        let scene = format!(
            "duration_s = 60\nweight_n = {weight_n}\nmu_s = 1.24\nmu = 0.78\n\
             stiffness_n_per_m = 23000\nwinch_m_per_s = 0.0157\n[measurement]\nwhite_n = 2\n"
        );
        let log = format!("pull-{test}.csv");
        simulate(&folder, &scene, &log);
        let text = fs::read_to_string(folder.join(&log)).unwrap();
        fs::write(folder.join(log), format!("# kind: {kind}\n{text}")).unwrap();
    }
    let found = json(&folder, &["campaign", ".", "--json", "--report", "figures.html"]);
    let groups = found["groups"].as_array().unwrap();
    let tests = |name: &str| {
        groups.iter().find(|group| group["group"] == name).map(|group| group["mu"]["tests"].clone())
    };
    assert_eq!(tests("rafting"), Some(2.into()));
    assert_eq!(tests("over_riding").or(tests("over-riding")), Some(1.into()));
    let page = fs::read_to_string(folder.join("figures.html")).unwrap();
    assert!(page.contains("class=\"rist\""));
}

/// A block of 2000 N under the ice with a normal force of 200 N moves like a block on the ice with
/// a tenth of the coefficients.
#[test]
fn under_the_ice_the_normal_force_presses_and_the_mass_moves() {
    let folder = folder("under");
    let scene = "weight_n = 2000\nmu_s = 0.12\nmu = 0.07\nstiffness_n_per_m = 23000\n\
                 winch_m_per_s = 0.004\n[measurement]\nwhite_n = 0.5\n";
    simulate(&folder, scene, "under.csv");
    let mass_kg = format!("{}", 2000.0 / 9.80665);
    let under = ["replay", "under.csv", "--normal-n", "200", "--mass-kg", &mass_kg, "--json"];
    let found = json(&folder, &under);
    let on = json(&folder, &["replay", "under.csv", "--weight-n", "2000", "--json"]);
    for (name, truth) in [("mu_s", 1.2), ("mu", 0.7)] {
        let mean = |of: &Value| of["estimate"][name]["mean"].as_f64().unwrap();
        assert!((mean(&found) - truth).abs() < 0.004, "{name}: {}", mean(&found));
        assert!((mean(&found) - 10.0 * mean(&on)).abs() < 1e-4, "{name}");
    }
    let k = |of: &Value| of["stiffness_from_omega_n_per_m"].as_f64().unwrap();
    assert!((k(&found) / k(&on) - 1.0).abs() < 1e-4, "{} {}", k(&found), k(&on));
    assert_eq!(found["test"]["weight_n"], 200.0);
    assert!((found["test"]["mass_kg"].as_f64().unwrap() - 203.943).abs() < 0.001);
    assert_eq!(on["test"]["mass_kg"], Value::Null);

    // The same numbers in the log's metadata.
    let log = fs::read_to_string(folder.join("under.csv")).unwrap();
    let said = format!("# normal_n: 200\n# mass_kg: {mass_kg}\n{}", without_weight(&log));
    fs::write(folder.join("said.csv"), said).unwrap();
    let said = json(&folder, &["replay", "said.csv", "--json"]);
    assert_eq!(said["estimate"], found["estimate"]);
    let (table, _, _) = floe(&folder, &["replay", "said.csv"]);
    assert!(table.contains("under the ice: normal force 200.0 N, mass 203.9"), "{table}");

    for (arguments, why) in [
        (&["replay", "under.csv", "--normal-n", "200"][..], "--mass-kg"),
        (&["replay", "under.csv", "--normal-n", "200", "--mass-kg", "0"], "--mass-kg"),
        (
            &["replay", "under.csv", "--normal-n", "200", "--mass-kg", "9", "--slope-deg", "2"],
            "level",
        ),
        (&["replay", "under.csv", "--normal-n", "200", "--weight-n", "630"], "--weight-n"),
        (&["replay", "under.csv", "--normal-n", "-3", "--mass-kg", "9"], "-3"),
    ] {
        let (_, error, code) = floe(&folder, arguments);
        assert!(code == 2 && error.contains(why), "{arguments:?}: {error}");
    }
}

fn without_weight(log: &str) -> String {
    let lines = log.lines().filter(|line| !line.starts_with("# weight_n"));
    lines.map(|line| format!("{line}\n")).collect()
}

/// A pull of a cable with AE of 345 kN and this length, with end fittings of 200 kN/m.
fn post(folder: &Path, length_m: f64, log: &str) {
    let k = (1.0 / 200_000.0 + length_m / 345_000.0_f64).recip();
    let scene = format!(
        "weight_n = 630\nmu_s = 1.24\nmu = 0.78\npost = true\nduration_s = 3\n\
         stiffness_n_per_m = {k}\nwinch_m_per_s = 0.0157\ncable_length_m = {length_m}\n\
         [measurement]\nwhite_n = 1\n"
    );
    simulate(folder, &scene, log);
}

#[test]
fn pulls_of_two_lengths_tell_the_cable_from_its_ends() {
    let folder = folder("post");
    for (length_m, log) in [(5.0, "short.csv"), (15.0, "long.csv")] {
        post(&folder, length_m, log);
    }
    let both = ["stiffness", "short.csv", "long.csv", "--cable-length-m", "5,15"];
    let found = json(&folder, &[&both[..], &["--extension", "fig8.csv", "--json"]].concat());
    let together = &found["together"];
    for (name, truth) in [("ae_n", 345_000.0), ("end_stiffness_n_per_m", 200_000.0)] {
        let (value, std) = (&together[name]["value"], &together[name]["std_error"]);
        let (value, std) = (value.as_f64().unwrap(), std.as_f64().unwrap());
        assert!((value - truth).abs() < 3.0 * std && std < 0.1 * truth, "{name} {value} ± {std}");
    }
    assert_eq!(found["pulls"].as_array().unwrap().len(), 2);
    let fig8 = fs::read_to_string(folder.join("fig8.csv")).unwrap();
    let rows: Vec<&str> = fig8.lines().collect();
    assert_eq!(rows[0], "pull,extension_m,force_n");
    assert!(rows[1].starts_with("0,0.000000,") && rows.last().unwrap().starts_with("1,0."));

    let (text, _, _) = floe(&folder, &both);
    assert!(text.contains("AE ") && text.contains("k0, its ends"), "{text}");
    // One length: the mean; without a length: each pull alone.
    let same = ["stiffness", "short.csv", "short.csv", "--cable-length-m", "5", "--json"];
    let mean = &json(&folder, &same)["together"];
    assert!(mean["stiffness_n_per_m"]["value"].as_f64().unwrap() > 50_000.0, "{mean}");
    assert_eq!(mean["ae_n"], Value::Null);
    let (_, error, code) =
        floe(&folder, &["stiffness", "short.csv", "long.csv", "--cable-length-m", "5,6,7"]);
    assert!(code == 2 && error.contains("3 lengths of the cable for 2 logs"), "{error}");
}

/// The bundled scene begins one minute before midnight of 9 April 1994.
#[test]
fn dates_of_a_campbell_logger_survive_a_replay() {
    let folder = folder("dates");
    let scene = "weight_n = 630\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000\n\
                 winch_m_per_s = 0.0157\nduration_s = 80\n";
    simulate(&folder, scene, "pull.dat");
    simulate(&folder, scene, "pull.csv");
    let of = |log: &str| json(&folder, &["replay", log, "--weight-n", "630", "--json"]);
    let dated = of("pull.dat");
    let events = dated["events"].as_array().unwrap();
    let time = |event: &Value| event["onset_time"].as_str().unwrap().to_string();
    let at = |event: &Value| event["onset_s"].as_f64().unwrap();
    let first = time(&events[0]);
    assert!(first.starts_with("1994-04-09T23:59:0") && !first.ends_with('Z'), "{first}");
    let last = events.last().unwrap();
    let seconds: f64 = time(last).split(':').next_back().unwrap().parse().unwrap();
    assert!(time(last).starts_with("1994-04-10T00:00:"), "{}", time(last));
    assert!((seconds - (at(last) - 60.0)).abs() < 0.07, "{seconds} {}", at(last));
    assert_eq!(of("pull.csv")["events"][0]["onset_time"], Value::Null);
}
