//! Logs of every format through the readers.
#![allow(clippy::float_cmp)] // exact by construction

use std::io::Read;

use floe::log::{Format, Log, LogOptions, Sample};
use floe_core::{Counts, Fault, Newtons, Reading};
use proptest::prelude::*;

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

/// A CR10 at 16 Hz from `start_s` into day `day` of `year`: two scans a stamp.
fn cr10(year: u32, day: u32, start_s: u32, days_in_year: u32, scans: u32) -> Vec<String> {
    let row = |scan: u32| {
        let eighths = start_s * 8 + scan / 2;
        let (days, eighths) = (eighths / 691_200, eighths % 691_200);
        let (year, day) = if day + days > days_in_year {
            (year + 1, day + days - days_in_year)
        } else {
            (year, day + days)
        };
        let (minutes, second) = (eighths / 480, f64::from(eighths % 480) / 8.0);
        let hhmm = minutes / 60 * 100 + minutes % 60;
        format!("101,{year},{day},{hhmm},{second},{}\n", 100.0 + f64::from(scan) * 0.25)
    };
    (0..scans).map(row).collect()
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
fn a_clock_that_is_set_anew_is_said() {
    let row = |i: u32| format!("{},500\n", f64::from(i) / 16.0 + if i < 50 { 0.0 } else { 8e8 });
    let text = "time_s,force_n\n".to_string() + &(0..100).map(row).collect::<String>();
    let mut log = open(text.as_bytes(), &LogOptions::default()).unwrap();
    let samples = samples(&mut log).unwrap();
    assert_eq!(
        samples.last().map(|it| (it.raw.index, it.time_s)),
        Some(((1 << 28) + 98, 8e8 + 6.1875))
    );
    assert_eq!(
        log.warnings(),
        [
            "1 gap longer than 194.2 days: 268435455 samples each are counted as missing; was the clock set anew?"
        ]
    );
}

#[test]
fn a_given_rate_stands_over_the_stamps() {
    let content = b"# rate_hz: 8\nt,force_n\n0,1\n0.125,2\n0.25,3\n";
    assert!((open(content, &LogOptions::default()).unwrap().rate_hz() - 8.0).abs() < 1e-12);
    let options = LogOptions { rate_hz: Some(16.0), ..LogOptions::default() };
    let mut log = open(content, &options).unwrap();
    assert_eq!(indices(&samples(&mut log).unwrap()), [0, 2, 4]);
}

#[test]
fn jitter_within_half_a_period_makes_neither_gaps_nor_duplicates() {
    let mut state = 1_u64;
    let mut jitter = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5) * 0.9
    };
    let row = |i: i32| format!("{:.6},{i}\n", (f64::from(i) + jitter()) / 16.0 + 1.0);
    let content = "t,force_n\n".to_string() + &(0..50_000).map(row).collect::<String>();
    let (log, samples) = read(&content);
    assert!(consecutive(&samples));
    assert!((log.rate_hz() - 16.0).abs() < 1e-9);
    assert!(log.warnings()[0].contains("do not fit"));
}

#[test]
fn stamps_of_a_clock_that_is_off_do_not_drift_over_hours() {
    let row = |i: u32| format!("{:.3},5\n", f64::from(i) / 16.0003);
    let content = "t,force_n\n".to_string() + &(0..400_000).map(row).collect::<String>();
    let (log, samples) = read(&content);
    assert!(consecutive(&samples));
    assert_eq!(log.warnings(), Vec::<String>::new());
    let last = samples.last().unwrap();
    assert!((last.time_s - 399_999.0 / 16.0003).abs() < 0.001);
}

#[test]
fn cr10_time_comes_from_order_and_rate() {
    let (log, samples) = read(&cr10(1994, 100, 43_200, 365, 9000).concat());
    assert_eq!((log.format(), log.rate_hz()), (Format::Cr10, 16.0));
    assert!(consecutive(&samples));
    assert_eq!(log.warnings(), Vec::<String>::new());
    assert_eq!(samples[7].time_s, 7.0 / 16.0);
    assert_eq!(samples[8999].time_s, 8999.0 / 16.0);
}

#[test]
fn cr10_rolls_over_midnight_and_year() {
    for (year, days) in [(1995, 365), (1996, 366), (94, 365)] {
        let (log, samples) = read(&cr10(year, days, 86_340, days, 1920).concat());
        assert!(consecutive(&samples), "{year}");
        assert_eq!(log.warnings(), Vec::<String>::new(), "{year}");
    }
}

#[test]
fn cr10_midnight_may_be_2400() {
    let rows = cr10(1994, 100, 86_340, 365, 1920);
    let rows: Vec<String> = rows.iter().map(|r| r.replace(",101,0,0,", ",100,2400,0,")).collect();
    assert!(rows.iter().any(|row| row.contains(",2400,")));
    assert!(consecutive(&read(&rows.concat()).1));
}

#[test]
fn cr10_gaps_in_the_stamps_are_gaps_in_the_index() {
    let mut rows = cr10(1994, 100, 43_200, 365, 9000);
    rows.drain(5000..5161);
    rows.remove(1001);
    let (log, samples) = read(&rows.concat());
    assert_eq!(samples.last().unwrap().raw.index, 8999);
    let jumps: Vec<u32> =
        indices(&samples).windows(2).map(|w| w[1] - w[0] - 1).filter(|&n| n > 0).collect();
    assert_eq!(jumps, [1, 161]);
    assert_eq!(log.warnings(), Vec::<String>::new());
}

#[test]
fn cr10_stamps_one_step_off_are_counted_and_no_gap() {
    let mut rows = cr10(1994, 100, 43_200, 365, 9000);
    // A second scan with the stamp after it, a first scan with the one before it.
    for (at, from) in [(2001, 2002), (5000, 4999), (8001, 8002)] {
        let (stamp, _) = rows[from].rsplit_once(',').unwrap();
        let (_, force) = rows[at].rsplit_once(',').unwrap();
        rows[at] = format!("{stamp},{force}");
    }
    let (log, samples) = read(&rows.concat());
    assert!(consecutive(&samples));
    assert_eq!(log.warnings(), ["3 time stamps do not fit 16 samples per second"]);
}

#[test]
fn cr10_skips_other_arrays_of_any_length() {
    let mut rows = cr10(1994, 100, 43_200, 365, 400);
    rows.insert(0, "# weight_n: 630\n".to_string());
    for at in [3, 50, 200] {
        rows.insert(at, "204,94,100,1200,-6999,-6999,6999,63.07\n".to_string());
        rows.insert(at, "7\n".to_string());
    }
    let (log, samples) = read(&rows.concat());
    assert_eq!(samples.len(), 400);
    assert!(consecutive(&samples));
    assert_eq!(log.metadata().weight_n, Some(630.0));
}

#[test]
fn cr10_without_seconds_counts_on_order() {
    let row = |i: u32| format!("9,94,100,{},{}\n", 1200 + i / 960, i % 7);
    for rows in [900, 9000] {
        let (log, samples) = read(&(0..rows).map(row).collect::<String>());
        assert_eq!(log.rate_hz(), 16.0);
        assert!(consecutive(&samples), "{rows}");
    }
}

/// Minutes of 960 samples, of 6000, and a part of the last one.
#[test]
fn a_sample_lost_from_a_long_stamp_is_one_sample() {
    for (rate_hz, each) in [(16.0, 960), (100.0, 6000)] {
        let row = |i: u32| format!("9,94,100,{},{}\n", 1200 + i / each, i % 7);
        let options = LogOptions { rate_hz: Some(rate_hz), ..LogOptions::default() };
        for lost in [9 * each / 2, 54 * each / 10] {
            let rows = || (0..63 * each / 10).filter(|&i| i != lost);
            let text = rows().map(row).collect::<String>();
            let samples = samples(&mut open(text.as_bytes(), &options).unwrap()).unwrap();
            let jumps = indices(&samples).windows(2).filter(|w| w[1] != w[0] + 1).count();
            let last = samples.last().map(|sample| sample.raw.index);
            assert_eq!((last, jumps), (rows().next_back(), 1), "{rate_hz} {lost}");
        }
    }
}

fn toa5(rows: impl Iterator<Item = (u32, u32)>) -> String {
    let header = "\"TOA5\",\"CR3000\",\"CR3000\",\"1\",\"Std\",\"x.CR3\",\"2\",\"Fast\"\r\n\
        \"TIMESTAMP\",\"RECORD\",\"Batt\",\"Pull\"\r\n\"TS\",\"RN\",\"Volts\",\"kN\"\r\n\
        \"\",\"\",\"Min\",\"Smp\"\r\n";
    let row = |(i, record): (u32, u32)| {
        let (second, fraction) = (i / 16, f64::from(i % 16) / 16.0);
        let second = f64::from(second % 60) + fraction;
        format!("\"2012-12-31 23:59:{second:07.4}\",{record},12.5,\"NAN\"\r\n")
    };
    header.to_string() + &rows.map(row).collect::<String>()
}

#[test]
fn toa5_finds_force_by_its_unit_and_time_by_its_stamps() {
    let (log, samples) = read(&toa5((0..900).map(|i| (i, i))));
    assert_eq!((log.format(), log.rate_hz()), (Format::Toa5, 16.0));
    assert!(consecutive(&samples));
    assert_eq!(samples[0].time_s, 0.0);
    assert!((samples[899].time_s - 899.0 / 16.0).abs() < 1e-6);
    assert_eq!(samples[0].raw.reading, Reading::Bad(Fault::Sentinel));
}

#[test]
fn toa5_gaps_by_stamps_or_by_record_numbers() {
    let both = toa5((0..900).filter(|i| !(100..150).contains(i)).map(|i| (i, i)));
    assert_eq!(read(&both).1.last().unwrap().raw.index, 899);
    let stamps_only =
        toa5((0..900).filter(|i| !(100..150).contains(i)).enumerate().map(|(n, i)| (i, n as u32)));
    assert_eq!(read(&stamps_only).1.last().unwrap().raw.index, 899);
    // A jump of the numbers beside stamps that run on loses no row behind it.
    let jumped = toa5((0..900).map(|i| (i, if i < 400 { i } else { i + 200 })));
    let (log, samples) = read(&jumped);
    assert!(
        samples.iter().zip(0..).all(|(it, i)| it.raw.index == i + if i < 400 { 0 } else { 200 })
    );
    assert_eq!(log.warnings(), ["1 time stamps do not fit 16 samples per second"]);
    let restarted = toa5((0..900).map(|i| (i, i % 500)));
    assert!(consecutive(&read(&restarted).1));
}

/// Gives its bytes one to seven at a time.
struct Dribble(std::io::Cursor<Vec<u8>>, usize);

impl Read for Dribble {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.1 = self.1 % 7 + 1;
        let most = self.1.min(buffer.len());
        self.0.read(&mut buffer[..most])
    }
}

fn never_panics(content: &[u8], options: &LogOptions) {
    let whole = open(content, options).and_then(|mut log| Ok((samples(&mut log)?, log.warnings())));
    let input = Dribble(std::io::Cursor::new(content.to_vec()), 0);
    let dribbled = Log::from_reader(Box::new(input), options)
        .map_err(|e| e.to_string())
        .and_then(|mut log| Ok((samples(&mut log)?, log.warnings())));
    assert_eq!(whole, dribbled);
    if let Err(message) = whole {
        assert!(!message.is_empty() && !message.contains('\n'), "{message}");
    }
}

fn any_options() -> impl Strategy<Value = LogOptions> {
    let formats =
        prop::option::of(prop::sample::select(vec![Format::Csv, Format::Toa5, Format::Cr10]));
    let columns = prop::option::of(prop::sample::select(vec!["force_n", "6", "a"]));
    let rates = prop::option::of(prop::sample::select(vec![1.0, 16.0, 2000.0, -1.0, f64::NAN]));
    (formats, columns, rates).prop_map(|(format, column, rate_hz)| LogOptions {
        format,
        column: column.map(str::to_string),
        rate_hz,
        ..LogOptions::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_bytes_are_read_or_refused(
        content in prop::collection::vec(any::<u8>(), 0..2000), options in any_options()
    ) {
        never_panics(&content, &options);
    }

    #[test]
    fn anything_like_a_log_is_read_or_refused(
        header in prop::sample::select(vec![
            "time_s,force_n\n", "t;force_kn\n", "# weight_n: 5\nt,a,force_n\n", "",
            "\"TOA5\",\"a\"\n\"TIMESTAMP\",\"RECORD\",\"force_n\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\",\"\"\n",
        ]),
        rows in "([0-9.,;\"#-]{0,12}\r?\n|[0-9]{1,3},94,1,1200,[0-9]{1,2},[0-9]{1,3}\n|(nan|inf|1e400),-?6999\n){0,60}",
        options in any_options(),
    ) {
        never_panics(format!("{header}{rows}").as_bytes(), &options);
    }

    #[test]
    fn any_numbers_are_read_or_refused(
        rows in prop::collection::vec((any::<f64>(), any::<f64>()), 0..50), sorted in any::<bool>()
    ) {
        let mut rows = rows;
        if sorted {
            rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let rows: String = rows.iter().map(|(t, f)| format!("{t:e},{f:e}\n")).collect();
        never_panics(format!("t,force_n\n{rows}").as_bytes(), &LogOptions::default());
    }
}

/// A rate that a logger is set to is hardly ever the one it keeps.
#[test]
fn a_rate_that_is_only_called_so_gives_way_to_the_one_of_the_stamps() {
    let log_of = |head: &str, rate_hz: f64, late_s: f64| {
        let stamp = |i: u32| f64::from(i) / rate_hz + if i < 900 { 0.0 } else { late_s };
        let rows = (0..1920).map(|i| format!("{:.4},{}\n", stamp(i), i % 40));
        format!("{head}time_s,force_n\n{}", rows.collect::<String>())
    };
    for own_hz in [16.005, 16.1] {
        let (log, samples) = read(&log_of("# rate_hz: 16\n", own_hz, 0.0));
        assert!((log.rate_hz() - own_hz).abs() < 1e-4 && consecutive(&samples), "{own_hz}");
        let said =
            format!("come {own_hz:.4} times a second, and are taken so, not as '# rate_hz: 16'");
        assert!(log.warnings()[0].contains(&said), "{:?}", log.warnings());
        let given = LogOptions { rate_hz: Some(16.0), ..LogOptions::default() };
        let refused = open(log_of("", own_hz, 0.0).as_bytes(), &given).unwrap_err();
        assert!(refused.contains("--rate-hz says 16") && refused.contains("leave --rate-hz out"));
    }
    let (log, samples) = read(&log_of("# rate_hz: 16\n", 16.0, 0.0));
    assert!(log.rate_hz() == 16.0 && consecutive(&samples) && log.warnings().is_empty());
    // A clock that was set on the way tells no other rate.
    let (log, _) = read(&log_of("# rate_hz: 16\n", 16.0, 0.53));
    assert_eq!(log.rate_hz(), 16.0);
}
