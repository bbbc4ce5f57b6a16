//! `floe weigh` as a command.

use std::path::PathBuf;
use std::process::{Command, Output};

fn floe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floe")).args(arguments).output().expect("floe runs")
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("weigh-{name}"))
}

/// A log of forces at 16 Hz.
fn log(name: &str, seconds: u32, force_n: impl Fn(f64) -> f64) -> String {
    let rows = (0..16 * seconds).map(|i| (f64::from(i) / 16.0, i));
    let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65_536.0 - 0.5;
    let rows = rows.map(|(t, i)| format!("{t},{:.4}\n", force_n(t) + noise(i)));
    let path = file(name);
    std::fs::write(&path, format!("time_s,force_n\n{}", rows.collect::<String>())).expect("kept");
    path.display().to_string()
}

/// 630 N that swings by 5 degrees with a period of 2 s.
fn swinging(t: f64) -> f64 {
    let amplitude = 5.0_f64.to_radians();
    let angle = amplitude * (std::f64::consts::PI * t).cos();
    630.0 * (3.0 * angle.cos() - 2.0 * amplitude.cos())
}

#[test]
fn a_recording_is_weighed() {
    let path = log("swings.csv", 40, swinging);
    let output = floe(&["weigh", &path, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["schema"], "floe-weigh/1");
    let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("{key}: {json}"));
    assert!((number("weight_n") - 630.0).abs() < 0.06, "{json}");
    assert!((0.001..0.05).contains(&number("weight_std_n")), "{json}");
    assert!((number("swing_period_s") - 2.0).abs() < 0.01, "{json}");
    assert!((number("swing_amplitude_rad") - 0.0873).abs() < 0.002, "{json}");
    assert!((number("excess_n") - 1.2).abs() < 0.05, "{json}");
    let text = String::from_utf8(floe(&["weigh", &path]).stdout).expect("text");
    assert!(text.contains("2.00 s, 5.0°; 1.20 N of excess"), "{text}");
}

/// A row that stands twice is no second reading: it would make the swing slower.
#[test]
fn a_repeated_row_counts_once() {
    let path = log("once.csv", 40, swinging);
    let text = std::fs::read_to_string(&path).expect("kept");
    let twice = file("twice.csv").display().to_string();
    let repeated = |(at, line): (usize, &str)| format!("{line}\n").repeat(1 + at % 7 / 6);
    std::fs::write(&twice, text.lines().enumerate().map(repeated).collect::<String>())
        .expect("kept");
    let json = |path: &str| floe(&["weigh", path, "--json"]).stdout;
    assert_eq!(String::from_utf8_lossy(&json(&twice)), String::from_utf8_lossy(&json(&path)));
}

#[test]
fn a_computed_recording_is_said() {
    let path = log("measured.csv", 20, |_| 98.1);
    let text = |path: &str| String::from_utf8(floe(&["weigh", path]).stdout).expect("text");
    assert!(text(&path).starts_with("weight "), "{}", text(&path));
    let computed = file("computed.csv").display().to_string();
    let log = std::fs::read_to_string(&path).expect("kept");
    std::fs::write(&computed, format!("# SYNTHETIC: computed\n{log}")).expect("kept");
    assert!(text(&computed).starts_with("SIMULATED     computed\nweight "), "{}", text(&computed));
    for (path, said) in [(path, serde_json::Value::Null), (computed, "computed".into())] {
        let output = floe(&["weigh", &path, "--json"]).stdout;
        let json: serde_json::Value = serde_json::from_slice(&output).expect("JSON");
        assert_eq!(json["synthetic"], said);
    }
}

#[test]
fn a_still_block_has_no_swing() {
    let path = log("still.csv", 20, |_| 98.1);
    let output = floe(&["weigh", &path, "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(json["swing_period_s"].is_null() && json["swing_amplitude_rad"].is_null(), "{json}");
    assert!((json["weight_n"].as_f64().expect("a number") - 98.1).abs() < 0.1, "{json}");
}

/// Pseudorandom noise, uniform within ±2 N.
fn rough(t: f64) -> f64 {
    4.0 * ((t * 207.8368).sin() * 43_758.545_3).rem_euclid(1.0) - 2.0
}

#[test]
fn a_weight_is_never_exact() {
    let path = log("heavy.csv", 40, |t| 1e7 + rough(t));
    let text = String::from_utf8(floe(&["weigh", &path]).stdout).expect("text");
    assert!(text.contains(" ± 0.") && text.starts_with("weight        1000000"), "{text}");
}

#[test]
fn a_reading_far_from_all_others_is_left_out_and_said() {
    let spiked = |t: f64| if (t - 18.75).abs() < 0.01 { 9999.0 } else { 630.0 };
    let path = log("spike.csv", 40, spiked);
    let json: serde_json::Value =
        serde_json::from_slice(&floe(&["weigh", &path, "--json"]).stdout).expect("JSON");
    assert!((json["weight_n"].as_f64().expect("a number") - 630.0).abs() < 0.1, "{json}");
    assert!(json["weight_std_n"].as_f64().expect("a number") < 0.1, "{json}");
    assert_eq!(json["left_out"][0]["time_s"], 18.75, "{json}");
    let text = String::from_utf8(floe(&["weigh", &path]).stdout).expect("text");
    assert!(text.contains("left out      1 reading far from all others: 999"), "{text}");
    assert!(text.contains(" N at 18.750 s\n"), "{text}");
    let clean = log("no-spike.csv", 40, |_| 630.0);
    let text = String::from_utf8(floe(&["weigh", &clean]).stdout).expect("text");
    assert!(!text.contains("left out"), "{text}");
}

/// 634 N with little noise in steps of 10 N: the mean is off by newtons, whatever the length.
#[test]
fn the_step_of_the_readings_is_in_the_standard_deviation() {
    let fine = log("fine.csv", 40, |_| 634.0);
    let fine = std::fs::read_to_string(fine).expect("kept");
    let weighed = |name: &str, step_n: f64, noise: f64| {
        let rounded = |line: &str| match line.split_once(',').map(|(t, f)| (t, f.parse::<f64>())) {
            Some((time_s, Ok(force_n))) => {
                let force_n = 634.0 + noise * (force_n - 634.0);
                format!("{time_s},{}\n", (force_n / step_n).round() * step_n)
            }
            _ => format!("{line}\n"),
        };
        let path = file(name);
        std::fs::write(&path, fine.lines().map(rounded).collect::<String>()).expect("kept");
        floe(&["weigh", path.to_str().expect("a name"), "--json"])
    };
    let result = |output: Output| {
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        ["weight_n", "weight_std_n"].map(|key| json[key].as_f64().expect("a number"))
    };
    let [weight_n, std_n] = result(weighed("coarse.csv", 10.0, 3.0));
    assert!(
        (weight_n - 634.0).abs() < 2.0 * std_n && (2.8..3.2).contains(&std_n),
        "{weight_n} {std_n}"
    );
    let [weight_n, std_n] = result(weighed("dithered.csv", 10.0, 60.0));
    assert!((weight_n - 634.0).abs() < 3.0 * std_n && std_n < 1.5, "{weight_n} {std_n}");
    let refused = weighed("constant.csv", 20.0, 1.0);
    let said = String::from_utf8(refused.stderr).expect("text");
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("every reading is 640 N") && said.contains("--weight-std-n"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

/// The zero in the log is subtracted, as in a replay.
#[test]
fn a_zero_in_the_log_is_taken_off() {
    let plain = std::fs::read_to_string(log("zero.csv", 40, |t| 50.0 + swinging(t))).expect("kept");
    let path = file("zeros.csv").display().to_string();
    let weighed = |head: &str| {
        std::fs::write(&path, format!("{head}{plain}")).expect("kept");
        let output = floe(&["weigh", &path, "--json"]);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        ["weight_n", "zero_n", "swing_amplitude_rad"].map(|key| json[key].as_f64().expect(key))
    };
    let [weight_n, zero_n, amplitude_rad] = weighed("# zero_before_n: 50\n");
    assert!((weight_n - 630.0).abs() < 0.06 && (zero_n - 50.0).abs() < 1e-9, "{weight_n} {zero_n}");
    assert!((amplitude_rad - 0.0873).abs() < 0.002, "{amplitude_rad}");
    let text = String::from_utf8(floe(&["weigh", &path]).stdout).expect("text");
    assert!(text.contains("zero          50.00 N taken off"), "{text}");
    let [_, between_n, _] = weighed("# zero_before_n: 49\n# zero_after_n: 51\n");
    assert!((between_n - 50.0).abs() < 0.01, "{between_n}");
    std::fs::write(&path, format!("# zero_before_n: 1e300\n{plain}")).expect("kept");
    assert_eq!(floe(&["weigh", &path]).status.code(), Some(2));
}

/// Saturated readings give no weight; a few of them are left out and reported.
/// An option replaces what the log says, also where the log contradicts itself.
#[test]
fn a_rate_that_is_given_settles_what_the_log_says() {
    let path = file("two_rates.csv");
    let head = "# rate_hz: 16\n# rate_hz: 17\n";
    let rows = std::fs::read_to_string(log("rate.csv", 60, swinging)).unwrap();
    std::fs::write(&path, head.to_string() + &rows).unwrap();
    let name = path.to_str().unwrap();
    for command in ["weigh", "inspect"] {
        let run = |options: &[&str]| {
            let mut floe = Command::new(env!("CARGO_BIN_EXE_floe"));
            floe.args([command, name]).args(options).output().unwrap().status.code()
        };
        assert_eq!((run(&[]), run(&["--rate-hz", "16"])), (Some(2), Some(0)), "{command}");
    }
}

#[test]
fn saturated_readings_are_counted() {
    let heavy = std::fs::read_to_string(log("heavy.csv", 20, |_| 630.0)).expect("kept");
    let spiked = |t: f64| if (t - 18.75).abs() < 0.01 { 9999.0 } else { 630.0 };
    let spiked = std::fs::read_to_string(log("over.csv", 20, spiked)).expect("kept");
    let path = file("range.csv").display().to_string();
    std::fs::write(&path, format!("# range_n: 600\n{heavy}")).expect("kept");
    let refused = floe(&["weigh", &path]);
    let said = String::from_utf8(refused.stderr).expect("text");
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("320 of the last 320 readings") && said.contains("range_n"), "{said}");
    std::fs::write(&path, format!("# range_n: 5000\n{spiked}")).expect("kept");
    let text = String::from_utf8(floe(&["weigh", &path]).stdout).expect("text");
    assert!(text.contains("saturated     1 reading\n"), "{text}");
}

#[test]
fn what_is_no_weighing_is_refused_in_one_line() {
    let drift = log("drift.csv", 40, |t| 630.0 + 0.2 * t);
    let short = log("short.csv", 5, |_| 630.0);
    let empty = log("empty.csv", 40, |_| 0.0);
    let below = log("below.csv", 40, |_| -630.0);
    let pulled = log("pulled.csv", 40, |t| 200.0 + 300.0 * (t % 2.0));
    for (path, words) in [
        (drift, "drifts by 0.2"),
        (short, "only 5.0 s"),
        (empty, "nothing hangs there"),
        (below, "below zero"),
        (pulled, "no rest"),
        (file("missing.csv").display().to_string(), "no such file"),
    ] {
        let output = floe(&["weigh", &path]);
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words) && said.lines().count() == 1, "{said}");
    }
}

/// A wrong assumption about the log changes the weight by a factor of two or a thousand.
#[test]
fn what_is_assumed_is_said() {
    let path = file("assumed.csv").display().to_string();
    let said = |arguments: &[&str]| {
        let output = floe(&[&["weigh", &path], arguments].concat());
        String::from_utf8(output.stderr).expect("text")
    };
    std::fs::write(&path, counts("time_s,Load", 0.01)).expect("kept");
    assert!(said(&[]).contains("column 'Load' has no unit: taken as N"), "{}", said(&[]));
    let calibrated = "# tare_counts: 0\n# counts_per_n: 1000\ntime_s,counts";
    std::fs::write(&path, counts(calibrated, 1.0)).expect("kept");
    assert_eq!(said(&[]), "");
    let other = said(&["--counts-per-n", "2000"]);
    assert!(other.contains("not the '# counts_per_n: 1000' of line 2"), "{other}");
    let none = said(&["--counts-per-n", "0"]);
    assert!(none.contains("counts_per_n is 0") && none.lines().count() == 1, "{none}");
}

/// About 630 000 codes times `scale`.
fn counts(head: &str, scale: f64) -> String {
    let noise = |i: u32| i.wrapping_mul(2_654_435_761) >> 24;
    let row =
        |i: u32| format!("{},{}\n", f64::from(i) / 16.0, f64::from(630_000 + noise(i)) * scale);
    format!("{head}\n{}", (0..640).map(row).collect::<String>())
}

/// One sample per second does not show a swing of 2 s, whose force oscillates with a period of 1 s.
#[test]
fn a_log_too_slow_for_a_swing_is_refused() {
    let path = file("slow.csv");
    let row = |t: u32| format!("{t},{}\n", swinging(f64::from(t)) + f64::from(t % 3));
    let rows: String = (0..100).map(row).collect();
    std::fs::write(&path, format!("time_s,force_n\n{rows}")).expect("kept");
    let output = floe(&["weigh", path.to_str().expect("a path")]);
    let said = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("1 samples a second do not show whether the block swings"), "{said}");
}
