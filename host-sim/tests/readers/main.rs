//! Logs of every format through the readers.
#![allow(clippy::float_cmp)] // exact by construction

mod anything;
mod campbell;
mod rates;

use floe::log::stamp::TimeUnit;
use floe::log::{Format, Log, LogOptions, Sample};
use floe_core::{Counts, Fault, Newtons, Reading};

fn open(content: &[u8], options: &LogOptions) -> Result<Log, String> {
    let input = std::io::Cursor::new(content.to_vec());
    Log::from_reader(Box::new(input), options).map_err(|e| e.to_string())
}

fn samples(log: &mut Log) -> Result<Vec<Sample>, String> {
    std::iter::from_fn(|| log.next_sample().map_err(|e| e.to_string()).transpose()).collect()
}

fn read(content: &str) -> (Log, Vec<Sample>) {
    let mut log = open(content.as_bytes(), &LogOptions::default()).unwrap();
    let samples = samples(&mut log).unwrap();
    (log, samples)
}

fn indices(samples: &[Sample]) -> Vec<u32> {
    samples.iter().map(|sample| sample.raw.index).collect()
}

fn consecutive(samples: &[Sample]) -> bool {
    samples.iter().enumerate().all(|(i, sample)| sample.raw.index == i as u32)
}

#[test]
fn csv_keeps_the_logs_own_time_and_marks_bad_samples() {
    let (log, samples) = read(
        "t,force_kn\n10,1\n10.0625,-6999\n10.125,NAN\n10.1875,\n10.25,inf\n10.375,2\n10.375,3\n",
    );
    assert_eq!(log.format(), Format::Csv);
    assert_eq!(indices(&samples), [0, 1, 2, 3, 4, 6, 6]);
    assert!((samples[5].time_s - 10.375).abs() < 1e-9);
    let readings: Vec<Reading> = samples.iter().map(|sample| sample.raw.reading).collect();
    let bad = Reading::Bad(Fault::Sentinel);
    let force = |newtons| Reading::Force(Newtons(newtons));
    assert_eq!(readings, [force(1e3), bad, bad, bad, bad, force(2e3), force(3e3)]);
}

#[test]
fn csv_in_counts() {
    let options = LogOptions {
        column: Some("adc".to_string()),
        unit: Some(floe::log::Unit::Counts),
        ..LogOptions::default()
    };
    let mut log = open(b"time;adc\n0;6999\n0,0625;-8388608\n", &options).unwrap();
    let readings: Vec<Reading> = samples(&mut log).unwrap().iter().map(|s| s.raw.reading).collect();
    assert_eq!(readings, [Reading::Counts(Counts(6999)), Reading::Counts(Counts(-8_388_608))]);
}

#[test]
fn an_empty_row_below_the_names_is_none_of_them() {
    for (names, empty) in [("time_s;force_n", ";"), ("time_s,force_n", "\"\",\"\"")] {
        let mark = if empty == ";" { ';' } else { ',' };
        let row = |i: u32| format!("{}{mark}{i}\n", f64::from(i) / 16.0);
        let rows = (0..90).map(row).collect::<String>();
        let (log, samples) = read(&format!("{names}\n{empty}\n{rows}"));
        assert!(consecutive(&samples) && samples.len() == 90);
        let header = log.recognised().header.as_ref().unwrap();
        assert_eq!((header.names.as_ref().unwrap().0, header.first_row), (1, 3));
    }
}

#[test]
fn times_as_text_have_no_unit_and_an_unread_date_is_said() {
    let row = |i: u32| format!("02/29/2012,12:00:{:07.4},{i}\n", f64::from(i) / 16.0);
    let text = "Date,Time,Force [N]\n".to_string() + &(0..90).map(row).collect::<String>();
    let said = "column 'Date' is not read, and the log has no date: write 2012-02-29 or 29.02.2012";
    assert_eq!(read(&text).0.warnings(), [said]);
    let options = LogOptions { time_unit: Some(TimeUnit::Millisecond), ..LogOptions::default() };
    let error = open(text.as_bytes(), &options).unwrap_err();
    assert!(error.ends_with("--time-unit says ms: leave --time-unit out"), "{error}");
    assert_eq!(read(&text.replace("02/29/2012", "2012-02-29")).0.warnings(), Vec::<String>::new());
}
