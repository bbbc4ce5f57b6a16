//! `floe bench`: comparison of methods, speed against error.

use std::path::Path;

use crate::bench::result::BenchResult;
use crate::bench::{self, table};
use crate::error::InputError;

use super::json::Json;
use super::{output, progress};

/// Compare methods: speed against error, on the same simulated samples
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe bench --quick
  floe bench --json bench.json")]
pub struct Args {
    #[command(flatten)]
    json: Json,
    /// Fewer events: a look in a few seconds, rougher figures
    #[arg(long)]
    quick: bool,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let outputs: Vec<&Path> = args.json.file().into_iter().collect();
    let older = output::check(&outputs, &[])?;
    let result = compare(args.quick)?;
    args.json.print(&result, || table::text(&result))?;
    older.tell();
    Ok(())
}

fn compare(quick: bool) -> Result<BenchResult, InputError> {
    let bar = progress::bar(1, "scene {pos} of {len}: {msg}");
    let result = bench::run(quick, |done, total, name| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(name.to_owned());
    });
    result.map_err(InputError::new)
}
