//! `floe simulate`: a log with known truth from a scene.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use crate::sim::{Run, Scene, write};

/// Simulate a test: a log with known truth.
#[derive(Args, Debug)]
pub struct SimulateArgs {
    /// The scene, TOML.
    pub scene: PathBuf,
    /// The log to write: `.csv`, or `.dat` for a CR10's mixed arrays.
    #[arg(short, long)]
    pub output: PathBuf,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Length of the record instead of the scene's, s.
    #[arg(long)]
    pub duration_s: Option<f64>,
}

/// Runs the command.
///
/// # Errors
/// One line: what is wrong, where, what to do.
pub fn run(args: &SimulateArgs) -> Result<(), String> {
    let scene = read_scene(&args.scene, args.duration_s)?;
    let run = Run::new(&scene, args.seed).map_err(|e| format!("{}: {e}", args.scene.display()))?;
    let in_output = |e: io::Error| format!("{}: {e}", args.output.display());
    let cr10 = match args.output.extension().and_then(|e| e.to_str()) {
        Some("csv") => false,
        Some("dat") => true,
        _ => return Err(format!("{}: name it .csv or .dat", args.output.display())),
    };
    let mut out = BufWriter::new(File::create(&args.output).map_err(in_output)?);
    let written = if cr10 {
        write_cr10(&mut out, &scene, run)
    } else {
        write_csv(&mut out, &scene, args.seed, &command_line(args), run)
    };
    written.and_then(|()| out.flush()).map_err(in_output)
}

fn read_scene(path: &Path, duration_s: Option<f64>) -> Result<Scene, String> {
    let in_scene = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = fs::read_to_string(path).map_err(|e| in_scene(&e))?;
    let mut scene = Scene::from_toml(&text).map_err(|e| in_scene(&e))?;
    if let Some(duration_s) = duration_s {
        scene.duration_s = duration_s;
    }
    Ok(scene)
}

/// The command as a person would repeat it.
fn command_line(args: &SimulateArgs) -> String {
    let duration = args.duration_s.map(|d| format!(" --duration-s {d}")).unwrap_or_default();
    let (scene, output) = (args.scene.display(), args.output.display());
    format!("floe simulate {scene} -o {output} --seed {}{duration}", args.seed)
}

/// Writes a whole CSV log.
///
/// # Errors
/// Of the writer.
pub fn write_csv(
    out: &mut impl Write,
    scene: &Scene,
    seed: u64,
    command: &str,
    run: Run,
) -> io::Result<()> {
    write::csv_head(out, scene, seed, command)?;
    for sample in run {
        write::csv_line(out, scene, &sample)?;
    }
    Ok(())
}

/// Writes a whole CR10 log.
///
/// # Errors
/// Of the writer.
pub fn write_cr10(out: &mut impl Write, scene: &Scene, run: Run) -> io::Result<()> {
    for sample in run {
        write::cr10_line(out, scene.start, &sample)?;
    }
    Ok(())
}
