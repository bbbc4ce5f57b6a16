//! Input that is refused with one line.

use std::fs;

use super::{assert_refused, directory, floe, floe_fed, ramp};

#[test]
fn bad_files_are_refused_in_one_line() {
    let dir = directory("bad_files");
    let ramp = ramp(40);
    let utf16: Vec<u8> = ramp.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let broken = |line: usize, new: &str| {
        let mut lines: Vec<&str> = ramp.lines().collect();
        lines[line - 1] = new;
        (lines.join("\n") + "\n").into_bytes()
    };
    let table: Vec<(&str, Vec<u8>, Vec<&str>)> = vec![
        ("empty", b"".to_vec(), vec!["is empty"]),
        ("blank", b"\n \r\n".to_vec(), vec!["is empty"]),
        ("header_only", b"time_s,force_n\n".to_vec(), vec!["no samples"]),
        ("no_header", b"0.0,1.5,2\n0.0625,1.5,2\n".to_vec(), vec!["line 1", "no header"]),
        ("comments_only", b"# weight_n: 5\n".to_vec(), vec!["ends before its header"]),
        ("no_force", b"time_s,f\n0,1\n".to_vec(), vec!["line 1", "--column", "time_s, f"]),
        ("no_time", b"x,force_n\n0,1\n".to_vec(), vec!["line 1", "time_s", "x, force_n"]),
        ("not_a_number", broken(12, "0.625,abc"), vec!["line 12", "'abc'", "not a number"]),
        ("bad_time", broken(12, "nan,5"), vec!["line 12", "time", "'nan'"]),
        ("short_row", broken(12, "0.625"), vec!["line 12", "1 cell instead of 2"]),
        ("long_row", broken(12, "0.625,1,2"), vec!["line 12", "3 cells instead of 2"]),
        ("open_quote", broken(12, "0.625,\"1"), vec!["line 12", "quote"]),
        ("backwards", broken(12, "0.25,5"), vec!["line 12", "time goes back"]),
        ("metadata", broken(12, "# weight_n: big"), vec!["line 12", "'big'"]),
        ("constant", b"t,force_n\n1,1\n1,2\n1,3\n".to_vec(), vec!["time stands still"]),
        ("slow", b"t,force_n\n0,1\n60,2\n120,3\n".to_vec(), vec!["0.016667", "--time-unit"]),
        ("fast", b"t,force_n\n0,1\n1e-6,2\n2e-6,3\n".to_vec(), vec!["--time-unit"]),
        ("binary", (0..=255).cycle().take(9999).collect(), vec!["binary"]),
        (
            "scrambled",
            (0..9999_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect(),
            vec!["binary"],
        ),
        ("long_line", vec![b'x'; 1 << 20], vec!["line 1", "64 KiB"]),
        ("long_later", [ramp.as_bytes(), &[b'1'; 99_999]].concat(), vec!["line 42", "64 KiB"]),
        ("utf16_bare", utf16, vec!["UTF-16", "UTF-8"]),
        ("tob1", b"\"TOB1\",\"a\"\n".to_vec(), vec!["TOB1", "TOA5"]),
        (
            "cr10_short_row",
            b"1,94,1,0,0,5\n1,94,1,0,0\n1,94,1,0,.125,5\n".to_vec(),
            vec!["line 2", "5 cells instead of 6"],
        ),
        ("toa5_cut", b"\"TOA5\",\"a\"\n\"TIMESTAMP\"\n".to_vec(), vec!["ends before its header"]),
    ];
    for (name, content, parts) in table {
        let path = dir.join(name);
        fs::write(&path, content).unwrap();
        let path = path.to_str().unwrap();
        let mut parts = parts;
        parts.push(path);
        assert_refused(&floe(&["replay", path, "--weight-n", "100"]), &parts);
    }
}

#[test]
fn files_that_are_not_there_are_refused() {
    let dir = directory("not_there");
    let path = dir.to_str().unwrap();
    assert_refused(&floe(&["replay", path]), &[path, "is a directory"]);
    let missing = dir.join("nope.csv");
    let missing = missing.to_str().unwrap();
    assert_refused(&floe(&["replay", missing]), &[missing, "no such file"]);
    assert_refused(&floe(&["replay"]), &["no log given"]);
}

#[test]
fn bad_options_are_refused_in_one_line() {
    let dir = directory("bad_options");
    let path = dir.join("log.csv");
    fs::write(&path, ramp(40)).unwrap();
    let path = path.to_str().unwrap();
    let table: [(&[&str], &[&str]); 23] = [
        (&[], &["weight", "--weight-n", "--mass-kg", "# weight_n:"]),
        (&["--weight-n", "0"], &["weight", "above zero"]),
        (
            &["--weight-n", "1e308"],
            &["--weight-n must be a number above zero, up to 1e9, not 1e308"],
        ),
        (&["--weight-n", "1e-300"], &["above zero, up to 1e9, not 1e-300"]),
        (&["--weight-n", "1e20"], &["above zero, up to 1e9, not 1e20"]),
        (&["--mass-kg", "1e308"], &["--mass-kg", "not 1e308"]),
        (
            &["--weight-n", "5", "--decimal", ","],
            &["column 'force_n' holds '100.25'", "than --decimal says"],
        ),
        (
            &["--weight-n", "630", "--zero-before-n", "nan"],
            &["--zero-before-n must be a number from -1e9 up to 1e9, not NaN"],
        ),
        (&["--weight-n", "630", "--zero-after-n", "1e300"], &["--zero-after-n", "not 1e300"]),
        (&["--weight-n", "630", "--winch-m-per-s", "-1"], &["--winch-m-per-s must", "-1"]),
        (&["--weight-n", "630", "--array-id", "101"], &["--array-id is for a cr10 log", "csv"]),
        (&["--weight-n", "630", "--tare-counts", "7"], &["for a force in counts", "in N: leave"]),
        (&["--weight-n", "-5"], &["weight", "above zero", "-5"]),
        (&["--weight-n", "nan"], &["weight", "above zero"]),
        (&["--weight-n", "inf"], &["weight", "above zero"]),
        (&["--mass-kg", "-1"], &["mass", "above zero"]),
        (&["--weight-n", "abc"], &["--weight-n", "abc"]),
        (&["--weight-n", "5", "--mass-kg", "1"], &["cannot be used with"]),
        (&["--weight-n", "5", "--slope-deg", "90"], &["slope", "90"]),
        (&["--weight-n", "5", "--rate-hz", "0.5"], &["0.5", "1 to 2000"]),
        (&["--weight-n", "5", "--rate-hz", "nan"], &["1 to 2000"]),
        (&["--weight-n", "5", "--format", "xls"], &["xls", "csv, toa5, cr10"]),
        (&["--weight-n", "5", "--column", "f"], &["line 1", "'f'", "time_s, force_n"]),
    ];
    for (options, parts) in table {
        assert_refused(&floe(&[&["replay", path], options].concat()), parts);
    }
    for format in ["toa5", "cr10"] {
        assert_refused(&floe(&["replay", path, "--weight-n", "5", "--format", format]), &[path]);
    }
    let counts = b"t,force\n0,100\n0.0625,110\n";
    let options = ["replay", "-", "--weight-n", "5", "--unit", "counts"];
    assert_refused(&floe_fed(&options, counts), &["--tare-counts", "--counts-per-n"]);
    assert_refused(&floe(&["replya"]), &["replya"]);
}

#[test]
fn a_table_has_the_name_of_its_format() {
    let dir = directory("table_names");
    let log = dir.join("log.csv");
    fs::write(&log, ramp(40)).unwrap();
    let events = dir.join("events.parquet");
    let [log, events_path] = [&log, &events].map(|path| path.to_str().unwrap());
    let refused = floe(&["replay", log, "--weight-n", "100", "--events", events_path]);
    assert_refused(&refused, &["events.parquet: --events writes CSV, and floe campaign --parquet"]);
    assert!(!events.exists());
}
