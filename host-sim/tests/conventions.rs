//! Conventions of all commands of `floe`: `--json [FILE]`, existing files, text without colours in
//! a pipe.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

#[path = "support/command.rs"]
mod command;
use command::{assert_refused, text};

const REPLACED: &str = "the file that was there has been replaced";
/// Beginning of an older result.
const OLD: &str = "{\n  \"schema\": \"floe-replay/2\"";

/// A directory with the bundled log, a recording at rest and a pull against a post.
fn directory(test: &str) -> PathBuf {
    let path = command::directory(test);
    let bundled = Path::new(env!("CARGO_MANIFEST_DIR")).join("logs/dff8-13.csv");
    fs::copy(bundled, path.join("log.csv")).unwrap();
    let rest: String =
        (0..640).map(|i| format!("{},630.{}\n", f64::from(i) / 16.0, i % 3)).collect();
    fs::write(path.join("rest.csv"), "time_s,force_n\n".to_string() + &rest).unwrap();
    let post: String = (0..640).map(|i| format!("{},{}\n", f64::from(i) / 16.0, i * 5)).collect();
    fs::write(
        path.join("post.csv"),
        "# winch_m_per_s: 0.0157\ntime_s,force_n\n".to_string() + &post,
    )
    .unwrap();
    path
}

fn run(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    command.current_dir(directory).args(arguments).output().unwrap()
}

fn floe(directory: &Path, arguments: &[&str]) -> Output {
    let output = run(directory, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    output
}

/// File names from another system may be invalid UTF-8.
#[cfg(unix)]
#[test]
fn a_report_can_have_a_name_that_is_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let dir = directory("no_text");
    let name = std::ffi::OsStr::from_bytes(b"d\xe9.html");
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    command.current_dir(&dir).args(["replay", "log.csv", "--report"]).arg(name);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(fs::read_to_string(dir.join(name)).unwrap().contains("d\u{fffd}.html"));
}

/// Commands that evaluate a log, each with a suitable log.
const ON_LOGS: [(&str, &str); 4] = [
    ("replay", "log.csv"),
    ("inspect", "log.csv"),
    ("weigh", "rest.csv"),
    ("stiffness", "post.csv"),
];

#[test]
fn json_is_the_same_option_everywhere() {
    let dir = directory("json_everywhere");
    for (command, log) in ON_LOGS {
        let bare = floe(&dir, &[command, log, "--json"]).stdout;
        assert!(serde_json::from_slice::<serde_json::Value>(&bare).unwrap().is_object());
        let swapped = floe(&dir, &[command, "--json", log]).stdout;
        assert!(bare == swapped, "{command}: --json LOG");
        let plain = text(&floe(&dir, &[command, log]).stdout);
        let first = floe(&dir, &[command, log, "--json", "x.json"]);
        assert!(text(&first.stdout).starts_with(&plain), "{command}: the text is there as well");
        assert!(!text(&first.stderr).contains(REPLACED), "{command}");
        assert!(fs::read(dir.join("x.json")).unwrap() == bare, "{command}");
        let second = floe(&dir, &[command, log, "--json", "x.json"]);
        assert!(text(&second.stderr).contains(&format!("x.json: {REPLACED}")), "{command}");
        fs::remove_file(dir.join("x.json")).unwrap();
    }
}

#[test]
fn outputs_are_written_whole_and_never_over_the_log() {
    let dir = directory("outputs");
    let log = fs::read(dir.join("log.csv")).unwrap();
    fs::write(dir.join("a.json"), OLD).unwrap();
    let files =
        ["replay", "log.csv", "--json", "a.json", "--events", "a.csv", "--report", "a.html"];
    let said = text(&floe(&dir, &files).stdout);
    let begun = [
        ("a.json", "{\n  \"schema\": \"floe-replay/2\""),
        ("a.csv", "index,onset_s,stop_s,"),
        ("a.html", "<!"),
    ];
    for (file, begin) in begun {
        assert!(said.contains(&format!("written       {file}\n")), "{file}");
        assert!(fs::read_to_string(dir.join(file)).unwrap().starts_with(begin), "{file}");
    }
    assert_eq!(fs::read_dir(&dir).unwrap().count(), 6, "nothing is left beside them");
    fs::hard_link(dir.join("log.csv"), dir.join("same.csv")).unwrap();
    let refused: [(&[&str], &str); 6] = [
        (&["--events", "log.csv"], "log.csv: is read or written already"),
        (&["--events", "./same.csv"], "same.csv: is read or written already"),
        (&["--events", "a.json", "--json", "a.json"], "a.json: is read or written already"),
        (&["--events", "."], "is a directory"),
        (&["--json", "no/such/a.json"], "directory does not exist"),
        (&["--samples", "log.csv"], "log.csv: is read or written already"),
    ];
    for (options, said) in refused {
        assert_refused(&run(&dir, &[&["replay", "log.csv"], options].concat()), &[said]);
    }
    for (command, log) in ON_LOGS {
        assert_refused(&run(&dir, &[command, log, "--json", log]), &[log, "already"]);
    }
    #[cfg(target_os = "linux")]
    for option in ["--json", "--events", "--samples", "--report"] {
        let full = run(&dir, &["replay", "log.csv", "--quiet", option, "/dev/full"]);
        assert_refused(&full, &["floe: /dev/full: cannot be written: No space left"]);
    }
    assert!(fs::read(dir.join("log.csv")).unwrap() == log);
    fs::write(dir.join("log.csv"), "time_s,force_n\n0,oops\n1,2\n").unwrap();
    fs::write(dir.join("a.json"), OLD).unwrap();
    assert_refused(&run(&dir, &["replay", "log.csv", "--json", "a.json"]), &["line 2"]);
    assert_eq!(fs::read_to_string(dir.join("a.json")).unwrap(), OLD);
}

/// `replay --events *.csv` makes the first file that the shell lists the output.
#[test]
fn no_result_replaces_a_file_that_is_none() {
    let dir = directory("theirs");
    fs::copy(dir.join("log.csv"), dir.join("a.csv")).unwrap();
    let simulated = "# SYNTHETIC: computed\ntime_s,force_n\n";
    for (name, text) in [("s.csv", simulated), ("n.html", "<html>"), ("p.parquet", "PAR1 PAR1")] {
        fs::write(dir.join(name), text).unwrap();
    }
    let said = "is there already and is no result of floe; name another file, or remove it";
    for (option, file) in [
        ("--events", "a.csv"),
        ("--samples", "p.parquet"),
        ("--report", "n.html"),
        ("--json", "s.csv"),
    ] {
        let before = fs::read(dir.join(file)).unwrap();
        assert_refused(&run(&dir, &["replay", "--quiet", option, file, "log.csv"]), &[file, said]);
        assert!(fs::read(dir.join(file)).unwrap() == before, "{file}");
    }
    fs::create_dir(dir.join("figures")).unwrap();
    fs::write(dir.join("figures/history.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\">")
        .unwrap();
    assert_refused(
        &run(&dir, &["replay", "log.csv", "--figures", "figures"]),
        &["history.svg", said],
    );
}

/// Results of every kind, and an empty file.
#[test]
fn results_replace_results_of_any_kind() {
    let dir = directory("ours");
    fs::create_dir(dir.join("logs")).unwrap();
    fs::copy(dir.join("log.csv"), dir.join("logs/log.csv")).unwrap();
    fs::write(dir.join("x"), "").unwrap();
    floe(&dir, &["replay", "log.csv", "--quiet", "--samples", "s.parquet"]);
    floe(&dir, &["campaign", "logs", "--parquet", "s.parquet"]);
    let commands: [&[&str]; 7] = [
        &["replay", "log.csv", "--quiet", "--events", "x"],
        &["replay", "log.csv", "--quiet", "--samples", "x"],
        &["replay", "log.csv", "--quiet", "--report", "x"],
        &["stiffness", "post.csv", "--extension", "x"],
        &["campaign", "logs", "--report", "x"],
        &["campaign", "logs", "--parquet", "x"],
        &["weigh", "rest.csv", "--json", "x"],
    ];
    for command in commands.into_iter().chain(commands) {
        floe(&dir, command);
    }
}

#[test]
fn a_simulated_log_replaces_simulated_ones_alone() {
    let dir = directory("simulated");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/dff8-13.toml");
    let scene = scene.to_str().unwrap();
    let simulate = |log: &str| run(&dir, &["simulate", scene, "--duration-s", "9", "-o", log]);
    for log in ["new.csv", "new.dat"] {
        assert_eq!(simulate(log).status.code(), Some(0), "{log}");
    }
    assert!(text(&simulate("new.csv").stderr).contains(REPLACED));
    let why = "is there already and does not begin with '# SYNTHETIC:'";
    for log in ["rest.csv", "new.dat"] {
        assert_refused(&simulate(log), &[log, why]);
    }
}

#[test]
fn every_file_of_figures_that_is_replaced_is_said() {
    let dir = directory("figures_replaced");
    let arguments = ["replay", "log.csv", "--figures", "figures"];
    assert_eq!(text(&floe(&dir, &arguments).stderr).matches(REPLACED).count(), 0);
    let count = fs::read_dir(dir.join("figures")).unwrap().count().max(2);
    assert_eq!(text(&floe(&dir, &arguments).stderr).matches(REPLACED).count(), count);
}

#[test]
fn figures_and_other_outputs_never_share_a_file() {
    let dir = directory("figures_apart");
    fs::create_dir(dir.join("there")).unwrap();
    let replay = |options: &[&str]| run(&dir, &[&["replay", "log.csv"], options].concat());
    for (option, file) in
        [("--report", "history.svg"), ("--json", "slip.svg"), ("--events", "../there/plane.svg")]
    {
        let file = format!("there/{file}");
        let refused = replay(&["--figures", "there", option, &file]);
        assert_refused(&refused, &[".svg: is read or written already"]);
    }
    for (folder, file) in [("new", "new"), ("new/deeper", "./new")] {
        let refused = replay(&["--figures", folder, "--report", file]);
        assert_refused(&refused, &[folder, "is written already by this command"]);
    }
    assert_eq!(fs::read_dir(dir.join("there")).unwrap().count(), 0);
    assert!(!dir.join("new").exists());
    // The figures may stand in the folder of the report, and each file is listed.
    let said =
        floe(&dir, &["replay", "log.csv", "--figures", "there", "--report", "there/page.html"]);
    let said = text(&said.stdout);
    for file in ["there/page.html", "there/history.svg", "there/slip.svg"] {
        assert!(said.contains(&format!("written       {file}\n")), "{said}");
    }
    assert!(fs::read_to_string(dir.join("there/page.html")).unwrap().starts_with("<!"));
}

#[test]
fn only_json_goes_to_standard_output() {
    let dir = directory("dash");
    let before = fs::read_dir(&dir).unwrap().count();
    for option in ["--events", "--report", "--samples", "--figures"] {
        let refused = run(&dir, &["replay", "log.csv", option, "-"]);
        assert_refused(&refused, &["-: only --json goes to standard output; name a file"]);
    }
    assert_refused(&run(&dir, &["live", "localhost:1", "-o", "-"]), &["only --json"]);
    let samples = run(&dir, &["replay", "log.csv", "--samples", "samples.json"]);
    assert_refused(&samples, &["samples.json", "must end in .csv or .parquet"]);
    assert_eq!(fs::read_dir(&dir).unwrap().count(), before);
    floe(&dir, &["replay", "log.csv", "--events", "./-"]);
    assert!(dir.join("-").is_file());
}

/// An output is made in a directory that is there; only the last directory itself is made.
#[test]
fn a_missing_directory_is_said_in_the_same_words() {
    let dir = directory("nowhere");
    let why = "its directory does not exist; make it first";
    for arguments in [
        &["replay", "log.csv", "--json", "nodir/x"][..],
        &["replay", "log.csv", "--figures", "nodir/deep/figs"],
        &["recover", "log.csv", "-o", "nodir/tests"],
        &["simulate", "log.csv", "-o", "nodir/x.csv"],
        &["live", "127.0.0.1:1", "-o", "nodir/x"],
    ] {
        assert_refused(&run(&dir, arguments), &["nodir/", why]);
        assert!(!dir.join("nodir").exists(), "{arguments:?}");
    }
    fs::create_dir(dir.join("nodir")).unwrap();
    floe(&dir, &["replay", "log.csv", "--figures", "nodir/figs/"]);
    assert!(dir.join("nodir/figs/history.svg").is_file());
}

/// Missing inputs are reported without the words of the system.
#[test]
fn a_missing_input_is_said_in_the_same_words() {
    let dir = directory("missing");
    for arguments in [
        &["replay", "nosuch"][..],
        &["inspect", "nosuch"],
        &["weigh", "nosuch"],
        &["stiffness", "nosuch"],
        &["simulate", "nosuch", "-o", "x.csv"],
        &["campaign", "nosuch"],
        &["recover", "nosuch", "-o", "tests"],
    ] {
        let command = arguments[0];
        assert_refused(&run(&dir, arguments), &["nosuch: no such file"]);
        let unnamed = [&[command, ""], &arguments[2..]].concat();
        assert_refused(&run(&dir, &unnamed), &["a value is required for", "but none was supplied"]);
    }
    assert_refused(&run(&dir, &["live", ""]), &["a value is required for '<PORT>'"]);
    fs::create_dir(dir.join("folder")).unwrap();
    let refused = run(&dir, &["simulate", "folder", "-o", "x.csv"]);
    assert_refused(&refused, &["folder: is a directory; name a file"]);
}

/// `floe replay x.csv --json >> x.csv`.
#[cfg(unix)]
#[test]
fn the_log_is_not_written_by_standard_output() {
    let dir = directory("appended");
    for (command, log) in ON_LOGS {
        let before = fs::read(dir.join(log)).unwrap();
        let out = fs::OpenOptions::new().append(true).open(dir.join(log)).unwrap();
        let mut floe = Command::new(env!("CARGO_BIN_EXE_floe"));
        let output = floe.current_dir(&dir).args([command, log, "--json"]).stdout(out).output();
        let why = "is where standard output goes; send that to another file";
        assert_refused(&output.unwrap(), &[log, why]);
        let open = |append| fs::OpenOptions::new().read(true).append(append).open(dir.join(log));
        let mut floe = Command::new(env!("CARGO_BIN_EXE_floe"));
        floe.args([command, "-", "--json"]).stdin(open(false).unwrap()).stdout(open(true).unwrap());
        assert_refused(&floe.output().unwrap(), &["floe: -: ", why]);
        assert!(fs::read(dir.join(log)).unwrap() == before, "{command}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_that_is_replaced_is_said() {
    let dir = directory("dangling");
    std::os::unix::fs::symlink("nowhere", dir.join("a.html")).unwrap();
    let said = text(&floe(&dir, &["replay", "log.csv", "--report", "a.html"]).stderr);
    let why = "floe: a.html: the link to nowhere that was there has been replaced\n";
    assert_eq!(said, why);
    assert!(!dir.join("nowhere").exists());
}

#[cfg(unix)]
#[test]
fn a_name_of_two_lines_is_shown_in_one() {
    let dir = directory("two_lines");
    fs::rename(dir.join("log.csv"), dir.join("a\nb.csv")).unwrap();
    for command in ["replay", "inspect"] {
        let said = text(&floe(&dir, &[command, "a\nb.csv"]).stdout);
        let first = said.lines().next().unwrap();
        assert!(first.contains("a\\u000ab.csv"), "{first}");
    }
}

#[test]
fn a_pipe_gets_neither_colours_nor_bars() {
    let dir = directory("no_colours");
    let mut commands: Vec<Vec<&str>> = ON_LOGS.iter().map(|(c, log)| vec![*c, *log]).collect();
    commands.push(vec!["--help"]);
    commands.push(vec!["replay", "--help"]);
    commands.push(vec!["campaign"]);
    for command in commands {
        let output = floe(&dir, &command);
        assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b), "{command:?}");
        assert!(!output.stderr.contains(&b'\r'), "{command:?}");
    }
}
