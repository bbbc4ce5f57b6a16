//! `floe live`: the field display.

use std::io::{self, IsTerminal};
use std::path::PathBuf;

use clap::builder::NonEmptyStringValueParser;

use crate::error::InputError;
use crate::live::{Form, Place, Port, Save, display, print_events};

use super::output;

/// Show a board's measurement while it runs
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe live /dev/ttyACM0
  floe live COM3 -o field-notes.txt
  floe live 127.0.0.1:4004 --json > events.jsonl

PORT is a serial device (/dev/ttyACM0, COM3), HOST:PORT (an emulated board, a serial server), or
unix:PATH. When standard output is no terminal, every event is printed as one line. The port is
tried again when it goes away.")]
pub struct Args {
    /// The board's console
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    port: String,
    /// Print every event as one line of JSON instead of the display; unlike elsewhere it takes no
    /// FILE: > FILE keeps them
    #[arg(long)]
    json: bool,
    /// Keep all lines of the board in this new file; none is replaced
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    if let Some(path) = &args.output {
        output::refuse_standard(path)?;
        output::refuse_nowhere(path)?;
    }
    let place = Place::parse(&args.port);
    let port = Port::connect(&place)?;
    let save = args.output.as_deref().map(Save::create).transpose()?;
    let form = if args.json { Form::Json } else { Form::Plain };
    if args.json || !io::stdout().is_terminal() {
        print_events(&place, &port, form, save)
    } else {
        display(&place, &port, save)
    }
}
