//! `floe simulate`: the truth has the field names of a replay's result, and a replay of the log
//! finds the truth to the accuracy of the bound.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// A folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("floe-simulate-{}-{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn floe(folder: &Path, arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_floe")).current_dir(folder).args(arguments).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn scene(name: &str) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    scenes.join(name).to_str().unwrap().to_owned()
}

/// Truth and result of a scene.
fn simulate_and_replay(test: &str, name: &str, duration_s: &str) -> (Value, Value) {
    let folder = folder(test);
    let scene = scene(name);
    let arguments = ["simulate", &scene, "-o", "log.csv", "--truth", "truth.json"];
    let said = floe(&folder, &[&arguments[..], &["--duration-s", duration_s]].concat());
    assert!(said.contains("method: ") && said.contains("terms: "), "{said}");
    let truth = fs::read_to_string(folder.join("truth.json")).unwrap();
    let result = floe(&folder, &["replay", "log.csv", "--json"]);
    fs::remove_dir_all(folder).unwrap();
    (serde_json::from_str(&truth).unwrap(), serde_json::from_str(&result).unwrap())
}

#[test]
fn truth_has_the_names_of_a_result() {
    let (truth, result) = simulate_and_replay("names", "dff8-13.toml", "20");
    let (truth_event, event) = (&truth["events"][0], result["events"][0].as_object().unwrap());
    let only_measured = ["quality", "reason", "slip_length_m", "energy_j", "onset_time"];
    let is_measured = |name: &str| {
        only_measured.contains(&name) || name.contains("_std") || name.contains("ci95")
    };
    for name in event.keys().filter(|name| !is_measured(name)) {
        assert!(truth_event.get(name).is_some(), "{name} is missing in the truth");
    }
    assert_eq!(truth["synthetic"], true);
    assert_eq!(truth["scene"]["weight_n"], 630.0);
}

#[test]
fn states_tell_what_the_block_did_at_each_sample() {
    let (truth, _) = simulate_and_replay("states", "hard/slack.toml", "20");
    let names: Vec<&str> =
        truth["states"].as_array().unwrap().iter().map(|s| s["state"].as_str().unwrap()).collect();
    for state in ["stick", "slip", "slack_sliding", "slack_stuck"] {
        assert!(names.contains(&state), "{state}");
    }
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_floe")).current_dir(folder).args(arguments).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn what_is_said_of_a_log_is_so() {
    let folder = folder("said");
    fs::copy(scene("hard/dropped.toml"), folder.join("my scene.toml")).unwrap();
    let said = floe(&folder, &["simulate", "my scene.toml", "-o", "log.csv"]);
    let log = fs::read_to_string(folder.join("log.csv")).unwrap();
    let rows = log.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count();
    assert!(said.starts_with(&format!("log.csv: {rows} samples at 16 Hz, ")), "{said}");
    let command = "# made_by: floe simulate 'my scene.toml' -o log.csv --seed 1";
    assert!(log.lines().any(|line| line == command), "{log}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_name_of_several_lines_is_refused_and_a_path_of_several_stays_a_comment() {
    let folder = folder("lines");
    let whole = fs::read_to_string(scene("dff8-13.toml")).unwrap();
    let named = |name: &str| {
        let rest = whole.lines().filter(|line| !line.starts_with("test_id"));
        format!("test_id = \"{name}\"\n") + &rest.collect::<Vec<_>>().join("\n")
    };
    fs::write(folder.join("bad.toml"), named("A\\n0,1")).unwrap();
    let said = refused(&folder, &["simulate", "bad.toml", "-o", "log.csv"]);
    assert!(said.contains("bad.toml: test_id: must be one line"), "{said}");
    fs::write(folder.join("a\nb.toml"), named("A")).unwrap();
    floe(&folder, &["simulate", "a\nb.toml", "-o", "log.csv", "--duration-s", "5"]);
    let log = fs::read_to_string(folder.join("log.csv")).unwrap();
    let head = log.lines().take_while(|line| *line != "time_s,force_n");
    assert!(head.clone().count() > 3 && head.clone().all(|line| line.starts_with('#')), "{log}");
    let short = ["simulate", "a\nb.toml", "-o", "x.csv", "--duration-s", "0.01"];
    let said = refused(&folder, &short);
    assert_eq!(said, "floe: --duration-s: duration_s = 0.01: no sample at 16 Hz\n");
    let said = refused(&folder, &["simulate", "a\nb.toml", "-o", "x.csv", "--duration-s", "0"]);
    assert!(said.starts_with("floe: --duration-s: duration_s = 0: must be"), "{said}");
    fs::remove_dir_all(folder).unwrap();
}

/// The winch's profile is faster than the scene's nominal speed, the only one that is checked
/// first.
#[test]
fn a_test_that_cannot_be_computed_to_its_end_replaces_no_log() {
    let folder = folder("failed");
    floe(&folder, &["simulate", &scene("dff8-13.toml"), "-o", "log.csv", "--duration-s", "5"]);
    let log = fs::read(folder.join("log.csv")).unwrap();
    let whole = fs::read_to_string(scene("dff8-13.toml")).unwrap();
    let profile = "[winch_profile]\nkind = \"steps\"\nsteps = [[2.0, 90.0]]\n";
    fs::write(folder.join("fast.toml"), format!("shortening = true\n{whole}\n{profile}")).unwrap();
    let said = refused(&folder, &["simulate", "fast.toml", "-o", "log.csv"]);
    assert!(said.starts_with("floe: fast.toml: the block runs into the winch after "), "{said}");
    assert_eq!((said.lines().count(), fs::read(folder.join("log.csv")).unwrap()), (1, log));
    fs::remove_dir_all(folder).unwrap();
}

/// Root-mean-square of the errors over that of the bounds.
fn error_over_bound(truth: &Value, result: &Value, name: &str) -> f64 {
    let (truth, found) =
        (truth["events"].as_array().unwrap(), result["events"].as_array().unwrap());
    assert_eq!(truth.len(), found.len());
    let (mut errors, mut bounds, mut judged) = (0.0, 0.0, 0);
    for (t, f) in truth.iter().zip(found) {
        let of = |event: &Value, key: &str| event[key].as_f64();
        if let (Some(x), Some(y), Some(bound)) =
            (of(t, name), of(f, name), of(t, &format!("{name}_bound")))
        {
            errors += (x - y).powi(2);
            bounds += bound * bound;
            judged += 1;
        }
    }
    assert!(judged > 100 && judged * 20 > truth.len() * 19, "{judged} of {}", truth.len());
    (errors / bounds).sqrt()
}

#[test]
fn a_replay_finds_the_truth_to_the_bound() {
    let (truth, result) = simulate_and_replay("bound", "dff8-13.toml", "1200");
    for name in ["mu_s", "mu"] {
        let ratio = error_over_bound(&truth, &result, name);
        println!("{name}: error {ratio:.2} of the bound");
        // Information carried from event to event can beat the bound of a single event.
        assert!((0.4..1.1).contains(&ratio), "{name}: {ratio}");
    }
}

/// Replacing a file needs no right to write to it: who made it read-only is not asked.
#[test]
fn a_file_that_is_read_only_stays() {
    let folder = folder("read_only");
    let scene = scene("dff8-13.toml");
    floe(&folder, &["simulate", &scene, "-o", "log.csv", "--duration-s", "5"]);
    floe(&folder, &["replay", "log.csv", "--json", "result.json"]);
    for (file, again) in [
        ("log.csv", vec!["simulate", &scene, "-o", "log.csv"]),
        ("result.json", vec!["replay", "log.csv", "--json", "result.json"]),
    ] {
        let path = folder.join(file);
        let before = fs::read(&path).unwrap();
        let mut rights = fs::metadata(&path).unwrap().permissions();
        rights.set_readonly(true);
        fs::set_permissions(&path, rights).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
        let output = command.current_dir(&folder).args(again).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.starts_with(&format!("floe: {file}: is there already and read-only; ")),
            "{said}"
        );
        assert_eq!(fs::read(&path).unwrap(), before);
    }
}
