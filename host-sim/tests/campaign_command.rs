//! `floe campaign`, `stiffness` and `simulate` as commands: output independent of the number of
//! threads, and real logs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("floe-campaign-{}-{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn floe(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floe")).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = folder("threads");
    let of = |threads: &str| {
        let names = ["c.parquet", "c.json", "c.html"];
        let [parquet, json, html] = names.map(|name| format!("{threads}-{name}"));
        let arguments = [
            "campaign",
            "--repeat",
            "12",
            "--threads",
            threads,
            "--parquet",
            &parquet,
            "--json",
            &json,
            "--report",
            &html,
        ];
        let output = floe(&folder, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        ([parquet, json, html].map(|name| fs::read(folder.join(name)).unwrap()), output.stdout)
    };
    let one = of("1");
    assert!(one.0.iter().all(|file| file.len() > 1000));
    assert!(one == of("3"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn recorded_logs_give_the_same_as_a_replay() {
    let folder = folder("recorded");
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/linear");
    for name in ["fast", "heavy", "light", "snow"] {
        let scene = scenes.join(name).with_extension("toml");
        let log = format!("{name}.csv");
        let output = floe(&folder, &["simulate", scene.to_str().unwrap(), "-o", &log]);
        assert!(output.status.success());
    }
    fs::write(folder.join("notes.md"), "not a log").unwrap();
    fs::write(folder.join("list"), "# two of them\nheavy.csv\n\nlight.csv\n").unwrap();
    let json = |arguments: &[&str]| -> serde_json::Value {
        let output = floe(&folder, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let all = json(&["campaign", ".", "--json"]);
    let records = all["records"].as_array().unwrap();
    assert_eq!(records.len(), 4);
    assert_eq!((&all["synthetic"], &all["synthetic_tests"]), (&true.into(), &4.into()));
    for record in records {
        let name = record["test_id"].as_str().unwrap();
        let replayed = json(&["replay", &format!("{name}.csv"), "--json"]);
        assert_eq!(record["synthetic"], replayed["log"]["synthetic"]);
        assert_eq!(record["mu"], replayed["estimate"]["mu"]);
        assert_eq!(record["mu_s"], replayed["estimate"]["mu_s"]);
    }
    let systematic = |it: &serde_json::Value| it["mu"]["systematic_std"].as_f64().unwrap();
    let common = records.iter().map(systematic).sum::<f64>() / 4.0;
    let group = all["groups"].as_array().unwrap().iter().find(|it| it["group"] == "all").unwrap();
    assert!((group["mu_systematic_std"].as_f64().unwrap() - common).abs() < 1e-9);
    assert_eq!(json(&["campaign", "list", "--json"])["tests"], 2);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn bad_input_is_one_clear_line() {
    let folder = folder("bad");
    fs::create_dir_all(folder.join("empty")).unwrap();
    fs::write(folder.join("list"), "missing.csv\n").unwrap();
    fs::write(folder.join("no-weight.csv"), "time_s,force_n\n0,1\n0.0625,2\n0.125,3\n").unwrap();
    fs::write(folder.join("scene.toml"), "weight_n = 1\n").unwrap();
    for (arguments, expected) in [
        (&["campaign", "nowhere"][..], "nowhere"),
        (&["campaign", "empty"], "no logs: give a directory with .csv, .dat, .txt or .log"),
        (&["campaign", "list"], "missing.csv"),
        (&["campaign", "."], "weight"),
        (&["campaign", "no-weight.csv"], "a log itself goes to floe replay"),
        (&["campaign", "--repeat", "0"], "--repeat"),
        (&["campaign", "--threads", "99999"], "--threads"),
        (&["campaign", "list", "--seed", "3"], "--seed"),
        (&["campaign", "--parquet", "nowhere/c.parquet"], "nowhere"),
        (&["stiffness", "nowhere.csv"], "nowhere.csv"),
        (&["stiffness", "no-weight.csv"], "winch"),
        (&["simulate", "nowhere.toml", "-o", "x.csv"], "nowhere.toml"),
        (&["simulate", "scene.toml", "-o", "x.csv"], "missing field"),
        (&["simulate", "scene.toml", "-o", "x.xls"], "x.xls"),
        (&["simulate", "scene.toml", "-o", "scene.toml"], "scene.toml"),
    ] {
        let output = floe(&folder, arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert_eq!(error.trim_end().lines().count(), 1, "{arguments:?}: {error}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    assert_eq!(fs::read_to_string(folder.join("scene.toml")).unwrap(), "weight_n = 1\n");
    assert!(!folder.join("x.csv").exists());
    fs::remove_dir_all(folder).unwrap();
}

/// Assumptions about a log and duplicate logs are reported with the numbers.
#[test]
fn what_is_assumed_and_what_is_there_twice_is_said() {
    let folder = folder("notes");
    let log = include_str!("../logs/dff8-13.csv");
    fs::write(folder.join("a.csv"), log.replace("time_s,force_n", "time_s,force")).unwrap();
    fs::write(folder.join("b.csv"), log.replace("DFF8-13", "again")).unwrap();
    let output = floe(&folder, &["campaign", ".", "--json"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    assert!(error.contains("note: ./a.csv: column 'force' has no unit: taken as N"), "{error}");
    assert!(error.contains("./a.csv and ./b.csv give the same numbers"), "{error}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["records"][0]["path"], "./a.csv");
    assert_eq!(json["records"][0]["warnings"].as_array().map(Vec::len), Some(1));
    assert_eq!(json["records"][1]["warnings"].as_array().map(Vec::len), Some(0));
    fs::write(folder.join("b.csv"), log).unwrap();
    let error = String::from_utf8(floe(&folder, &["campaign", "."]).stderr).unwrap();
    assert!(error.contains("a.csv and ./b.csv give the same numbers"), "{error}");
    fs::remove_dir_all(folder).unwrap();
}

/// A closed standard error causes no panic.
#[test]
fn what_nobody_reads_is_no_panic() {
    let folder = folder("unread");
    for arguments in [&["campaign"][..], &["replay", "nowhere.csv"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
        let command = command.current_dir(&folder).args(arguments);
        let status = command.stdout(Stdio::null()).stderr(writer).status().unwrap();
        assert!(matches!(status.code(), Some(0 | 2)), "{arguments:?}: {status}");
    }
    fs::remove_dir_all(folder).unwrap();
}

/// Simulated tests are marked in every output: table, report, events and JSON.
#[test]
fn what_was_simulated_is_said_everywhere() {
    let folder = folder("simulated");
    let log = include_str!("../logs/dff8-13.csv");
    let measured = log.replace("# SYNTHETIC:", "# made:").replace(": DFF8-13", ": field");
    let evaluate = |logs: &[&str]| {
        let outputs = ["--report", "c.html", "--parquet", "c.parquet"];
        let run = |more: &[&str]| floe(&folder, &[&["campaign"], logs, &outputs, more].concat());
        let table = String::from_utf8(run(&[]).stdout).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&run(&["--json"]).stdout).unwrap();
        let events = fs::read(folder.join("c.parquet")).unwrap();
        let keyed = events.windows(14).any(|it| it == b"floe.synthetic");
        (table, json, fs::read_to_string(folder.join("c.html")).unwrap(), keyed)
    };
    fs::create_dir_all(folder.join("logs")).unwrap();
    for (name, log, said) in
        [("field", &*measured, None), ("computed", log, Some("1 of 2 tests, computed, not"))]
    {
        fs::write(folder.join("logs").join(name).with_extension("csv"), log).unwrap();
        let (table, json, page, keyed) = evaluate(&["logs"]);
        let starts = said.map_or_else(|| "test ".to_string(), |said| format!("SIMULATED: {said}"));
        assert!(table.starts_with(&starts), "{table}");
        assert_eq!(page.contains("<b>SIMULATED</b>"), said.is_some());
        assert!(said.is_none_or(|said| page.contains(said)) && keyed == said.is_some());
        assert_eq!(json["synthetic"], said.is_some());
        let field = json["records"].as_array().unwrap().iter().find(|it| it["test_id"] == "field");
        assert!(field.unwrap()["synthetic"].is_null(), "{json}");
    }
    let (table, json, page, keyed) = evaluate(&[]);
    assert!(table.starts_with("SIMULATED: computed, not measured\n") && keyed, "{table}");
    assert!(page.contains("<b>SIMULATED</b>"));
    assert_eq!(json["records"][24]["synthetic"], "computed, not measured; seed 1");
    fs::remove_dir_all(folder).unwrap();
}

/// `mu_s` comes before `mu` in JSON, table and report.
#[test]
fn mu_s_stands_before_mu() {
    let folder = folder("order");
    let run = |options: &[&str]| {
        let output = floe(&folder, &[&["campaign"], options].concat());
        String::from_utf8(output.stdout).unwrap()
    };
    let page = run(&["--report", "c.html"]) + &fs::read_to_string(folder.join("c.html")).unwrap();
    let json = run(&["--json"]);
    let place = |text: &str, word: &str| text.find(word).unwrap_or_else(|| panic!("no {word}"));
    for (text, first, second) in [
        (&json, "\"mu_s\":", "\"mu\":"),
        (&json, "\"published_mu_s\"", "\"published_mu\""),
        (&json, "\"coefficient\": \"mu_s\"", "\"coefficient\": \"mu\""),
        (&page, "events  mu_s  ", "  mu\n"),
        (&page, "0.76  0.51\n", "1.0  0.62\n"),
        (&page, "mu_s against", "mu against"),
        (&page, "<th><i>μ</i><sub>s</sub></th><th>", "<th><i>μ</i></th><th>"),
        (&page, "Static coefficient", "<th><i>μ</i><sub>s</sub></th><th><i>μ</i></th></tr>"),
    ] {
        assert!(place(text, first) < place(text, second), "{first} is not before {second}");
    }
    fs::remove_dir_all(folder).unwrap();
}

/// A block on a bench weighs less than a newton; one test gives no trend.
#[test]
fn one_small_test_is_read_with_its_own_digits() {
    let folder = folder("small");
    let log = include_str!("../logs/dff8-13.csv");
    let small = |line: &str| match line.split_once(',').map(|(t, f)| (t, f.parse::<f64>())) {
        Some((time_s, Ok(force_n))) => format!("{time_s},{}\n", force_n * 1e-3),
        _ => format!("{line}\n"),
    };
    let log: String = log.replace("weight_n: 630", "weight_n: 0.63").lines().map(small).collect();
    fs::write(folder.join("small.csv"), log).unwrap();
    let output = floe(&folder, &["campaign", ".", "--report", "c.html"]);
    let said = String::from_utf8(output.stdout).unwrap();
    let page = fs::read_to_string(folder.join("c.html")).unwrap();
    assert!(said.contains(" 0.6300   15.7 ") && page.contains("<td>0.6300</td>"), "{said}");
    assert!(page.contains("<h1>1 test, "), "{page}");
    assert!(!page.contains("Slope") && !page.contains("least squares, ±"), "{page}");
    fs::remove_dir_all(folder).unwrap();
}

/// A long name widens its column; two equal tests have no scatter and give no trend.
#[test]
fn columns_stand_below_their_heads() {
    let folder = folder("columns");
    let log = include_str!("../logs/dff8-13.csv");
    for name in ["DFF8-13, the second pull of the day", "b"] {
        let log = log.replace("# test_id: DFF8-13", &format!("# test_id: {name}"));
        fs::write(folder.join(format!("{}.csv", name.len())), log).unwrap();
    }
    let output = floe(&folder, &["campaign", "."]);
    let said = String::from_utf8(output.stdout).unwrap();
    // Below the line with SIMULATED.
    let lines: Vec<&str> = said.lines().skip(2).collect();
    let end = lines[0].find("weight").unwrap() + "weight".len();
    for row in &lines[2..4] {
        assert!(row[..end].ends_with(" 630.0") && row[end..].starts_with(' '), "{said}");
    }
    let all = said.lines().find(|line| line.starts_with("all "));
    assert!(all.is_some_and(|all| !all.contains('±')) && !said.contains("trend"), "{said}");
    fs::remove_dir_all(folder).unwrap();
}
