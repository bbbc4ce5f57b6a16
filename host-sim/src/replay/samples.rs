//! Every sample of a replay as a table: `--samples`.

use std::collections::VecDeque;
use std::io::{self, Write};

use floe_core::signal::derivative::{Central, Rate};
use floe_core::{Phase, SampleFlag, Step};
use parquet::errors::Result as ParquetResult;
use parquet::file::writer::SerializedFileWriter;

use crate::columnar::{self, Column, schema};

/// A column of the table.
type SampleColumn<'a> = Column<'a, &'a SampleRow>;

use Column::{Long, MaybeSingle, Number, Text};

impl SampleColumn<'_> {
    /// The columns, in CSV and in Parquet.
    const ALL: [(&'static str, Self); 7] = [
        ("time_s", Number(|row| row.time_s)),
        ("force_n", MaybeSingle(|row| row.force_n)),
        ("rate_n_per_s", MaybeSingle(|row| row.rate_n_per_s)),
        ("phase", Text(|row| row.phase)),
        ("block_m_per_s", MaybeSingle(|row| row.block_m_per_s)),
        ("flag", Text(|row| row.flag)),
        ("index", Long(|row| row.index.into())),
    ];
}

/// Numeric columns whose values hardly repeat.
const MEASURED: [&str; 4] = ["time_s", "rate_n_per_s", "block_m_per_s", "index"];
/// Samples held back until their rate is known and none can become a spike any more.
const HELD: usize = 4;
/// Rows in a group of a Parquet file.
const GROUP: usize = 1 << 18;

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRow {
    /// Number of the sampling period, from 0; numbers of missing samples are left out.
    pub index: u32,
    /// In the log's own time.
    pub time_s: f64,
    /// Force in the cable; `None` where there is no usable one.
    pub force_n: Option<f32>,
    /// Rate of the force, the central difference over ±1 sample.
    pub rate_n_per_s: Option<f32>,
    /// State of the block.
    pub phase: &'static str,
    /// Speed of the block, if the winch's speed `w` is known, with the loading rate `k w` of the
    /// last complete event: `w (1 - F' / (k w))` during a slip, 0 at rest while the force rises. A
    /// constant force may be that of a held cable or of a block that slides at constant speed.
    pub block_m_per_s: Option<f32>,
    /// Classification of the sample.
    pub flag: &'static str,
}

/// Builder of rows from the steps of the core.
#[derive(Debug)]
pub struct SampleRows {
    winch_m_per_s: Option<f32>,
    rate_hz: f32,
    loading_rate_n_per_s: Option<f32>,
    /// Rate of the force in the last second of a rest.
    rising_n_per_s: Option<f32>,
    held: VecDeque<SampleRow>,
}

impl SampleRows {
    /// A builder before the first sample.
    #[must_use]
    pub fn new(winch_m_per_s: Option<f32>, rate_hz: f32) -> Self {
        Self {
            winch_m_per_s,
            rate_hz,
            loading_rate_n_per_s: None,
            rising_n_per_s: None,
            held: VecDeque::new(),
        }
    }

    /// Takes a sample; returns a row that has become complete.
    pub fn push(&mut self, time_s: f64, step: &Step) -> Option<SampleRow> {
        let good = step.sample.flag == SampleFlag::Good;
        self.held.push_back(SampleRow {
            index: step.sample.index,
            time_s,
            force_n: step.sample.force_n.filter(|force| good && force.is_finite()),
            rate_n_per_s: None,
            phase: phase(step.phase),
            block_m_per_s: None,
            flag: flag(step.sample.flag),
        });
        if let Some(spike) = step.spike.and_then(|index| self.row(index)) {
            (spike.force_n, spike.flag) = (None, flag(SampleFlag::Spike));
        }
        if let Some(rate) = step.rate {
            self.take_rate(rate);
        }
        if let Some(event) = &step.event {
            self.loading_rate_n_per_s = Some(event.loading_rate_n_per_s);
        }
        if self.held.len() > HELD { self.held.pop_front() } else { None }
    }

    /// The rows still held at the end. Their last rates are computed here, since no further sample
    /// can show that the newest one is a spike.
    pub fn finish(mut self) -> impl Iterator<Item = SampleRow> {
        let mut derivative = Central::new(self.rate_hz);
        let forces = self.held.iter().filter_map(|row| Some((row.index, row.force_n?)));
        let rates: Vec<_> = forces.filter_map(|(i, force_n)| derivative.step(i, force_n)).collect();
        for rate in rates {
            if self.row(rate.index).is_some_and(|row| row.rate_n_per_s.is_none()) {
                self.take_rate(rate);
            }
        }
        self.held.into_iter()
    }

    fn row(&mut self, index: u32) -> Option<&mut SampleRow> {
        self.held.iter_mut().find(|row| row.index == index && row.flag != "duplicate")
    }

    fn take_rate(&mut self, Rate { index, rate_n_per_s, .. }: Rate) {
        let Some(phase) = self.row(index).map(|row| row.phase) else { return };
        let speed = self.block_speed(phase, rate_n_per_s);
        if let Some(row) = self.row(index) {
            row.rate_n_per_s = Some(rate_n_per_s).filter(|rate| rate.is_finite());
            row.block_m_per_s = speed;
        }
    }

    fn block_speed(&mut self, phase: &str, rate_n_per_s: f32) -> Option<f32> {
        let before = self.rising_n_per_s.take();
        let loading = self.loading_rate_n_per_s.filter(|&rate| rate > 0.0)?;
        let winch = self.winch_m_per_s?;
        let speed = match phase {
            "slip" => winch * (1.0 - rate_n_per_s / loading),
            "stick" => {
                // The first rate is partly that of the slip.
                let risen = before.map_or(loading, |it| it + (rate_n_per_s - it) / self.rate_hz);
                self.rising_n_per_s = Some(risen);
                // So is the last one.
                return (before.unwrap_or(loading) > 0.5 * loading).then_some(0.0);
            }
            _ => return None,
        };
        Some(speed).filter(|speed| speed.is_finite())
    }
}

fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Unknown => "unknown",
        Phase::Stick => "stick",
        Phase::Slip => "slip",
    }
}

fn flag(flag: SampleFlag) -> &'static str {
    match flag {
        SampleFlag::Good => "good",
        SampleFlag::Saturated => "saturated",
        SampleFlag::Rejected => "rejected",
        SampleFlag::Spike => "spike",
        SampleFlag::Duplicate => "duplicate",
    }
}

/// A table file of rows.
pub trait Table {
    /// Writes a row.
    ///
    /// # Errors
    /// Errors of the writer.
    fn row(&mut self, row: SampleRow) -> io::Result<()>;

    /// Ends the file.
    ///
    /// # Errors
    /// Errors of the writer.
    fn finish(&mut self) -> io::Result<()>;
}

/// A table for a file of this name: Parquet if the name ends so, else CSV. `about` goes into the
/// Parquet file's metadata.
///
/// # Errors
/// Errors of the writer.
pub fn table<'a, W: Write + Send + 'a>(
    out: W,
    parquet: bool,
    about: &[(&str, String)],
) -> io::Result<Box<dyn Table + 'a>> {
    if parquet {
        return Ok(Box::new(Parquet::new(out, about).map_err(columnar::io_error)?));
    }
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(SampleColumn::ALL.map(|(name, _)| name)).map_err(io::Error::other)?;
    Ok(Box::new(Csv(writer)))
}

struct Csv<W: Write>(csv::Writer<W>);

impl<W: Write> Table for Csv<W> {
    fn row(&mut self, row: SampleRow) -> io::Result<()> {
        let SampleRow { index, time_s, force_n, rate_n_per_s, phase, block_m_per_s, flag } = row;
        let cells = (time_s, force_n, rate_n_per_s, phase, block_m_per_s, flag, index);
        self.0.serialize(cells).map_err(io::Error::other)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

struct Parquet<W: Write + Send> {
    writer: Option<SerializedFileWriter<W>>,
    rows: Vec<SampleRow>,
}

impl<W: Write + Send> Parquet<W> {
    fn new(out: W, about: &[(&str, String)]) -> ParquetResult<Self> {
        let properties = columnar::properties(about, MEASURED.into_iter());
        let writer =
            SerializedFileWriter::new(out, schema("sample", &SampleColumn::ALL)?, properties)?;
        Ok(Self { writer: Some(writer), rows: Vec::new() })
    }

    fn write_group(&mut self) -> ParquetResult<()> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let mut group = writer.next_row_group()?;
        SampleColumn::ALL
            .iter()
            .try_for_each(|(_, column)| column.write(&mut group, self.rows.iter()))?;
        self.rows.clear();
        group.close().map(drop)
    }
}

impl<W: Write + Send> Table for Parquet<W> {
    fn row(&mut self, row: SampleRow) -> io::Result<()> {
        self.rows.push(row);
        if self.rows.len() < GROUP {
            return Ok(());
        }
        self.write_group().map_err(columnar::io_error)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.write_group().map_err(columnar::io_error)?;
        let closed = self.writer.take().map_or(Ok(()), |writer| writer.close().map(drop));
        closed.map_err(columnar::io_error)
    }
}
