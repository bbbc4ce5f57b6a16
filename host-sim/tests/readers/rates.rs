//! Sampling rates: from the stamps, from the log or from the caller.

use floe::log::{Log, LogOptions};

use super::{consecutive, indices, open, read, samples};

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

/// With the seconds alone a lost row would be a gap somewhere in its second.
#[test]
fn parts_of_a_second_in_their_own_column_say_where_rows_are_lost() {
    let kept: Vec<u32> = (0..400).filter(|row| row % 37 != 5 && row % 41 != 7).collect();
    let ros = |row: u32| format!("{},{}", 1_330_516_800 + row / 16, row % 16 * 62_500_000);
    let date = |row: u32| format!("2012-02-29 12:00:{:02},{}", row / 16, row % 16 * 125 / 2);
    let clock = |row: u32| format!("29.02.2012,12:00:{:02},{}", row / 16, row % 16 * 62_500);
    let forms: [(&str, &dyn Fn(u32) -> String); 3] =
        [("secs,nsecs", &ros), ("Time,msec", &date), ("Date,Time,us", &clock)];
    for (names, time) in forms {
        let row = |row: &u32| format!("{},{}\n", time(*row), row % 97);
        let text = format!("{names},force_n\n{}", kept.iter().map(row).collect::<String>());
        let (log, placed) = read(&text);
        assert_eq!(indices(&placed), kept, "{names}");
        let [note] = &log.warnings()[..] else { panic!("{:?}", log.warnings()) };
        assert!(note.contains("within the seconds of column"), "{note}");
        let wrong = text.replacen(&time(300), &time(300).replace(",750", ",7500000"), 1);
        let log = open(wrong.as_bytes(), &LogOptions::default());
        let error = log.and_then(|mut log| samples(&mut log)).unwrap_err();
        assert!(error.contains("no part of a second; correct the line"), "{names}: {error}");
    }
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

/// The rate set in a logger is rarely its true rate.
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
    // A clock that was set during the record does not change the rate.
    let (log, _) = read(&log_of("# rate_hz: 16\n", 16.0, 0.53));
    assert_eq!(log.rate_hz(), 16.0);
}

/// Samples slightly faster or slower than the last digit of their stamps, which is rounded to
/// nearest or down.
#[test]
fn a_rate_near_that_of_the_last_digit_is_that_of_all_stamps() {
    for (rate_hz, up) in [
        (98.0, 0.0),
        (99.0, 0.5),
        (100.5, 0.5),
        (102.0, 0.5),
        (103.0, 0.0),
        (104.0, 0.5),
        (105.0, 0.0),
    ] {
        let stamp = |i: u32| (f64::from(i) / rate_hz * 100.0 + up).floor() / 100.0;
        let row = |i: u32| format!("{:.2},{}\n", stamp(i), i % 40);
        let log_of = |lost: u32| {
            let rows = (0..6000).filter(|&i| i != lost).map(row);
            format!("time_s,force_n\n{}", rows.collect::<String>())
        };
        let (log, all) = read(&log_of(6000));
        assert!((log.rate_hz() / rate_hz - 1.0).abs() < 3e-5 && consecutive(&all), "{rate_hz}");
        let said =
            if rate_hz < 100.0 { "is left out, evenly: taken for the digits of" } else { "" };
        let all_said = |log: &Log| {
            let warnings = log.warnings();
            warnings.iter().all(|it| it.contains(said)) && warnings.is_empty() == said.is_empty()
        };
        assert!(all_said(&log), "{rate_hz}: {:?}", log.warnings());
        let (log, samples) = read(&log_of(2500));
        assert!((log.rate_hz() / rate_hz - 1.0).abs() < 3e-5, "{rate_hz}: {}", log.rate_hz());
        assert_eq!(samples.last().unwrap().raw, all.last().unwrap().raw);
        assert!(all_said(&log), "{rate_hz}: {:?}", log.warnings());
    }
    let row = |i: u32| format!("{:.2},{}\n", f64::from(i) / 101.0, i % 40);
    let rows = (0..6000).map(row).collect::<String>();
    let (log, samples) = read(&format!("# rate_hz: 100\ntime_s,force_n\n{rows}"));
    assert!((log.rate_hz() / 101.0 - 1.0).abs() < 3e-5 && consecutive(&samples));
    assert!(log.warnings()[0].contains("and are taken so, not as '# rate_hz: 100' in line 1"));
    let given = LogOptions { rate_hz: Some(100.0), ..LogOptions::default() };
    let refused = open(format!("time_s,force_n\n{rows}").as_bytes(), &given).unwrap_err();
    assert!(refused.contains("leave --rate-hz out"), "{refused}");
}

/// 1000 samples a second with the ticks of a clock of 15.625 ms, in whole milliseconds.
#[test]
fn stamps_rounded_between_ticks_lose_no_sample() {
    let tick = |i: u32| (f64::from(i) / 15.625).floor() * 15.625;
    let row = |i: u32| format!("{:.3},{}\n", tick(i).floor() / 1e3, i % 997);
    let text = "time_s,force_n\n".to_string() + &(0..4096).map(row).collect::<String>();
    let (log, samples) = read(&text);
    assert_eq!(log.rate_hz(), 1000.0);
    assert!(consecutive(&samples));
}

#[test]
fn a_rate_that_cannot_be_is_named_with_its_line() {
    let error = open(b"# rate_hz: 0\nt,force_n\n0,1\n0.125,2\n", &LogOptions::default());
    assert_eq!(
        error.map(|_| ()).unwrap_err(),
        "line 1: '# rate_hz:': a rate of 0 Hz is not within 1 to 2000"
    );
}

/// Hundredths cut off from a binary number: 0.28 stands twice, and 0.29 never.
#[test]
fn no_stamp_is_said_to_be_left_out_at_the_rate_of_the_last_digit() {
    let cut = |i: u32| (f64::from(i) / 100.0 * 100.0).floor() / 100.0;
    let row = |i: u32| format!("{:.2},{}\n", cut(i), i % 997);
    let text = "time_s,force_n\n".to_string() + &(0..1500).map(row).collect::<String>();
    let said = read(&text).0.warnings().concat();
    assert!(!said.contains("is left out, evenly"), "{said}");
}

/// Rows that are lost and rows that are repeated say nothing against the rate; stamps of which every
/// second one is left out at random do.
#[test]
fn lost_and_repeated_rows_make_no_rate_doubtful() {
    let doubts = |is_lost: fn(u32) -> bool, is_twice: fn(u32) -> bool| {
        let row = |i: u32| {
            format!("{},{}\n", f64::from(i) / 16.0, 100 + i % 7)
                .repeat(1 + usize::from(is_twice(i)))
        };
        let rows = (0..4000).filter(|&i| !is_lost(i)).map(row);
        let (log, _) = read(&("time_s,force_n\n".to_string() + &rows.collect::<String>()));
        log.warnings().concat()
    };
    assert_eq!(doubts(|i| i % 29 == 5, |i| i % 37 == 6), "");
    let half = doubts(|i| i.wrapping_mul(2_654_435_761) >> 31 == 0, |_| false);
    assert!(half.contains("many samples are missing and as many are dropped"), "{half}");
}
