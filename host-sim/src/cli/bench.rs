//! `floe bench`: methods side by side, speed against error.

use std::path::{Path, PathBuf};

use crate::bench::result::BenchResult;
use crate::bench::{self, page, picture, table};
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
    /// Write the page speed-vs-error.md and its picture into DIR
    #[arg(long, value_name = "DIR")]
    docs: Option<PathBuf>,
}

/// Files that `--docs` writes.
const PAGE: &str = "speed-vs-error.md";
const PICTURE: &str = "speed-vs-error.svg";

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let files = args.docs.as_deref().map(|docs| (docs.join(PAGE), docs.join(PICTURE)));
    let pages = files.iter().flat_map(|(page, picture)| [page.as_path(), picture]);
    let outputs: Vec<&Path> = args.json.file().into_iter().chain(pages).collect();
    let older = output::check(&outputs, &[])?;
    let result = compare(args.quick)?;
    if let Some((page, picture)) = &files {
        write(&result, page, picture)?;
    }
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
    bar.finish_and_clear();
    result.map_err(|error| InputError::new(error.to_string()))
}

fn write(result: &BenchResult, page: &Path, picture: &Path) -> Result<(), InputError> {
    output::replace(picture, &picture::svg(result))?;
    output::replace(page, &page::markdown(result, PICTURE))
}
