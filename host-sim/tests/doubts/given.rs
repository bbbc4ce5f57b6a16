//! Numbers of the caller that differ from those of the log, and lines of a log without effect.

use std::fs;

use super::{assert_refused, directory, floe, json_with_warnings, text};

const CALIBRATED: &str = "# tare_counts: 8000; # counts_per_n: 800; # weight_n: 630";

/// The warnings about a log in counts with these lines as its head.
fn asked(test: &str, head: &str, arguments: &[&str]) -> String {
    let path = directory(test).join("counts.csv");
    let path = path.to_str().unwrap();
    let rows = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let counts = |row: &str| {
        let (time_s, force_n) = row.split_once(',')?;
        Some(format!("{time_s},{:.0}\n", 800.0 * force_n.parse::<f64>().ok()? + 8000.0))
    };
    let (head, rows) = (head.replace("; ", "\n"), rows.lines().filter_map(counts));
    fs::write(path, format!("{head}\ntime_s,counts\n{}", rows.collect::<String>())).unwrap();
    json_with_warnings(&floe(&[&["replay", path, "--json"], arguments].concat()))
}

/// The caller's number is used, and both are reported.
#[test]
fn what_is_given_against_the_log_is_said() {
    let said = |head: &str, arguments: &[&str]| asked("given", head, arguments);
    assert_eq!(said(CALIBRATED, &["--weight-n", "630", "--counts-per-n", "800"]), "[]");
    let more = format!("{CALIBRATED}; # slope_deg: 3; # range_n: 5000; # winch_m_per_s: 0.0157");
    for (option, number, expected) in [
        (
            "--counts-per-n",
            "400.5",
            "span 400.5 counts/N as given, not the '# counts_per_n: 800' of line 2",
        ),
        ("--tare-counts", "7", "tare 7 counts as given, not the '# tare_counts: 8000' of line 1"),
        ("--mass-kg", "70", "weight 686.5 N as given, not the '# weight_n: 630' of line 3"),
        ("--slope-deg", "0", "slope 0.00° as given, not the '# slope_deg: 3' of line 4"),
        ("--range-n", "4000", "range 4000 N as given, not the '# range_n: 5000' of line 5"),
        (
            "--winch-m-per-s",
            "0.0156",
            "winch at 0.0156 m/s as given, not the '# winch_m_per_s: 0.0157' of line 6",
        ),
    ] {
        let asked = said(&more, &[option, number]);
        assert!(asked.contains(expected), "{option}: {asked}");
    }
}

#[test]
fn how_well_it_is_known_against_the_log_is_said() {
    let known =
        "# weight_std_n: 2; # zero_before_n: 1.5; # span_std_percent: 1; # weight_from: other";
    let options = ["--weight-std-n", "3", "--zero-before-n", "2.5", "--span-std", "1"];
    let options = [&options[..], &["--weight-from", "same_cell"]].concat();
    let asked = asked("known", &format!("{CALIBRATED}; {known}"), &options);
    for expected in [
        "weight_std_n 3 as given, not the '# weight_std_n: 2' of line 4",
        "zero_before_n 2.5 as given, not the '# zero_before_n: 1.5' of line 5",
        "weight_from same_cell as given, not the '# weight_from: other' of line 7",
    ] {
        assert!(asked.contains(expected), "{asked}");
    }
    assert!(!asked.contains("span"), "{asked}");
}

#[test]
fn how_well_a_speed_is_known_that_nobody_says_is_said() {
    let std = ["--winch-std-m-per-s", "0.0001"];
    let without = "winch_std_m_per_s is not used without the speed of the winch";
    assert!(asked("no-winch", CALIBRATED, &std).contains(without));
    let head = format!("{CALIBRATED}; # winch_m_per_s: 0.0157");
    assert!(!asked("winch", &head, &std).contains(without));
}

/// The weight of a block under the ice is not the normal force.
#[test]
fn weight_and_mass_are_told_apart() {
    let said = |head: &str, arguments: &[&str]| asked("mass", head, arguments);
    let massive = "# tare_counts: 8000; # counts_per_n: 800; # mass_kg: 70";
    let asked = said(massive, &["--weight-n", "630"]);
    let expected = "weight 630.0 N as given, not the '# mass_kg: 70' of line 3";
    assert!(asked.contains(expected), "{asked}");
    let below = ["--normal-n", "600", "--mass-kg", "64.242"];
    assert_eq!(said(CALIBRATED, &below), "[]");
    let asked = said(&format!("{massive}; # normal_n: 500"), &below);
    assert!(asked.contains("normal force 600.0 N as given, not the '# normal_n: 500' of line 4"));
    assert!(asked.contains("mass 64.2 kg as given, not the '# mass_kg: 70' of line 3"), "{asked}");
}

/// Metadata after the first 4096 samples come too late for the computation.
#[test]
fn what_comes_too_late_is_said_and_not_called_given() {
    let path = directory("late").join("log.csv");
    let row = |i: u32| format!("{},{}\n", f64::from(i) / 16.0, 100 + i % 50);
    let (first, last): (String, String) =
        ((0..4200).map(row).collect(), (4200..4300).map(row).collect());
    let late = "# slope_deg: 5\n# zero_before_n: 50\n";
    fs::write(&path, format!("# weight_n: 630\ntime_s,force_n\n{first}{late}{last}")).unwrap();
    let said = json_with_warnings(&floe(&["replay", path.to_str().unwrap(), "--json"]));
    assert!(said.contains("line 4203: '# slope_deg: 5' comes too late and is not used"), "{said}");
    assert!(said.contains("'# zero_before_n: 50' comes too late"), "{said}");
    assert!(!said.contains("as given"), "{said}");
}

/// A number out of range is reported with its line, unless another number replaces it.
#[test]
fn what_the_log_says_and_cannot_be_is_refused_by_its_line() {
    let path = directory("said").join("pull.csv");
    let path = path.to_str().unwrap();
    for (key, value, option) in [
        ("weight_n", "-3", "--weight-n"),
        ("mass_kg", "0", "--mass-kg"),
        ("normal_n", "-1", "--normal-n"),
        ("slope_deg", "89", "--slope-deg"),
        ("winch_m_per_s", "-1", "--winch-m-per-s"),
        ("range_n", "0", "--range-n"),
        ("weight_std_n", "-3", "--weight-std-n"),
        ("span_std_percent", "-3", "--span-std"),
        ("damping_std", "5", "--damping-std"),
        ("zero_after_n", "1e300", "--zero-after-n"),
    ] {
        let rows = "time_s,force_n\n0,1\n0.0625,2\n0.125,3\n";
        fs::write(path, format!("# test_id: A\n# {key}: {value}\n{rows}")).unwrap();
        let named = format!("pull.csv: line 2: '# {key}:' must be a number ");
        let remedy = format!(", not {value}: correct it, or give {option}");
        assert_refused(&floe(&["replay", path]), &[&named, &remedy]);
        let number = if option == "--damping-std" { "0.1" } else { "1" };
        let given = floe(&["replay", path, option, number]);
        assert!(!text(&given.stderr).contains("must be"), "{}", text(&given.stderr));
    }
    // A number that the caller's weight replaces is not checked.
    fs::write(path, "# weight_n: -3\ntime_s,force_n\n0,1\n0.0625,2\n").unwrap();
    let given = floe(&["replay", path, "--mass-kg", "64.2", "--quiet"]);
    assert_eq!(given.status.code(), Some(0), "{}", text(&given.stderr));
}

/// A missing weight is reported with a line that looks like a misspelt weight.
#[test]
fn a_weight_that_is_not_read_is_named() {
    let path = directory("meant").join("pull.csv");
    let path = path.to_str().unwrap();
    fs::write(path, "# weight_n=630\ntime_s,force_n\n0,1\n0.0625,2\n").unwrap();
    let missing =
        "weight is not known: line 1: 'weight_n=630' is not read: write '# weight_n: 630'";
    assert_refused(&floe(&["replay", path]), &[missing]);
}

/// A log that gives two weights is refused, unless the command gives the weight.
#[test]
fn an_option_settles_a_contradiction_of_the_log() {
    let path = directory("settled").join("two.csv");
    let path = path.to_str().unwrap();
    let log = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let (weight, rest) = log.split_once("\ntime_s,force_n\n").unwrap();
    let head = weight.lines().filter(|line| !line.contains("weight_n")).collect::<Vec<_>>();
    let two = format!("# weight_n: 630\n# weight_n: 700\n{}", head.join("\n"));
    fs::write(path, format!("{two}\ntime_s,force_n\n{rest}")).unwrap();
    let both = ["'# weight_n:' says '700'", "line 1 says otherwise", "line 2:"];
    assert_refused(&floe(&["replay", path]), &both);
    assert_refused(&floe(&["replay", path, "--slope-deg", "0"]), &both);
    for weight in [["--weight-n", "630"], ["--mass-kg", "64.242"]] {
        let said = json_with_warnings(&floe(&["replay", path, "--json", weight[0], weight[1]]));
        assert!(said.contains("line 2: '# weight_n:' says '700', and line 1 says other"), "{said}");
        assert!(!said.contains("as given"), "{said}");
    }
}

/// A rest before the pull and one after it show the zero of the cell, where nobody states one.
#[test]
fn a_zero_that_the_record_shows_is_asked_about() {
    let path = directory("unsaid-zero").join("pull.csv");
    let path = path.to_str().unwrap();
    let pull = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let pull: Vec<f64> =
        pull.lines().filter_map(|row| row.split_once(',')?.1.parse().ok()).collect();
    let said = |zero_n: f64, arguments: &[&str]| {
        // Noise of 2 N, even.
        let rest = |i: u32| zero_n + f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 16384.0 - 2.0;
        let rests = || (0..320).map(rest);
        let forces = rests().chain(pull.iter().map(|force_n| force_n + zero_n)).chain(rests());
        let rows =
            forces.enumerate().map(|(i, force_n)| format!("{},{force_n}\n", i as f64 / 16.0));
        fs::write(path, format!("time_s,force_n\n{}", rows.collect::<String>())).unwrap();
        let replayed = [&["replay", path, "--weight-n", "630", "--json"], arguments].concat();
        json_with_warnings(&floe(&replayed))
    };
    let asked = said(7.0, &[]);
    // The rests lie at 7 N, but for the noise and its mean.
    for option in ["--zero-before-n", "--zero-after-n"] {
        let (_, behind) = asked.split_once(&format!(" {option} ")).expect(&asked);
        let digits = |it: char| it.is_ascii_digit() || it == '.';
        let zero_n = &behind[..behind.find(|it| !digits(it)).unwrap_or(behind.len())];
        let zero_n: f64 = zero_n.parse().expect(zero_n);
        assert!((zero_n - 7.0).abs() < 0.1, "{option} {zero_n}: {asked}");
    }
    assert!(!said(7.0, &["--zero-before-n", "7"]).contains("zero"));
    assert!(!said(0.0, &[]).contains("zero"));
}

#[test]
fn a_mark_after_the_end_of_the_log_is_told() {
    let path = directory("late-mark").join("pull.csv");
    let path = path.to_str().unwrap();
    let pull = fs::read_to_string("logs/dff8-13.csv").unwrap();
    let said = |marks: &str| {
        fs::write(path, format!("# winch_marks_s: {marks}\n{pull}")).unwrap();
        json_with_warnings(&floe(&["replay", path, "--json"]))
    };
    let told = said("held 60, moving 1000");
    assert!(told.contains("the mark 'moving 1000' comes after the end of the log"), "{told}");
    assert!(!said("held 0, moving 60").contains("mark"));
}
