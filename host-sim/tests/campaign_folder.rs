//! Input of `floe campaign`: a folder, a list or a table, and the reports on files that are left
//! out.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

#[path = "support/command.rs"]
mod command;
use command::{assert_refused, directory, text};

const LOG: &str = include_str!("../logs/dff8-13.csv");

fn campaign(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
    command.current_dir(folder).arg("campaign").args(arguments).output().unwrap()
}

/// The JSON, and the text on standard error.
fn json(folder: &Path, arguments: &[&str]) -> (serde_json::Value, String) {
    let output = campaign(folder, &[arguments, &["--strict", "--json"]].concat());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    (serde_json::from_slice(&output.stdout).unwrap(), said)
}

/// The log in the form of `floe recover --toa5`: without the weight.
fn toa5() -> String {
    let mut text = "\"TOA5\",\"floe\",\"floe\",\"1\",\"1\",\"pull\",\"1\",\"pull\"\n\
                    \"TIMESTAMP\",\"RECORD\",\"force_n\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\",\"Smp\"\n"
        .to_string();
    let rows = LOG.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    for (index, row) in rows.enumerate() {
        let (minute, second) = (index / 960, (index % 960) as f64 / 16.0);
        let force = row.split(',').nth(1).unwrap();
        text += &format!("\"2012-02-29 12:{minute:02}:{second:07.4}\",{index},{force}\n");
    }
    text
}

/// `floe recover --toa5` writes a test in two forms, and a text file that may be empty.
#[test]
fn a_recovered_folder_is_taken_as_it_is() {
    let folder = directory("recovered");
    fs::write(folder.join("pull.csv"), LOG).unwrap();
    fs::write(folder.join("pull.dat"), toa5()).unwrap();
    fs::write(folder.join("pull.txt"), "").unwrap();
    let (found, said) = json(&folder, &["."]);
    assert_eq!((&found["tests"], &found["left_out"]), (&1.into(), &serde_json::json!([])));
    assert!(said.contains("pull.dat is the log ./pull.csv again: it counts once"), "{said}");

    // The table may name either form.
    fs::write(folder.join("tests.csv"), "file,weight_n\npull.dat,700\n").unwrap();
    let (found, said) = json(&folder, &["."]);
    assert_eq!(found["tests"], 1);
    assert_eq!(found["records"][0]["weight_n"], 700.0);
    assert!(said.contains("pull.csv is the log ./pull.dat again"), "{said}");
    fs::write(folder.join("tests.csv"), "file,weight_n\npull.csv,700\npull.dat,630\n").unwrap();
    let both = campaign(&folder, &["."]);
    assert_refused(&both, &["tests.csv: line 3: the log 'pull.dat' stands in line 2 already"]);
}

#[test]
fn a_log_counts_once() {
    let folder = directory("once").join("dd");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("x.csv"), LOG).unwrap();
    fs::write(folder.join("tests.csv"), "file,snow_mm\n../dd/x.csv,5\n").unwrap();
    let (found, _) = json(&folder, &["."]);
    assert_eq!((&found["tests"], &found["records"][0]["snow_mm"]), (&1.into(), &5.0.into()));
    fs::write(folder.join("list"), "x.csv\n\n../dd/x.csv\n").unwrap();
    let twice = campaign(&folder, &["list"]);
    assert_refused(&twice, &["list: line 3: the log 'x.csv' stands in line 1 already"]);

    // A copy is another file; its equal forces show it, whatever the weight.
    fs::write(folder.join("y.csv"), LOG).unwrap();
    fs::write(folder.join("tests.csv"), "file,weight_n,test_id\ny.csv,700,again\n").unwrap();
    let (found, said) = json(&folder, &["."]);
    assert_eq!(found["tests"], 2);
    assert!(said.contains("./y.csv and ./x.csv give the same numbers, force by force"), "{said}");
    // Two columns of one file are two tests.
    let two = LOG.replace("time_s,force_n", "time_s,a_n,b_n");
    let two: String = two
        .lines()
        .map(|line| match line.split_once(',') {
            Some((_, force)) if line.starts_with(|c: char| c.is_ascii_digit()) => {
                format!("{line},{force}\n")
            }
            _ => format!("{line}\n"),
        })
        .collect();
    fs::write(folder.join("two.csv"), two).unwrap();
    fs::write(folder.join("two"), "file,column\ntwo.csv,a_n\ntwo.csv,b_n\n").unwrap();
    assert_eq!(json(&folder, &["two"]).0["tests"], 2);
}

#[cfg(unix)]
#[test]
fn what_cannot_be_read_is_named() {
    let folder = directory("unreadable");
    fs::write(folder.join("x.csv"), LOG).unwrap();
    std::os::unix::fs::symlink("nowhere.csv", folder.join("gone.csv")).unwrap();
    fs::create_dir_all(folder.join("older/still")).unwrap();
    fs::write(folder.join("y.csv.gz"), [0x1f, 0x8b, 8, 0]).unwrap();
    fs::write(folder.join("z.tsv"), LOG).unwrap();
    let report = directory("unreadable_report").join("page.html");
    let output = campaign(&folder, &[".", "--report", report.to_str().unwrap()]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("left out: ./gone.csv: no such file"), "{said}");
    let page = fs::read_to_string(report).unwrap();
    assert!(page.contains("<li>left out: ./gone.csv: no such file</li>"), "{page}");
    assert!(said.contains(".: 1 folder in it not looked into"), "{said}");
    assert!(said.contains("note: 2 other files not read, such as ./y.csv.gz: the names"), "{said}");
    assert_refused(&campaign(&folder, &[".", "--strict"]), &["gone.csv: no such file"]);
    std::os::unix::fs::symlink("nowhere.csv", folder.join("tests.csv")).unwrap();
    assert_refused(&campaign(&folder, &["."]), &["tests.csv: no such file"]);
}

#[test]
fn a_spreadsheets_table_and_list_are_read() {
    let folder = directory("spreadsheet");
    let plain = LOG.replace("# weight_n: 630\n", "");
    fs::write(folder.join("x.csv"), plain).unwrap();
    let table = "File;weight_n;winch_m_per_s;kind\r\nx.csv;630;0,0157;Sliding\r\n;;;\r\n";
    let utf16 = |text: &str| -> Vec<u8> {
        [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
    };
    for bytes in [table.as_bytes().to_vec(), format!("\u{feff}{table}").into(), utf16(table)] {
        fs::write(folder.join("tests.csv"), bytes).unwrap();
        let record = json(&folder, &["."]).0["records"][0].clone();
        assert_eq!((&record["weight_n"], &record["kind"]), (&630.0.into(), &"sliding".into()));
        assert_eq!(record["winch_m_per_s"], 0.0157);
    }
    fs::write(folder.join("tests.csv"), b"file;weight_n;test_id\nx.csv;630;Gef\xe4lle\n").unwrap();
    assert_eq!(json(&folder, &["."]).0["records"][0]["test_id"], "Gef\u{e4}lle");
    fs::remove_file(folder.join("tests.csv")).unwrap();
    fs::write(folder.join("said.csv"), LOG).unwrap();
    for bytes in ["\u{feff}said.csv\n".as_bytes().to_vec(), utf16("said.csv\r\n")] {
        fs::write(folder.join("list"), bytes).unwrap();
        assert_eq!(json(&folder, &["list"]).0["tests"], 1);
    }
}

#[test]
fn mistakes_in_a_table_are_one_line() {
    let folder = directory("mistakes");
    fs::write(folder.join("x.csv"), LOG).unwrap();
    for (table, said) in [
        ("file,winch_m_per_s\nx.csv,nan\n", "tests.csv: line 2: 'winch_m_per_s' has 'nan': write"),
        ("file,kind\nx.csv,foo\n", "line 2: 'kind' has 'foo': write one of sliding, rafting"),
        ("name\nx.csv\n", "line 1: no column is called 'file'; there are: file, array_id"),
    ] {
        fs::write(folder.join("tests.csv"), table).unwrap();
        assert_refused(&campaign(&folder, &["."]), &[said]);
    }
    fs::write(folder.join("tests.csv"), b"PK\x03\x04\xff\xfe\x00\x00\x9f\xff\x00").unwrap();
    assert_refused(&campaign(&folder, &["."]), &["tests.csv: cannot be read: is a spreadsheet"]);
}

/// Error messages suggest the table of a campaign where a replay would have options.
#[test]
fn remedies_are_those_of_a_campaign() {
    let folder = directory("remedies");
    fs::write(folder.join("x.csv"), LOG.replace("# weight_n: 630\n", "")).unwrap();
    let weight =
        "give weight_n W or mass_kg M, or put '# weight_n: W' into the log (weight_n, mass_kg";
    assert_refused(&campaign(&folder, &["."]), &[weight]);
    fs::write(folder.join("x.csv"), LOG.replace("time_s", "when").replace("# rate_hz: 16", ""))
        .unwrap();
    assert_refused(
        &campaign(&folder, &["."]),
        &["a campaign has no --time-column", "floe inspect"],
    );
    assert_refused(
        &campaign(&folder, &["--parquet", "e.csv"]),
        &["e.csv: --parquet writes no CSV"],
    );
    assert!(!folder.join("e.csv").exists());
}

#[test]
fn where_no_log_can_be_used_an_older_table_of_events_stays() {
    let folder = directory("none-usable");
    fs::write(folder.join("pull.csv"), LOG).unwrap();
    let arguments = [".", "--parquet", "events.parquet"];
    assert!(campaign(&folder, &arguments).status.success());
    let table = fs::read(folder.join(arguments[2])).unwrap();
    fs::write(folder.join("pull.csv"), "time_s,force_n\n").unwrap();
    assert_refused(&campaign(&folder, &arguments), &["pull.csv: no samples"]);
    assert_eq!(fs::read(folder.join(arguments[2])).unwrap(), table);
}

/// More tests than are listed: the JSON has no place for what is doubtful about each.
#[test]
fn notes_are_not_said_to_be_where_they_are_not() {
    let folder = directory("many");
    for i in 0..201 {
        let log = format!("# weight_n: 630\ntime_s,force\n0,{i}\n0.0625,1\n");
        fs::write(folder.join(format!("{i:03}.csv")), log).unwrap();
    }
    let (found, said) = json(&folder, &["."]);
    assert_eq!((&found["tests"], &found["records"]), (&201.into(), &serde_json::json!([])));
    assert!(said.contains("note: ./000.csv: column 'force' has no unit"), "{said}");
    assert!(said.contains("floe: and 181 more notes\n"), "{said}");
    let table = text(&campaign(&folder, &["."]).stdout);
    assert!(
        table.starts_with("201 tests, too many to list: --parquet has their events\n"),
        "{table}"
    );
}
