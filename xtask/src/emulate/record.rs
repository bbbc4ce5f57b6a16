//! A log converted to codes of the load cell, one per sampling period.

use std::fs::File;
use std::io::Cursor;
use std::path::Path;

use floe::chip::{LoadCell, Schedule, Trouble};
use floe::cli::simulate::read_scene;
use floe::log::{Log, LogOptions};
use floe::replay::test::{TestOptions, configure};
use floe::sim::{Run, write};
use floe_core::{Calibration, Config, Reading};
use floe_firmware::settings::NAME_LEN;

use crate::Result;

/// Sampling rate of the board, Hz.
pub const RATE_HZ: f64 = 16.0;
/// Largest force of a log as a fraction of the converter's range.
const HEADROOM: f64 = 0.5;
/// Standard deviation of the converter's noise, in codes, and its seed.
pub const NOISE: (f64, u64) = (12.0, 20_260_321);

/// Input of the load cell for a run.
#[derive(Clone, Debug)]
pub struct Record {
    /// Format of the log.
    pub format: &'static str,
    /// Name of the test.
    pub test_id: Option<String>,
    /// Configuration of the core, including the calibration of the load cell.
    pub config: Config,
    /// Code in every sampling period; `None` where the log has no value.
    pub codes: Vec<Option<i32>>,
    /// Time of every period in the log, s.
    pub times_s: Vec<f64>,
    /// Additional faults of the converter.
    pub trouble: Schedule,
}

impl Record {
    /// Reads a log, and chooses a load cell with a suitable range.
    ///
    /// # Errors
    /// The log cannot be read, or its rate is not that of the board.
    pub fn read(path: &Path, format: &LogOptions, options: &TestOptions) -> Result<Self> {
        let place = path.display();
        let input: Box<dyn std::io::Read + Send> = if is_scene(path) {
            Box::new(Cursor::new(simulated(path)?))
        } else {
            Box::new(File::open(path).map_err(|e| format!("{place}: {e}"))?)
        };
        let log = Log::from_reader(input, format);
        let mut log = log.map_err(|e| format!("{place}: {e}"))?;
        let config = configure(&log, options).map_err(|e| format!("{place}: {e}"))?;
        if (log.rate_hz() - RATE_HZ).abs() > 0.01 * RATE_HZ {
            let rate = log.rate_hz();
            return Err(format!("{place}: has {rate} samples per second, the board takes 16"));
        }
        let (readings, times_s) = read_all(&mut log).map_err(|e| format!("{place}: {e}"))?;
        let calibration = calibration(&readings, config.calibration);
        Ok(Self {
            format: log.format().name(),
            test_id: log.metadata().test_id.clone(),
            config: Config { calibration, ..config },
            codes: readings.iter().map(|&r| code(r, &calibration)).collect(),
            times_s,
            trouble: Schedule::default(),
        })
    }

    /// A minute of a 630 N block that sticks and slips every two seconds: the force rises for 28
    /// samples and falls for three.
    #[must_use]
    pub fn stick_slip() -> Self {
        let force = |i: u32| match i % 32 {
            phase @ 0..28 => 200.0 + 22.0 * f64::from(phase),
            28 => 700.0,
            29 => 480.0,
            30 => 260.0,
            _ => 205.0,
        };
        let mut config = Config { weight_n: 630.0, ..Config::default() };
        config.calibration.counts_per_n = 5000.0;
        Self {
            format: "csv",
            test_id: None,
            config,
            codes: (0..960).map(|i| Some((5000.0 * force(i)) as i32)).collect(),
            times_s: (0..960).map(|i| f64::from(i) / RATE_HZ).collect(),
            trouble: Schedule::default(),
        }
    }

    /// The load cell, and a converter that does not answer where the log has no value.
    #[must_use]
    pub fn load_cell(&self) -> (LoadCell, Schedule) {
        let (codes, trouble) = self.played();
        (LoadCell::from_codes(&codes, RATE_HZ).with_noise(NOISE.0, NOISE.1), trouble)
    }

    /// A code for every period, and the faults of the converter.
    #[must_use]
    pub fn played(&self) -> (Vec<i32>, Schedule) {
        let mut trouble = self.trouble.clone();
        let mut last = 0;
        let codes = (0..).zip(&self.codes).map(|(index, code)| {
            if code.is_none() {
                // The answer to a conversion comes in the next period.
                trouble = std::mem::take(&mut trouble).with(index + 1, index + 2, Trouble::Silent);
            }
            last = code.unwrap_or(last);
            last
        });
        (codes.collect(), trouble)
    }

    /// The record preceded by `samples` samples at rest.
    #[must_use]
    pub fn after_rest(&self, samples: usize) -> Self {
        let first = self.codes.iter().flatten().next().copied();
        let codes = std::iter::repeat_n(first, samples).chain(self.codes.iter().copied());
        let trouble = self.trouble.clone().later(samples as u64);
        Self { codes: codes.collect(), trouble, ..self.clone() }
    }

    /// Whether the log has gaps.
    #[must_use]
    pub fn has_gaps(&self) -> bool {
        self.codes.contains(&None)
    }

    /// The commands to type before the test.
    #[must_use]
    pub fn commands(&self) -> String {
        let Config { weight_n, slope_rad, winch_m_per_s, range_n, calibration, .. } = self.config;
        let mut lines = vec![
            format!("set weight {weight_n}"),
            format!("set slope {}", slope_rad.to_degrees()),
            format!("set tare {}", calibration.tare_counts),
            format!("set span {}", calibration.counts_per_n),
        ];
        lines.extend(winch_m_per_s.map(|w| format!("set winch {w}")));
        lines.extend(range_n.map(|r| format!("set range {r}")));
        lines.extend(self.test_id.iter().map(|name| format!("set name {}", board_name(name))));
        lines.join("\r\n") + "\r\n"
    }
}

/// The characters of a name that the board accepts.
fn board_name(name: &str) -> String {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    name.chars().take(NAME_LEN).map(|c| if fits(c) { c } else { '-' }).collect()
}

/// Whether a file is a scene instead of a log.
pub fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "toml")
}

/// The log of a scene, as written by `floe simulate`.
fn simulated(path: &Path) -> Result<Vec<u8>> {
    const SEED: u64 = 1;
    let failed = |e: &dyn ToString| format!("{}: {}", path.display(), e.to_string());
    let scene = read_scene(path, None).map_err(|e| failed(&e))?;
    let mut run = Run::new(&scene, SEED).map_err(|e| failed(&e))?;
    let mut text = Vec::new();
    let command = format!("floe simulate {} --seed {SEED}", path.display());
    write::csv_head(&mut text, &scene, SEED, &command).map_err(|e| failed(&e))?;
    let force_decimals = write::force_decimals(&scene);
    for sample in &mut run {
        write::csv_line(&mut text, force_decimals, &sample).map_err(|e| failed(&e))?;
    }
    run.failure().map_or(Ok(text), |why| Err(failed(&why)))
}

/// All periods from the first sample to the last, and their times.
fn read_all(log: &mut Log) -> Result<(Vec<Option<Reading>>, Vec<f64>)> {
    let (mut readings, mut times_s) = (Vec::new(), Vec::new());
    let mut first = None;
    while let Some(sample) = log.next_sample().map_err(|e| e.to_string())? {
        let first = *first.get_or_insert(sample.raw.index);
        let index = (sample.raw.index - first) as usize;
        while readings.len() < index {
            readings.push(None);
            times_s.push(sample.time_s - (index - times_s.len()) as f64 / RATE_HZ);
        }
        if readings.len() == index {
            readings.push(Some(sample.raw.reading));
            times_s.push(sample.time_s);
        }
    }
    Ok((readings, times_s))
}

fn calibration(readings: &[Option<Reading>], given: Calibration) -> Calibration {
    let force = |reading: &Option<Reading>| match reading {
        Some(Reading::Force(force)) if force.0.is_finite() => force.0.abs(),
        _ => 0.0,
    };
    let counts = readings.iter().any(|r| matches!(r, Some(Reading::Counts(_))));
    let largest = readings.iter().map(force).fold(0.0, f32::max);
    if counts || largest == 0.0 {
        return given;
    }
    let counts_per_n = (HEADROOM * f64::from(1 << 23) / f64::from(largest)).round() as f32;
    Calibration { tare_counts: 0, counts_per_n: counts_per_n.max(1.0), ..given }
}

fn code(reading: Option<Reading>, calibration: &Calibration) -> Option<i32> {
    match reading? {
        Reading::Counts(counts) => Some(counts.0),
        Reading::Force(force) if force.0.is_finite() => {
            let codes = (f64::from(force.0) * f64::from(calibration.counts_per_n)).round();
            Some(codes as i32 + calibration.tare_counts)
        }
        Reading::Force(_) | Reading::Bad(_) => None,
    }
}
