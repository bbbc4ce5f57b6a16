//! Arbitrary bytes: read, or refused in one line.

use std::io::Read;

use floe::log::{Format, Log, LogOptions};
use proptest::prelude::*;

use super::{open, samples};

/// A reader that returns its bytes one to seven at a time.
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
