//! `floe simulate`: creates a log with known truth from a scene.

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{InputError, printable_line};
use crate::rounding::counted;
use crate::short_file;
use crate::sim::truth_file::TruthBuilder;
use crate::sim::{Method, Run, Scene, write};

use super::provenance::command_line;
use super::{json, output, progress};

/// Simulate a test: a log with known truth
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe simulate scene.toml -o pull.csv --truth pull-truth.json
  floe simulate scene.toml -o pull.dat --seed 7 --duration-s 3600

Scenes to begin with: host-sim/scenes; what may stand in one: docs/simulator.md.")]
pub struct Args {
    /// The scene, TOML
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// The log to write: .csv, or .dat for the mixed arrays of a Campbell CR10
    #[arg(short, long, value_name = "LOG")]
    pub output: PathBuf,
    /// Write the truth as JSON: every event, the state at every sample
    #[arg(long, value_name = "TRUTH.json")]
    pub truth: Option<PathBuf>,
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Length of the record instead of the scene's, s
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub duration_s: Option<f64>,
}

/// Form of the log.
#[derive(Clone, Copy, Debug)]
enum Form {
    Csv,
    Cr10,
}

/// Samples between two updates of the progress.
const LOOK: u32 = 4096;

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let form = form(&args.output)?;
    let truth_file: Vec<&Path> = args.truth.iter().map(PathBuf::as_path).collect();
    let older = output::check_log(&args.output, &truth_file, &[&args.scene])?;
    let scene = read_scene(&args.scene, args.duration_s)?;
    let in_scene = |error: &dyn Display| InputError::new(error).within(args.scene.display());
    let mut run = Run::new(&scene, args.seed).map_err(|e| in_scene(&e))?;
    let mut truth = TruthBuilder::default();
    let samples = output::stream(&args.output, |out| {
        let samples = write_log(out, form, args, &scene, &mut run, &mut truth)?;
        run.failure().map_or(Ok(samples), |failure| Err(in_scene(&failure).into()))
    })?;
    if let Some(path) = &args.truth {
        let truth = truth.finish(&scene, args.seed, &run);
        output::stream(path, |out| json::write(&truth, out))?;
    }
    older.tell();
    output::print(&summary(args, &scene, samples, run.events().len()))
}

fn form(path: &Path) -> Result<Form, InputError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok(Form::Csv),
        Some("dat") => Ok(Form::Cr10),
        Some(_) | None => {
            output::refuse(path, "the name of the log must end in .csv, or .dat for a CR10's form")
        }
    }
}

/// Reads a scene, with another duration if one is given.
///
/// # Errors
/// The file, line or value that cannot be used.
pub fn read_scene(path: &Path, duration_s: Option<f64>) -> Result<Scene, InputError> {
    let refused = |error: InputError| error.within(path.display());
    let text = short_file::read(path).map_err(|e| refused(InputError::unreadable(e)))?;
    let mut scene = Scene::from_toml(&text).map_err(|e| refused(InputError::new(e)))?;
    if let Some(duration_s) = duration_s {
        scene.duration_s = duration_s;
        scene.validate().map_err(|e| InputError::new(e).within("--duration-s"))?;
    }
    Ok(scene)
}

/// Writes the log; returns the number of its samples, without the missing ones and with those that
/// come twice.
fn write_log(
    out: &mut impl Write,
    form: Form,
    args: &Args,
    scene: &Scene,
    run: &mut Run,
    truth: &mut TruthBuilder,
) -> io::Result<u64> {
    let mut samples = 0;
    if let Form::Csv = form {
        write::csv_head(out, scene, args.seed, &repeating(args))?;
    }
    let bar = progress::bar(scene.sample_count().into(), "{pos} of {len} samples, {eta} left");
    let force_decimals = write::force_decimals(scene);
    for sample in run {
        if sample.index % LOOK == 0 {
            bar.set_position(sample.index.into());
        }
        samples += 1;
        truth.push(&sample);
        match form {
            Form::Csv => write::csv_line(out, force_decimals, &sample)?,
            Form::Cr10 => write::cr10_line(out, scene.start, &sample)?,
        }
    }
    Ok(samples)
}

/// The command to repeat the simulation, without the truth.
fn repeating(args: &Args) -> String {
    let (scene, output) = (args.scene.clone().into(), args.output.clone().into());
    let mut words: Vec<OsString> = vec!["floe".into(), "simulate".into(), scene];
    words.extend(["-o".into(), output, "--seed".into(), args.seed.to_string().into()]);
    if let Some(duration_s) = args.duration_s {
        words.extend(["--duration-s".into(), duration_s.to_string().into()]);
    }
    command_line(words.into_iter())
}

fn summary(args: &Args, scene: &Scene, samples: u64, events: usize) -> String {
    let terms = scene.terms();
    let terms = if terms.is_empty() { "none".to_owned() } else { terms.join(", ") };
    let output = args.output.display().to_string();
    format!(
        "{}: {} at {} Hz, {}, seed {}\nmethod: {}\nterms: {terms}\n",
        printable_line(&output),
        counted(samples, "sample"),
        scene.rate_hz,
        counted(events as u64, "event"),
        args.seed,
        Method::for_scene(scene),
    )
}
