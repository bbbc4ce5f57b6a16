//! `floe bench`: methods side by side, speed against error.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};

use crate::bench::result::BenchResult;
use crate::bench::{self, page, picture, table};
use crate::error::InputError;

use super::output;

/// Compare methods: speed against error, on the same simulated samples
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
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
    if let Some((page, picture)) = &files {
        // The pages of this project, which are there to be replaced.
        let _ = output::check(&[page, picture], &[])?;
    }
    let result = compare(args.quick)?;
    if let Some((page, picture)) = &files {
        write(&result, page, picture)?;
    }
    if args.json {
        let json = serde_json::to_string_pretty(&result);
        let json = json.map_err(|error| InputError::new(error.to_string()))?;
        return output::print(&(json + "\n"));
    }
    let written = files.iter().flat_map(|(page, picture)| [page, picture]);
    let written: String = written.map(|path| format!("written {}\n", path.display())).collect();
    output::print(&(table::text(&result) + &written))
}

fn compare(quick: bool) -> Result<BenchResult, InputError> {
    let bar = if std::io::stderr().is_terminal() { bar() } else { ProgressBar::hidden() };
    let result = bench::run(quick, |done, total, name| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(name.to_owned());
    });
    bar.finish_and_clear();
    result.map_err(|error| InputError::new(error.to_string()))
}

/// A bar on standard error.
fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} scene {pos} of {len}: {msg}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1).with_style(style)
}

fn write(result: &BenchResult, page: &Path, picture: &Path) -> Result<(), InputError> {
    output::replace(picture, &picture::svg(result))?;
    output::replace(page, &page::markdown(result, PICTURE))
}
