//! Campbell's logs: mixed arrays and TOA5.

use floe::log::{Format, LogOptions};
use floe_core::{Fault, Newtons, Reading};

use super::{consecutive, indices, open, read, samples};

/// A log of a CR10 at 16 Hz, from `start_s` into day `day` of `year`: two scans per stamp.
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
    // A second scan with the next stamp, and a first scan with the previous one.
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

/// Loggers whose clock is finer than the CR10's.
#[test]
fn seconds_in_tenths_and_hundredths_are_no_forces() {
    for (rate_hz, clock) in [(10, 10), (16, 10), (16, 100), (100, 100), (1, 1)] {
        let row = |i: u32| {
            let (minutes, steps) = (i / rate_hz / 60, i * clock / rate_hz % (60 * clock));
            let (second, force_n) = (f64::from(steps) / f64::from(clock), 100 + i % 7);
            format!("101,12,74,{},{second},{force_n}\n", 1200 + minutes)
        };
        let (log, samples) = read(&(0..3000).map(row).collect::<String>());
        assert_eq!(log.rate_hz(), f64::from(rate_hz), "{clock}");
        assert!(consecutive(&samples), "{rate_hz} {clock}");
        assert_eq!(samples[5].raw.reading, Reading::Force(Newtons(105.0)));
    }
}

/// A force that rises and never falls, through three minutes.
#[test]
fn a_force_that_runs_on_through_the_minutes_is_no_time() {
    let row =
        |i: u32| format!("101,12,74,{},{},12.5\n", 1200 + i / 960, 5.0 + f64::from(i) * 0.013);
    let (log, samples) = read(&(0..2800).map(row).collect::<String>());
    assert_eq!(log.rate_hz(), 16.0);
    assert_eq!(samples[100].raw.reading, Reading::Force(Newtons(6.3)));
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
    // A jump of the record numbers loses no row if the stamps continue.
    let jumped = toa5((0..900).map(|i| (i, if i < 400 { i } else { i + 200 })));
    let (log, samples) = read(&jumped);
    assert!(
        samples.iter().zip(0..).all(|(it, i)| it.raw.index == i + if i < 400 { 0 } else { 200 })
    );
    assert_eq!(log.warnings(), ["1 time stamps do not fit 16 samples per second"]);
    let restarted = toa5((0..900).map(|i| (i, i % 500)));
    assert!(consecutive(&read(&restarted).1));
}

/// Numbers that thinning has left out are no lost samples; a larger step still is a gap.
#[test]
fn toa5_that_was_thinned_has_no_gaps() {
    let thinned = |lost: u32| toa5((0..900).filter(|i| i % 2 == 0 && *i != lost).map(|i| (i, i)));
    let (log, samples) = read(&thinned(1));
    assert!(consecutive(&samples));
    assert_eq!((log.rate_hz(), log.warnings()), (8.0, Vec::new()));
    let indices = indices(&read(&thinned(600)).1);
    assert_eq!((indices[299], indices[300], indices.len()), (299, 301, 449));
}

#[test]
fn lines_that_end_with_cr_alone_are_recognised_below_a_comment() {
    let with_cr =
        |text: &str| format!("# test_id: A\n{text}").replace("\r\n", "\n").replace('\n', "\r");
    let (log, samples) = read(&with_cr(&toa5((0..900).map(|i| (i, i)))));
    assert_eq!((log.format(), samples.len()), (Format::Toa5, 900));
    let (log, samples) = read(&with_cr(&cr10(1994, 100, 43_200, 365, 900).concat()));
    assert_eq!((log.format(), samples.len()), (Format::Cr10, 900));
}

#[test]
fn a_unit_above_a_cr10_log_is_one_for_the_command() {
    let text = format!("# unit: kN\n{}", cr10(1994, 100, 43_200, 365, 90).concat());
    let error = open(text.as_bytes(), &LogOptions::default()).unwrap_err();
    assert!(error.starts_with("line 1: '# unit: kN'") && error.contains("give --unit"), "{error}");
    let options = LogOptions { unit: Some(floe::log::Unit::Kilonewton), ..LogOptions::default() };
    assert!(open(text.as_bytes(), &options).is_ok());
}
