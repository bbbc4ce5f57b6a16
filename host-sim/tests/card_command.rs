//! Logs of a board with `floe replay`, `inspect` and `recover`: sectors in any order, and damaged
//! or missing ones.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use floe_core::Counts;
use floe_firmware::adc::Input;
use floe_firmware::line::Line;
use floe_firmware::record::{Part, Record, SECTOR_LEN, Sector};
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

/// Sectors of one test, numbered from `first` on.
fn test(run: u32, first: u32, sectors: u32) -> Vec<Sector> {
    let sample = |index: u32| Sample {
        index,
        stamp: 62_500 * index,
        input: Input::Bridge,
        reading: Ok(Counts(1000 + 7 * index as i32)),
    };
    let record = |number: u32| {
        let mut record = Record {
            sector: first + number,
            part: Part { id: Some(u64::from(run)), run, ..Part::default() },
            clock_hz: 1_000_000,
            samples: (8 * number..8 * number + 8).map(sample).collect(),
            ..Record::default()
        };
        record.settings.config.weight_n = 630.0;
        record.encode()
    };
    (0..sectors).map(record).collect()
}

/// Two tests, of 240 and 96 samples.
fn two_tests() -> Vec<Sector> {
    [test(1, 0, 30), test(2, 30, 12)].concat()
}

/// Changes a value to one that no logger writes, with a valid checksum.
fn unsound(mut sector: Sector) -> Sector {
    sector[36..40].copy_from_slice(&f32::NAN.to_le_bytes());
    seal(&mut sector);
    sector
}

fn replayed(dir: &Path, card: &[u8]) -> serde_json::Value {
    fs::write(dir.join("FLOE.LOG"), card).unwrap();
    let output = floe(dir, &["replay", "FLOE.LOG", "--json", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn recovered(dir: &Path, card: &[u8]) -> String {
    fs::write(dir.join("FLOE.LOG"), card).unwrap();
    let _ = fs::remove_dir_all(dir.join("tests"));
    let output = floe(dir, &["recover", "FLOE.LOG", "-o", "tests"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn the_order_of_the_sectors_does_not_matter() {
    let dir = directory("order");
    let sectors = two_tests();
    let as_written = replayed(&dir, &sectors.concat());
    assert_eq!(as_written["log"]["samples"], 240);
    let more = "1 more recording beside it: floe recover takes them apart";
    assert_eq!(as_written["log"]["warnings"], serde_json::json!([more]));
    let mut swapped = sectors.clone();
    swapped.swap(7, 8);
    let reversed: Vec<Sector> = sectors.iter().rev().copied().collect();
    // 17 and 42 are coprime.
    let shuffled: Vec<Sector> = (0..42).map(|i| sectors[17 * i % 42]).collect();
    for card in [swapped, reversed, shuffled] {
        assert_eq!(replayed(&dir, &card.concat()), as_written);
        let said = recovered(&dir, &card.concat());
        assert!(said.contains("240 samples") && said.contains("96 samples"), "{said}");
        assert!(said.contains("sectors: 42 read, 0 damaged, 0 lost\n"), "{said}");
    }
}

#[test]
fn what_is_damaged_is_said_alike() {
    let dir = directory("damaged");
    let mut sectors = two_tests();
    sectors[0][2] ^= 1;
    sectors[9][1] ^= 1;
    sectors[20][300] ^= 1;
    sectors[21] = unsound(sectors[21]);
    let card = [&sectors.concat()[..], &test(3, 42, 1)[0][..200]].concat();
    let said = recovered(&dir, &card);
    let sums = "sectors: 38 read, 3 damaged, 3 lost, 1 that no logger writes, the last cut off\n";
    assert!(said.contains(sums), "{said}");
    let result = replayed(&dir, &card);
    assert_eq!(result["log"]["samples"], 208);
    let warnings: Vec<&str> = result["log"]["warnings"].as_array().unwrap()[1..]
        .iter()
        .map(|warning| warning.as_str().unwrap())
        .collect();
    let expected = [
        "3 damaged sectors: left out",
        "1 sector that no logger writes: left out",
        "a last sector that is cut off: left out",
    ];
    assert_eq!(warnings, expected);
    // The other files of an image do not count as damaged sectors.
    let image = [&[7; SECTOR_LEN][..], &two_tests().concat()].concat();
    assert!(recovered(&dir, &image).contains("sectors: 42 read, 0 damaged, 0 lost\n"));
}

#[test]
fn what_holds_no_test_is_refused_with_the_reason() {
    let dir = directory("none");
    let written = unsound(test(1, 0, 1)[0]);
    fs::write(dir.join("card.log"), [written, written].concat()).unwrap();
    let why = "card.log: holds no record of a floe logger (2 sectors that no logger writes): name \
               the card's FLOE.LOG, or an image of the whole card; a log as text goes to floe replay\n";
    assert_refused(&floe(&dir, &["replay", "card.log"]), &[why]);
    assert_refused(&floe(&dir, &["recover", "card.log", "-o", "tests"]), &[why]);
    let settings = Record::default().encode();
    fs::write(dir.join("settings.log"), settings).unwrap();
    assert_refused(&floe(&dir, &["replay", "settings.log"]), &["settings.log", "no test"]);
    // Disk images and badly damaged files are refused with a hint at `recover`.
    let mut boot = [0; SECTOR_LEN];
    boot[510..].copy_from_slice(b"\x55\xAA");
    fs::write(dir.join("card.img"), [&boot[..], &[0; 1 << 16], &two_tests().concat()].concat())
        .unwrap();
    assert_refused(&floe(&dir, &["replay", "card.img"]), &["image of a card; floe recover"]);
    let forced = floe(&dir, &["replay", "card.img", "--format", "floe"]);
    assert_refused(&forced, &["first 32 KiB", "floe recover"]);
    fs::write(dir.join("noise"), [1; 1 << 16]).unwrap();
    assert_refused(&floe(&dir, &["replay", "noise"]), &["binary", "floe recover"]);
}

#[test]
fn an_output_that_is_a_file_is_no_folder() {
    let dir = directory("folder");
    fs::write(dir.join("card.log"), two_tests().concat()).unwrap();
    fs::write(dir.join("taken"), "old").unwrap();
    let refused = floe(&dir, &["recover", "card.log", "-o", "taken"]);
    assert_refused(&refused, &["taken: is a file; name a directory"]);
    assert_refused(&floe(&dir, &["recover", "card.log", "-o", "-"]), &["standard output"]);
}

#[test]
fn a_card_has_neither_lines_nor_cells() {
    let dir = directory("inspect");
    fs::write(dir.join("card.log"), two_tests().concat()).unwrap();
    let said = text(&floe(&dir, &["inspect", "card.log"]).stdout);
    assert!(said.contains("format   floe, sectors of a logger's card\n"), "{said}");
    assert!(said.contains("weight_n: 630\n") && !said.contains("line"), "{said}");
    let output = floe(&dir, &["inspect", "card.log", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in ["delimiter", "decimal", "header_line", "units_line", "first_row_line"] {
        assert!(json[key].is_null(), "{key}: {json}");
    }
    assert!(json["metadata"][0]["line"].is_null(), "{json}");
}

/// What `floe recover` writes about a test is also there without it.
#[test]
fn temperature_and_supply_of_a_card_are_read() {
    let dir = directory("climate");
    let mut sectors = two_tests();
    let mut record = Record::decode(&sectors[3]).unwrap();
    let climate = Line::Climate { index: 24, temperature_c: Some(-12.0), supply_v: Some(3.3) };
    record.samples.truncate(2);
    record.text.push_str(&format!("{}\n", climate.to_text().unwrap())).unwrap();
    sectors[3] = record.encode();
    fs::write(dir.join("card.log"), sectors.concat()).unwrap();
    let output = floe(&dir, &["inspect", "card.log", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let said = |key: &str| {
        let all = json["metadata"].as_array().unwrap();
        all.iter().find(|it| it["key"] == key).map(|it| it["value"].clone())
    };
    assert_eq!(said("temperature_c"), Some("-12.00".into()), "{json}");
    assert_eq!(said("supply_v"), Some("3.300".into()), "{json}");
}

#[test]
fn columns_and_units_of_a_card_are_not_chosen() {
    let dir = directory("columns");
    fs::write(dir.join("card.log"), two_tests().concat()).unwrap();
    for option in [["--column", "force_n"], ["--unit", "kN"]] {
        let output = floe(&dir, &["replay", "card.log", option[0], option[1]]);
        let said = format!("{} is for a csv log, and this is floe: leave it out\n", option[0]);
        assert_refused(&output, &[&said]);
    }
}

/// A card is read twice, which a pipe does not allow.
#[cfg(unix)]
#[test]
fn a_card_does_not_come_by_a_pipe() {
    let dir = directory("pipe");
    let piped = |input: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
        command.current_dir(&dir).args(["recover", input, "-o", "tests"]);
        command.stdin(std::process::Stdio::piped()).output().unwrap()
    };
    assert_refused(&piped("-"), &["-: ", "name its FLOE.LOG, or an image of it"]);
    assert_refused(&piped("/dev/stdin"), &["/dev/stdin: ", "copy it into a file first"]);
    assert!(!dir.join("tests").exists());
}

#[test]
fn a_compressed_image_is_said_to_be_one() {
    let dir = directory("packed");
    fs::write(dir.join("card.img.gz"), b"\x1F\x8B\x08\x08 and what gzip makes of a card").unwrap();
    let refused = floe(&dir, &["recover", "card.img.gz", "-o", "tests"]);
    let why = "card.img.gz: is compressed: unpack it first, gunzip -c FILE > card.img";
    assert_refused(&refused, &[why]);
}
