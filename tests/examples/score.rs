//! Evaluates the core on a log with known events.
//!
//! `cargo run --release -p floe-tests --example score -- LOG EVENTS.csv [--weight-n W]
//! [--column NAME --unit N]`
//!
//! `EVENTS.csv` has a header and the columns `onset_s`, `restick_s` or `stop_s`, and either
//! `mu_s` and `mu` or, in parts of the weight, `static` and `restick`
//! (then `mu_s` = static and `mu` = (static + restick)/2).

use std::error::Error;
use std::fs::File;

use clap::Parser;
use floe::bench::Found;
use floe::bench::matching::matched;
use floe::bench::scenes::Truth;
use floe::log::{Log, LogOptions, Unit};
use floe::replay::test::{TestOptions, configure};
use floe_core::{Coefficient, Event, Pipeline};
use floe_tests::score::{quantile, rms};

#[derive(Parser)]
struct Args {
    /// The log.
    log: String,
    /// Its true events.
    events: String,
    /// Weight of the block, N [default: as the log says].
    #[arg(long)]
    weight_n: Option<f64>,
    /// Column of the force.
    #[arg(long)]
    column: Option<String>,
    /// Its unit.
    #[arg(long)]
    unit: Option<Unit>,
}

fn truths(path: &str) -> Result<Vec<Truth>, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))?;
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let place = |name: &str| names.iter().position(|n| *n == name);
    let event = |line: &str| -> Option<Truth> {
        let cells: Option<Vec<f64>> = line.split(',').map(|c| c.trim().parse().ok()).collect();
        let cells = cells?;
        let get = |name: &str| cells.get(place(name)?).copied();
        let pair = get("mu_s").zip(get("mu"));
        let ends = get("static").zip(get("restick"));
        let (mu_s, mu) = pair.or(ends.map(|(a, b)| (a, 0.5 * (a + b))))?;
        let (onset_s, stop_s) = (get("onset_s")?, get("stop_s").or(get("restick_s"))?);
        Some(Truth { onset_s, stop_s, mu_s, mu, bound: None })
    };
    lines
        .enumerate()
        .map(|(i, line)| {
            event(line).ok_or_else(|| format!("{path}: event {}: {line}", i + 1).into())
        })
        .collect()
}

/// Time of the onset in the log, s, and the event.
type Timed = (f64, Event);

/// Events of a log, and its sampling rate.
fn found(args: &Args) -> Result<(Vec<Timed>, f64), Box<dyn Error>> {
    let input = Box::new(File::open(&args.log).map_err(|e| format!("{}: {e}", args.log))?);
    let (column, unit) = (args.column.clone(), args.unit);
    let mut log = Log::from_reader(input, &LogOptions { column, unit, ..LogOptions::default() })?;
    let test = TestOptions { weight_n: args.weight_n, ..TestOptions::default() };
    let mut pipeline = Pipeline::new(&configure(&log, &test)?)?;
    let (rate_hz, mut first_s, mut events) = (log.rate_hz(), None, Vec::new());
    while let Some(sample) = log.next_sample()? {
        first_s.get_or_insert(sample.time_s - sample.raw.index as f64 / rate_hz);
        events.extend(pipeline.step(sample.raw).event);
    }
    events.extend(std::iter::from_fn(|| pipeline.finish()));
    let onset_s = |e: &Event| {
        first_s.unwrap_or(0.0) + (e.onset.index as f64 + f64::from(e.onset.fraction)) / rate_hz
    };
    Ok((events.into_iter().map(|e| (onset_s(&e), e)).collect(), rate_hz))
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Args::parse();
    let truths = truths(&args.events)?;
    let (found, rate_hz) = found(&args)?;
    let onsets: Vec<Found> =
        found.iter().map(|(s, _)| Found { onset_s: *s, mu_s: None, mu: None }).collect();
    let (pairs, detection) = matched(&truths, &onsets, rate_hz);
    println!("found {} of {}, others {}", detection.hits, truths.len(), detection.false_alarms);
    let both = |(_, f): &&(usize, usize)| found[*f].1.mu_s.is_some() && found[*f].1.mu.is_some();
    println!("with both coefficients {}", pairs.iter().filter(both).count());
    type Of = (&'static str, fn(&Event) -> Option<Coefficient>, fn(&Truth) -> f64);
    let coefficients: [Of; 2] = [("mu_s", |e| e.mu_s, |t| t.mu_s), ("mu", |e| e.mu, |t| t.mu)];
    for (name, got, truth) in coefficients {
        let values: Vec<(f64, f64)> = pairs
            .iter()
            .filter_map(|&(t, f)| {
                let got = got(&found[f].1)?;
                Some((f64::from(got.value) - truth(&truths[t]), f64::from(got.std)))
            })
            .collect();
        let errors: Vec<f64> = values.iter().map(|v| v.0).collect();
        let stated = quantile(values.iter().map(|v| v.1), 0.5);
        let inside = values.iter().filter(|(e, s)| e.abs() <= 1.96 * s).count();
        println!(
            "{name:4}: rms error {:.5}, mean error {:+.5}, median stated random part {stated:.5} = \
             {:.2} of the error, {:.3} within the random part's 95 % interval",
            rms(&errors),
            errors.iter().sum::<f64>() / errors.len() as f64,
            stated / rms(&errors),
            inside as f64 / values.len() as f64,
        );
    }
    Ok(())
}
