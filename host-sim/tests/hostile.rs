//! Malicious names, texts and paths, and outputs that would overwrite an input.
#![cfg(unix)]

use std::fs;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use floe_core::Counts;
use floe_firmware::adc::Input;
use floe_firmware::record::{Part, Record};
use floe_firmware::sample::Sample;

#[path = "support/command.rs"]
mod command;
use command::{assert_refused, directory, text};
#[path = "support/sector.rs"]
mod sector;
use sector::seal;

fn floe(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    command.current_dir(directory).args(arguments).output().unwrap()
}

/// Asserts that neither output has control characters for a terminal.
fn assert_clean(output: &Output) {
    for bytes in [&output.stdout, &output.stderr] {
        let said = text(bytes);
        let bad = said.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
        assert_eq!(bad, None, "{said:?}");
    }
}

fn ramp(head: &str) -> String {
    let row = |i: u32| format!("{},{}\n", f64::from(i) / 16.0, 100.0 + f64::from(i) * 0.25);
    format!("{head}time_s,force_n\n{}", (0..60).map(row).collect::<String>())
}

/// A card's log of one test with this name in its field and a valid checksum.
fn card(name: &[u8], version: u8) -> Vec<u8> {
    let sample = |index| Sample {
        index,
        stamp: 62_500 * index,
        input: Input::Bridge,
        reading: Ok(Counts(1000)),
    };
    let mut record = Record {
        part: Part { id: Some(1), run: 1, ..Part::default() },
        clock_hz: 1_000_000,
        samples: (0..8).map(sample).collect(),
        ..Record::default()
    };
    record.settings.config.weight_n = 630.0;
    let mut sector = record.encode();
    sector[4] = version;
    sector[68..84].fill(0);
    sector[68..68 + name.len()].copy_from_slice(name);
    seal(&mut sector);
    sector.to_vec()
}

#[test]
fn no_name_on_a_card_leads_out_of_the_folder() {
    let dir = directory("recover");
    fs::write(dir.join("good.log"), card(b"A", 2)).unwrap();
    let done = floe(&dir, &["recover", "good.log", "-o", "good"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(dir.join("good/test-0001-A.csv").is_file());
    let names: [&[u8]; 9] = [
        b"a/b",
        b"../../x",
        b"/etc/passwd",
        b"a\0b",
        b"a\nb",
        b"\x1b[31m",
        b"a\\b",
        b"\xFF\xFE",
        b"a:b",
    ];
    for name in names {
        for version in [1, 2] {
            let out = dir.join("out");
            fs::write(dir.join("bad.log"), card(name, version)).unwrap();
            let refused = floe(&dir, &["recover", "bad.log", "-o", "out", "--toa5"]);
            assert_refused(&refused, &["holds no record"]);
            assert_clean(&refused);
            assert!(!out.exists() || fs::read_dir(&out).unwrap().count() == 0);
        }
    }
    let mut here: Vec<_> = fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name()).collect();
    here.sort();
    assert_eq!(here, ["bad.log", "good", "good.log"]);
}

/// A device that gives zeros for ever is refused as a card, a scene, a list and a log.
#[test]
fn what_never_ends_is_refused() {
    for (arguments, why) in [
        (["recover", "/dev/zero", "-o", "tests"], "holds no record of a floe logger"),
        (["simulate", "/dev/zero", "-o", "log.csv"], "longer than 16 MiB"),
        (["campaign", "/dev/zero", "--json", "tests.json"], "longer than 16 MiB"),
        (["replay", "/dev/zero", "--json", "test.json"], "is a binary file"),
    ] {
        let directory = directory("endless");
        let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
        let mut child =
            command.args(arguments).current_dir(&directory).stderr(Stdio::piped()).spawn().unwrap();
        let begin = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if begin.elapsed() > Duration::from_secs(20) {
                child.kill().unwrap();
                panic!("{arguments:?}: still reading");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_refused(&child.wait_with_output().unwrap(), &["/dev/zero: ", why]);
        assert_eq!(fs::read_dir(&directory).unwrap().count(), 0, "{arguments:?}");
    }
}

#[test]
fn links_in_the_output_folder_are_not_followed() {
    let dir = directory("links");
    fs::write(dir.join("card.log"), card(b"A", 2)).unwrap();
    fs::create_dir(dir.join("out")).unwrap();
    symlink(dir.join("victim"), dir.join("out/test-0001-A.csv")).unwrap();
    let refused = floe(&dir, &["recover", "card.log", "-o", "out"]);
    assert_refused(&refused, &["test-0001-A.csv", "is there already"]);
    assert!(!dir.join("victim").exists());
    // A link without a target is replaced by the new file.
    fs::write(dir.join("log.csv"), ramp("")).unwrap();
    symlink(dir.join("victim"), dir.join("result.json")).unwrap();
    let done = floe(&dir, &["replay", "log.csv", "--weight-n", "9", "--json", "result.json"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(!dir.join("victim").exists() && dir.join("result.json").is_file());
}

#[test]
fn no_text_of_a_log_commands_a_terminal() {
    let dir = directory("escapes");
    let id = "x\u{1b}]0;owned\u{7}\u{9b}2J\u{202e}y";
    fs::write(dir.join("log.csv"), ramp(&format!("# test_id: {id}\n"))).unwrap();
    let name = "a\u{1b}[2J\nb.csv";
    fs::copy(dir.join("log.csv"), dir.join(name)).unwrap();
    for log in ["log.csv", name] {
        for more in [&[][..], &["--json"], &["--weight-n", "-1"], &["--column", "\u{1b}[1m"]] {
            let arguments = [&["replay", log, "--weight-n", "100"][..2], more].concat();
            assert_clean(&floe(&dir, &arguments));
        }
        let shown = floe(&dir, &["replay", log, "--weight-n", "100"]);
        assert_eq!(shown.status.code(), Some(0));
        assert_clean(&shown);
    }
    let told = floe(&dir, &["replay", "log.csv", "--weight-n", "100", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(json["test"]["test_id"], id);
    for bad in ["time_s,force_n\n0,\u{1b}[1m\n", "\u{1b}[2J\n", "a,\u{1b}b\n1,2\n"] {
        fs::write(dir.join("bad.csv"), bad).unwrap();
        let refused = floe(&dir, &["replay", "bad.csv", "--weight-n", "100"]);
        assert_refused(&refused, &["bad.csv"]);
        assert_clean(&refused);
    }
    let refused = floe(&dir, &["replay", "\u{1b}[31m\n.csv", "--weight-n", "1"]);
    assert_refused(&refused, &["no such file"]);
    assert_clean(&refused);
    fs::write(dir.join("list\u{1b}.txt"), "no\u{1b}such.csv\n").unwrap();
    let refused = floe(&dir, &["campaign", "list\u{1b}.txt"]);
    assert_clean(&refused);
}

#[test]
fn the_report_runs_no_script_but_its_own() {
    let dir = directory("report");
    let id = "<script>alert(1)</script><img src=x onerror=alert(2)>";
    fs::write(dir.join("log.csv"), ramp(&format!("# test_id: {id}\n# weight_n: 100\n"))).unwrap();
    let done = floe(&dir, &["replay", "log.csv", "--report", "page.html"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let page = fs::read_to_string(dir.join("page.html")).unwrap();
    assert!(page.contains("default-src 'none'"), "no policy");
    assert_eq!(page.matches("<script>").count(), 1);
    assert!(!page.contains("<img"));
}

#[test]
fn an_input_is_never_an_output() {
    let dir = directory("outputs");
    fs::write(dir.join("log.csv"), ramp("# weight_n: 100\n")).unwrap();
    fs::write(dir.join("list.txt"), "log.csv\n").unwrap();
    fs::hard_link(dir.join("log.csv"), dir.join("hard.csv")).unwrap();
    symlink("log.csv", dir.join("soft.csv")).unwrap();
    fs::create_dir(dir.join("sub")).unwrap();
    let already = &["already"];
    for output in ["log.csv", "hard.csv", "soft.csv", "sub/../log.csv", "./log.csv"] {
        for option in ["--json", "--events", "--report"] {
            assert_refused(&floe(&dir, &["replay", "log.csv", option, output]), already);
        }
        assert_refused(&floe(&dir, &["campaign", "list.txt", "--json", output]), already);
        assert_refused(&floe(&dir, &["campaign", "list.txt", "--parquet", output]), already);
    }
    assert_refused(&floe(&dir, &["campaign", "list.txt", "--json", "list.txt"]), already);
    assert_refused(&floe(&dir, &["campaign", "list.txt", "--report", "sub/../list.txt"]), already);
    let two = ["replay", "log.csv", "--json", "new", "--events", "sub/../new"];
    assert_refused(&floe(&dir, &two), already);
    // Standard input may be the log itself.
    let fed = Command::new(env!("CARGO_BIN_EXE_floe"))
        .current_dir(&dir)
        .args(["replay", "-", "--json", "log.csv"])
        .stdin(fs::File::open(dir.join("log.csv")).unwrap())
        .output()
        .unwrap();
    assert_refused(&fed, already);
    assert_eq!(fs::read_to_string(dir.join("list.txt")).unwrap(), "log.csv\n");
    assert_eq!(fs::read_to_string(dir.join("log.csv")).unwrap(), ramp("# weight_n: 100\n"));
    assert!(!dir.join("new").exists());
}

#[test]
fn what_is_replaced_is_said_and_keeps_its_mode() {
    let dir = directory("replaced");
    fs::write(dir.join("log.csv"), ramp("# weight_n: 100\n")).unwrap();
    let result = dir.join("result.json");
    fs::write(&result, "{\n  \"schema\": \"floe-replay/2\"").unwrap();
    fs::set_permissions(&result, fs::Permissions::from_mode(0o640)).unwrap();
    let run = |more: &[&str]| {
        floe(&dir, &[&["replay", "log.csv", "--json", "result.json"], more].concat())
    };
    let said = text(&run(&[]).stderr);
    assert_eq!(said, "floe: result.json: the file that was there has been replaced\n");
    assert_eq!(fs::metadata(&result).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(fs::read_to_string(&result).unwrap().starts_with("{"));
    assert_eq!(text(&run(&["--quiet"]).stderr), "");
}

#[test]
fn a_signal_leaves_no_half_file() {
    let dir = directory("signal");
    let scene = "weight_n = 630\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000\n\
                 winch_m_per_s = 0.0157\nduration_s = 3e6\n";
    fs::write(dir.join("scene.toml"), scene).unwrap();
    fs::write(dir.join("log.csv"), "# SYNTHETIC: old").unwrap();
    for signal in ["-INT", "-TERM"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
            .current_dir(&dir)
            .args(["simulate", "scene.toml", "-o", "log.csv"])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let unfinished = || {
            let names = fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name());
            names.filter(|name| name.to_string_lossy().ends_with(".part")).count()
        };
        let start = Instant::now();
        while unfinished() == 0 && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_eq!(unfinished(), 1);
        let pid = child.id().to_string();
        assert!(Command::new("kill").args([signal, &pid]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(unfinished(), 0);
        assert_eq!(fs::read_to_string(dir.join("log.csv")).unwrap(), "# SYNTHETIC: old");
    }
}

#[test]
fn impossible_scenes_end_in_a_line() {
    let dir = directory("scenes");
    let with = |line: &str| {
        let key = line.split(' ').next().unwrap();
        let base = "weight_n = 630\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000\n\
                    winch_m_per_s = 0.0157\nduration_s = 10\n";
        let rest = base.lines().filter(|l| !l.starts_with(&format!("{key} =")));
        rest.collect::<Vec<_>>().join("\n") + "\n" + line + "\n"
    };
    for line in [
        "stiffness_n_per_m = 1e18",
        "duration_s = 1e308",
        "duration_s = 99999999",
        "duration_s = inf",
        "weight_n = 1e-300",
        "weight_n = 1e300",
        "winch_m_per_s = 1e9",
        "mu_s = 1e30",
        "cable_length_m = 1e30",
        "rate_hz = 1e30",
        "start_force_n = 1e30",
        "measurement.flop = { amplitude_n = 1, hz = 1e9, decay_per_s = 1 }",
    ] {
        let scene =
            with(line).replace("duration_s = 99999999", "duration_s = 99999999\nrate_hz = 2000");
        fs::write(dir.join("scene.toml"), scene).unwrap();
        let start = Instant::now();
        let refused = floe(&dir, &["simulate", "scene.toml", "-o", "log.csv"]);
        assert_refused(&refused, &["scene.toml", line.split(' ').next().unwrap()]);
        assert!(start.elapsed() < Duration::from_secs(10), "{line}");
    }
    assert!(!dir.join("log.csv").exists());
}

/// Megabytes of noise, faster than they are processed: damaged lines are counted and the memory
/// stays constant.
#[test]
fn a_flood_is_counted_and_costs_no_memory() {
    let dir = directory("flood");
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().to_string();
    let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
        .current_dir(&dir)
        .args(["live", &port, "-o", "kept.txt"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut board, _) = listener.accept().unwrap();
    let noise: Vec<u8> =
        (0..1_u32 << 16).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let high_water = |pid: u32| {
        let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0)
    };
    let mut sent = 0;
    let mut early = 0;
    while sent < 64 << 20 {
        board.write_all(&noise).unwrap();
        sent += noise.len();
        if sent == 8 << 20 {
            early = high_water(child.id());
        }
    }
    let late = high_water(child.id());
    println!("64 MiB of noise: {early} kB at most after 8 MiB, {late} kB after all");
    assert!(early > 0 || !cfg!(target_os = "linux"), "the memory in use is not known");
    assert!(late < early + 4096, "{early} kB became {late} kB");
    child.kill().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    child.wait().unwrap();
    assert!(said.contains("damaged lines so far"), "{said}");
    // The kept file is text without control characters.
    let kept = fs::read(dir.join("kept.txt")).unwrap();
    let bad = String::from_utf8_lossy(&kept).chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(bad, None);
}
