//! A Parquet table of all events: one row per event, with the data of its test repeated in every
//! row.

use std::io::Write;

use parquet::errors::Result;
use parquet::file::writer::SerializedFileWriter;

use super::{EventRecord, TestRecord, simulated};
use crate::columnar::{self, Column, schema};

/// Schema of the table, in its metadata: `index` has its name in JSON, a missing reason is null.
pub const SCHEMA: &str = "floe-events/2";

/// Events in a row group.
const GROUP: usize = 20_000;

/// A row: an event and its test.
type Row<'a> = (&'a TestRecord, &'a EventRecord);

/// A column of the table.
type EventColumn<'a> = Column<'a, Row<'a>>;

use Column::{Integer, Maybe, MaybeText, Number, Text, Truth};

impl<'a> EventColumn<'a> {
    /// The columns. Names, with their units, are those of a replay's JSON; an interval has its two ends
    /// in separate columns, as in the CSV of events.
    const ALL: [(&'static str, Self); 46] = [
        ("campaign", Integer(|(t, _)| integer(t.campaign))),
        ("test", Integer(|(t, _)| integer(t.test))),
        ("test_id", Text(|(t, _)| &t.test_id)),
        ("weight_n", Number(|(t, _)| t.weight_n)),
        ("winch_m_per_s", Maybe(|(t, _)| t.winch_m_per_s)),
        ("slope_rad", Number(|(t, _)| t.slope_rad)),
        ("snow_mm", Maybe(|(t, _)| t.snow_mm)),
        ("index", Integer(|(_, e)| integer(e.measured.index))),
        ("onset_s", Number(|(_, e)| e.measured.onset_s)),
        ("stop_s", Number(|(_, e)| e.measured.stop_s)),
        ("static_force_n", Number(|(_, e)| e.measured.static_force_n)),
        ("dynamic_force_n", Number(|(_, e)| e.measured.dynamic_force_n)),
        ("peak_force_n", Number(|(_, e)| e.measured.peak_force_n)),
        ("restick_force_n", Number(|(_, e)| e.measured.restick_force_n)),
        ("mu_s", Maybe(|(_, e)| e.measured.mu_s)),
        ("mu_s_std", Maybe(|(_, e)| e.measured.mu_s_std)),
        ("mu", Maybe(|(_, e)| e.measured.mu)),
        ("mu_std", Maybe(|(_, e)| e.measured.mu_std)),
        ("stick_s", Maybe(|(_, e)| e.measured.stick_s)),
        ("slip_s", Number(|(_, e)| e.measured.slip_s)),
        ("loading_rate_n_per_s", Number(|(_, e)| e.measured.loading_rate_n_per_s)),
        ("omega_rad_per_s", Maybe(|(_, e)| e.measured.omega_rad_per_s)),
        ("slack", Truth(|(_, e)| e.measured.slack)),
        ("quality", Text(|(_, e)| &e.measured.quality)),
        ("reason", MaybeText(|(_, e)| e.measured.reason.as_deref())),
        ("true_mu_s", Maybe(|(_, e)| e.true_mu_s)),
        ("true_mu", Maybe(|(_, e)| e.true_mu)),
        ("mu_s_systematic_std", Maybe(|(_, e)| e.measured.mu_s_systematic_std)),
        ("mu_systematic_std", Maybe(|(_, e)| e.measured.mu_systematic_std)),
        ("mu_s_combined_std", Maybe(|(_, e)| e.measured.mu_s_combined_std)),
        ("mu_combined_std", Maybe(|(_, e)| e.measured.mu_combined_std)),
        ("mu_s_ci95_low", Maybe(|(_, e)| e.measured.mu_s_ci95.map(|[low, _]| low))),
        ("mu_s_ci95_high", Maybe(|(_, e)| e.measured.mu_s_ci95.map(|[_, high]| high))),
        ("mu_ci95_low", Maybe(|(_, e)| e.measured.mu_ci95.map(|[low, _]| low))),
        ("mu_ci95_high", Maybe(|(_, e)| e.measured.mu_ci95.map(|[_, high]| high))),
        ("slip_length_m", Maybe(|(_, e)| e.measured.slip_length_m)),
        ("energy_j", Maybe(|(_, e)| e.measured.energy_j)),
        ("onset_time", MaybeText(|(_, e)| e.measured.onset_time.as_deref())),
        ("kind", MaybeText(|(t, _)| t.kind.as_deref())),
        ("track", MaybeText(|(t, _)| t.track.as_deref())),
        ("cable_length_m", Maybe(|(t, _)| t.cable_length_m)),
        ("start_time", MaybeText(|(t, _)| t.start_time.as_deref())),
        ("temperature_c", Maybe(|(t, _)| t.temperature_c)),
        ("supply_v", Maybe(|(t, _)| t.supply_v)),
        ("slip_length_m_std", Maybe(|(_, e)| e.measured.slip_length_m_std)),
        ("energy_j_std", Maybe(|(_, e)| e.measured.energy_j_std)),
    ];
}

/// Columns whose value is the same in all events of a test.
const OF_TEST: [&str; 7] = [
    "weight_n",
    "winch_m_per_s",
    "slope_rad",
    "snow_mm",
    "cable_length_m",
    "temperature_c",
    "supply_v",
];

fn integer(value: u32) -> i32 {
    value.try_into().unwrap_or(i32::MAX)
}

/// Numeric columns whose value differs between events.
fn measured() -> impl Iterator<Item = &'static str> {
    let is_number = |column: &EventColumn<'_>| matches!(column, Number(_) | Maybe(_));
    let own = EventColumn::ALL.into_iter();
    let own = own.filter(move |(name, column)| is_number(column) && !OF_TEST.contains(name));
    own.map(|(name, _)| name)
}

/// Writer of tests and their events. Rows are gathered and written in groups.
pub struct EventTable<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    waiting: Vec<TestRecord>,
    events: usize,
    tests: usize,
    synthetic_tests: usize,
}

impl<W: Write + Send> std::fmt::Debug for EventTable<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EventTable").field("events", &self.events).finish_non_exhaustive()
    }
}

impl<W: Write + Send> EventTable<W> {
    /// Begins the file; `about` is added to its metadata, after the schema and the version.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn new(out: W, about: &[(&str, String)]) -> Result<Self> {
        let about = [&[("schema", SCHEMA.to_string())], about].concat();
        let properties = columnar::properties(&about, measured());
        let writer =
            SerializedFileWriter::new(out, schema("event", &EventColumn::ALL)?, properties)?;
        Ok(Self { writer, waiting: Vec::new(), events: 0, tests: 0, synthetic_tests: 0 })
    }

    /// Adds a test with its events.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn push(&mut self, test: TestRecord) -> Result<()> {
        self.events += test.events.len();
        self.tests += 1;
        self.synthetic_tests += usize::from(test.synthetic.is_some());
        self.waiting.push(test);
        if self.events >= GROUP { self.write_group() } else { Ok(()) }
    }

    /// Ends the file; its metadata state whether a test was simulated.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn finish(mut self) -> Result<()> {
        self.write_group()?;
        if let Some(said) = simulated(self.synthetic_tests, self.tests) {
            self.writer.append_key_value_metadata(columnar::entry("synthetic", said));
        }
        self.writer.close().map(|_| ())
    }

    fn write_group(&mut self) -> Result<()> {
        let rows: Vec<Row<'_>> = self
            .waiting
            .iter()
            .flat_map(|test| test.events.iter().map(move |e| (test, e)))
            .collect();
        let mut group = self.writer.next_row_group()?;
        EventColumn::ALL
            .iter()
            .try_for_each(|(_, column)| column.write(&mut group, rows.iter().copied()))?;
        group.close()?;
        self.waiting.clear();
        self.events = 0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    use super::*;
    use crate::campaign::programme;

    fn table(tests: &[TestRecord]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut table = EventTable::new(&mut bytes, &[("seed", 1.to_string())]).unwrap();
        for test in tests {
            table.push(test.clone()).unwrap();
        }
        table.finish().unwrap();
        bytes
    }

    #[test]
    fn the_table_reads_back_as_it_was_written() {
        let tests: Vec<_> = (0..3).map(|i| programme::evaluate(1, 0, i).unwrap()).collect();
        let reader = SerializedFileReader::new(bytes::Bytes::from(table(&tests))).unwrap();
        let events = tests.iter().flat_map(|t| t.events.iter().map(move |e| (t, e)));
        let mut rows = reader.get_row_iter(None).unwrap();
        for (test, event) in events {
            let row = rows.next().unwrap().unwrap();
            assert_eq!(row.get_int(1).unwrap(), test.test as i32);
            assert_eq!(row.get_string(2).unwrap(), &test.test_id);
            assert_eq!(row.get_double(8).unwrap().to_bits(), event.measured.onset_s.to_bits());
            assert_eq!(row.get_double(16).ok(), event.measured.mu);
            assert_eq!(row.get_string(23).unwrap(), &event.measured.quality);
            assert_eq!(row.get_string(24).ok(), event.measured.reason.as_ref());
            assert_eq!(row.get_double(26).ok(), event.true_mu);
        }
        assert!(rows.next().is_none());
    }

    fn said(tests: &[TestRecord], key: &str) -> Option<String> {
        let reader = SerializedFileReader::new(bytes::Bytes::from(table(tests))).unwrap();
        let said = reader.metadata().file_metadata().key_value_metadata().unwrap();
        said.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.clone())
    }

    #[test]
    fn the_metadata_say_what_it_is() {
        assert_eq!(said(&[], "floe.schema").as_deref(), Some(SCHEMA));
        assert_eq!(said(&[], "floe.version").as_deref(), Some(env!("CARGO_PKG_VERSION")));
        assert_eq!(said(&[], "floe.seed").as_deref(), Some("1"));
        let simulated = programme::evaluate(1, 0, 0).unwrap();
        let measured = TestRecord { synthetic: None, ..simulated.clone() };
        for (tests, expected) in [
            (vec![measured.clone()], None),
            (vec![simulated.clone()], Some("computed, not measured")),
            (vec![measured, simulated], Some("1 of 2 tests, computed, not measured")),
        ] {
            assert_eq!(said(&tests, "floe.synthetic").as_deref(), expected);
        }
    }

    /// Every field of an event in JSON is a column, or an interval's two columns.
    #[test]
    fn the_names_are_those_of_json() {
        let event = programme::evaluate(1, 0, 0).unwrap().events.remove(0).measured;
        let json = serde_json::to_value(event).unwrap();
        let is_column = |name: &str| EventColumn::ALL.iter().any(|(column, _)| *column == name);
        for name in json.as_object().unwrap().keys() {
            let ends = ["low", "high"].map(|end| format!("{name}_{end}"));
            assert!(is_column(name) || ends.iter().all(|end| is_column(end)), "{name}");
        }
    }

    #[test]
    fn a_table_without_events_is_a_table() {
        let reader = SerializedFileReader::new(bytes::Bytes::from(table(&[]))).unwrap();
        assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
        let columns = reader.metadata().file_metadata().schema_descr().num_columns();
        assert_eq!(columns, EventColumn::ALL.len());
    }
}
