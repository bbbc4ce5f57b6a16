//! `floe replay` as a command: exit codes, one-line messages, outputs.

use std::fs;
use std::io::Write;
use std::process::{Command, Output, Stdio};

use sha2::{Digest, Sha256};

#[path = "../support/command.rs"]
mod command;
mod refused;
use command::{assert_refused, directory, text};

fn floe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floe")).args(arguments).output().unwrap()
}

fn floe_fed(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // A command that refuses its input early closes the pipe.
    let _ = stdin.write_all(input);
    drop(stdin);
    child.wait_with_output().unwrap()
}

/// The result on standard output; standard error must be empty.
fn json(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A log of `samples` rows at 16 Hz on a slow ramp.
fn ramp(samples: u32) -> String {
    let row = |i| format!("{},{}\n", f64::from(i) / 16.0, 100.0 + f64::from(i) * 0.25);
    "time_s,force_n\n".to_string() + &(0..samples).map(row).collect::<String>()
}

#[test]
fn any_plausible_text_form_gives_the_same_samples() {
    let plain = ramp(100);
    let decimal_comma = plain.replace(',', ";").replace('.', ",");
    let forms: Vec<(&str, Vec<u8>)> = vec![
        ("plain", plain.clone().into_bytes()),
        ("crlf", plain.replace('\n', "\r\n").into_bytes()),
        ("no_end", plain.trim_end().as_bytes().to_vec()),
        ("mark", [b"\xEF\xBB\xBF".as_slice(), plain.as_bytes()].concat()),
        ("decimal_comma", decimal_comma.into_bytes()),
        ("tabs", plain.replace(',', "\t").into_bytes()),
        ("spaces", plain.replace(',', " , ").into_bytes()),
        ("quotes", plain.replace(',', "\",\"").replace('\n', "\"\n\"").into_bytes()),
        ("comments", plain.replace("\n1,", "\n# a comment\n\n1,").into_bytes()),
        ("names", plain.replace("time_s,force_n", "T,Force_N").into_bytes()),
    ];
    for (name, mut content) in forms {
        if name == "quotes" {
            content.insert(0, b'"');
            content.pop();
        }
        let result = json(&floe_fed(&["replay", "-", "--weight-n", "100", "--json"], &content));
        let log = &result["log"];
        assert_eq!(log["format"], "csv", "{name}");
        assert_eq!(log["samples"], 100, "{name}");
        assert_eq!(log["rate_hz"], 16.0, "{name}");
        assert_eq!(log["duration_s"], 99.0 / 16.0, "{name}");
        assert_eq!(log["warnings"], serde_json::json!([]), "{name}");
    }
}

#[test]
fn a_truncated_last_line_is_left_out_and_told() {
    let whole = ramp(40);
    for cut in ["2.5", "2.5,", "2.5,-", "2.5,\"11", "2.5,1e", "\0\0\0"] {
        let content = format!("{whole}{cut}");
        let arguments = ["replay", "-", "--weight-n", "100", "--json"];
        let output = floe_fed(&arguments, content.as_bytes());
        let result = json(&output);
        assert_eq!(result["log"]["samples"], 40, "{cut}");
        let warning = result["log"]["warnings"][0].as_str().unwrap();
        assert!(warning.contains("line 42") && warning.contains("cut off"), "{warning}");
        assert!(text(&output.stderr).contains(warning), "{cut}");
        let quiet = floe_fed(&[arguments.as_slice(), &["--quiet"]].concat(), content.as_bytes());
        assert_eq!(text(&quiet.stderr), "");
    }
}

#[test]
fn a_rate_far_above_that_of_the_stamps_is_doubted() {
    let arguments = ["replay", "-", "--weight-n", "100", "--json", "--rate-hz", "32"];
    let output = floe_fed(&arguments, ramp(80).as_bytes());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("come 16.000 times a second, and --rate-hz says 32"), "{said}");
}

#[test]
fn the_log_can_say_what_was_pulled() {
    let content = "# test_id: DFF8-13\n# weight_n: 630\n# slope_deg: 2\n".to_string() + &ramp(40);
    let test = &json(&floe_fed(&["replay", "-", "--json"], content.as_bytes()))["test"];
    assert_eq!(test["test_id"], "DFF8-13");
    assert_eq!(test["weight_n"], 630.0);
    assert!((test["slope_rad"].as_f64().unwrap() - 2.0_f64.to_radians()).abs() < 1e-6);
    let options = ["replay", "-", "--json", "--mass-kg", "10", "--slope-deg", "-1"];
    let test = &json(&floe_fed(&options, content.as_bytes()))["test"];
    assert!((test["weight_n"].as_f64().unwrap() - 98.0665).abs() < 1e-4);
    assert!(test["slope_rad"].as_f64().unwrap() < 0.0);
}

#[test]
fn no_events_is_a_result() {
    let log = ramp(40);
    let output = floe_fed(&["replay", "-", "--weight-n", "100"], log.as_bytes());
    assert_eq!(output.status.code(), Some(0));
    assert!(text(&output.stdout).contains("No events"));
    assert_eq!(text(&output.stderr), "");
    let quiet = floe_fed(&["replay", "-", "--weight-n", "100", "--quiet"], log.as_bytes());
    assert_eq!((quiet.status.code(), text(&quiet.stdout)), (Some(0), String::new()));
}

/// A winch that turns does not explain a constant force from which a slip is pulled; a block that
/// broke loose and slides on is moving.
#[test]
fn a_constant_force_that_rises_to_a_slip_may_have_been_held() {
    let dir = directory("held-or-sliding");
    let path = |name: &str| dir.join(name).to_str().unwrap().to_owned();
    let moving = |scene: &str, mark: &str| {
        let log = path(&format!("log-{mark}.csv"));
        let made = floe(&["simulate", scene, "-o", &log]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        if !mark.is_empty() {
            let marked = format!("\n# winch_marks_s: {mark} 0\n");
            let marked = fs::read_to_string(&log).unwrap().replacen('\n', &marked, 1);
            fs::write(&log, marked).unwrap();
        }
        let result = json(&floe(&["replay", &log, "--json"]));
        let steady = result["steady"].as_array().unwrap().clone();
        steady.iter().map(|it| it["moving"].as_bool()).collect::<Vec<_>>()
    };
    let base = include_str!("../../scenes/dff8-13.toml");
    let stopped = path("stopped.toml");
    let stops = "[winch_profile]\nkind = \"steps\"\nsteps = [[30.6, 0.0], [60.0, 1.0]]\n";
    fs::write(&stopped, base.to_owned() + stops).unwrap();
    for scene in ["scenes/honesty/tightened_held.toml", &stopped] {
        assert_eq!(moving(scene, ""), [None], "{scene}");
        assert_eq!(moving(scene, "moving"), [Some(true)], "{scene}");
        assert_eq!(moving(scene, "held"), [Some(false)], "{scene}");
    }
    for scene in ["breakaway", "steady_sliding"] {
        let scene = format!("scenes/honesty/{scene}.toml");
        assert_eq!(moving(&scene, ""), [Some(true)], "{scene}");
    }
}

#[test]
fn without_arguments_the_bundled_log_is_replayed_and_reported() {
    let dir = directory("bundled");
    let run = || Command::new(env!("CARGO_BIN_EXE_floe")).current_dir(&dir).output().unwrap();
    let output = run();
    let said = text(&output.stdout);
    assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()));
    // Means of the coefficients drawn for its 101 events, from `floe simulate --truth`.
    for (name, truth) in [("mu_s   ", 1.2390), ("mu     ", 0.7807)] {
        let line = said.lines().find(|line| line.starts_with(name)).unwrap();
        let mean: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!((mean - truth).abs() < 0.0006, "{line}");
    }
    assert!(!said.contains("written") && fs::read_dir(&dir).unwrap().next().is_none(), "{said}");
    // In the repository, the report is written to the folder of the build.
    fs::create_dir_all(dir.join("host-sim/logs")).unwrap();
    fs::write(dir.join("host-sim/logs/fig6-7.csv"), "").unwrap();
    fs::create_dir(dir.join("target")).unwrap();
    assert!(text(&run().stdout).ends_with("written       target/floe-report.html\n"));
    let again = run();
    let said = text(&again.stderr);
    assert!(
        said.ends_with("floe-report.html: the file that was there has been replaced\n"),
        "{said}"
    );
    let report = fs::read_to_string(dir.join("target/floe-report.html")).unwrap();
    let log = fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/logs/fig6-7.csv")).unwrap();
    let sum: String = Sha256::digest(&log).iter().map(|byte| format!("{byte:02x}")).collect();
    for part in ["SIMULATED", "computed, not measured; seed 39", sum.as_str(), "Made at"] {
        assert!(report.contains(part), "{part}");
    }
}

#[test]
fn samples_and_figures_are_written() {
    let dir = directory("samples");
    let log = concat!(env!("CARGO_MANIFEST_DIR"), "/logs/dff8-13.csv");
    let name = |file: &str| dir.join(file).to_str().unwrap().to_string();
    let run = |options: &[&str]| floe(&[&["replay", log, "--summary"], options].concat());
    let (csv, figures) = (name("a.csv"), name("figures"));
    let output = run(&["--samples", &csv, "--figures", &figures]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("SIMULATED") && !said.contains("onset s"), "{said}");
    let written = fs::read_to_string(&csv).unwrap();
    let rows: Vec<Vec<&str>> = written.lines().map(|row| row.split(',').collect()).collect();
    let names = ["time_s", "force_n", "rate_n_per_s", "phase", "block_m_per_s", "flag", "index"];
    assert_eq!(rows[0], names);
    let in_log = fs::read_to_string(log).unwrap();
    let in_log: Vec<&str> =
        in_log.lines().filter(|row| row.starts_with(char::is_numeric)).collect();
    assert_eq!(rows.len() - 1, in_log.len());
    for (index, (row, logged)) in rows.iter().skip(1).zip(in_log).enumerate() {
        assert_eq!(row[6], index.to_string());
        let (time, force) = logged.split_once(',').unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        assert!((number(row[0]) - number(time)).abs() < 1e-9);
        assert!((number(row[1]) - number(force)).abs() < 1e-4);
    }
    // Rate: the central difference of the neighbouring forces; the block's speed follows from it.
    let number = |row: usize, cell: usize| rows[row][cell].parse::<f64>().unwrap();
    let told = |i: &usize| rows[*i][3] == "slip" && !rows[*i][4].is_empty();
    let slipping = (200..rows.len() - 9).find(told).unwrap();
    let rate = (number(slipping + 1, 1) - number(slipping - 1, 1)) * 8.0;
    assert!((number(slipping, 2) - rate).abs() < 0.01 * rate.abs().max(10.0));
    assert!(number(slipping, 4) > -0.02 && number(slipping, 4) < 2.0);
    // The speed of a block at rest is zero; every row but the first and the last has a rate.
    let resting = rows.iter().skip(200).filter(|row| row[3] == "stick" && !row[2].is_empty());
    assert!(resting.clone().count() > 1000 && resting.clone().all(|row| row[4] == "0.0"));
    let without_rate = (1..rows.len()).filter(|&i| rows[i][2].is_empty());
    assert_eq!(without_rate.collect::<Vec<_>>(), [1, rows.len() - 1]);
    for file in ["history", "cycles", "slip", "plane", "convergence-static"] {
        let svg = fs::read_to_string(dir.join(format!("figures/{file}.svg"))).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.trim_end().ends_with("</svg>"), "{file}");
    }
    let parquet = name("a.parquet");
    assert_eq!(run(&["--samples", &parquet]).status.code(), Some(0));
    assert!(fs::read(&parquet).unwrap().starts_with(b"PAR1"));
    assert_refused(&run(&["--figures", &csv]), &[&csv, "is a file"]);
}

#[test]
fn the_bundled_log_reads_the_same_in_both_formats() {
    let path = |name| format!("{}/logs/{name}", env!("CARGO_MANIFEST_DIR"));
    let run = |name| json(&floe(&["replay", &path(name), "--weight-n", "630", "--json"]));
    let (csv, cr10) = (run("dff8-13.csv"), run("dff8-13.dat"));
    assert_eq!((&csv["log"]["format"], &cr10["log"]["format"]), (&"csv".into(), &"cr10".into()));
    for field in ["samples", "rate_hz", "duration_s", "missing", "duplicates", "rejected"] {
        assert_eq!(csv["log"][field], cr10["log"][field], "{field}");
    }
    let (csv, cr10) = (csv["events"].as_array().unwrap(), cr10["events"].as_array().unwrap());
    assert!(csv.len() > 60 && csv.len() == cr10.len());
    for (a, b) in csv.iter().zip(cr10) {
        // The logger records four or five digits of the force.
        for (field, most) in [("onset_s", 1e-3), ("mu_s", 1e-3), ("mu", 1e-3)] {
            let difference = a[field].as_f64().unwrap() - b[field].as_f64().unwrap();
            assert!(difference.abs() < most, "{field} {difference}");
        }
    }
}

#[test]
fn help_goes_to_standard_output() {
    for arguments in
        [["replay", "--help"], ["--version", "--version"], ["help", "replay"], ["help", "--help"]]
    {
        let output = floe(&arguments);
        assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0), "{arguments:?}");
        assert!(!output.stdout.is_empty());
    }
}
