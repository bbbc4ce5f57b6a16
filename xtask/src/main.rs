//! Every job around the project: `cargo xtask help` lists them.
#![forbid(unsafe_code)]

mod apt;
mod arm;
mod bench;
mod browser;
mod budgets;
mod defmt;
mod effects;
mod emulate;
mod flash;
mod host_tests;
mod image;
mod libraries;
mod maths;
mod panics;
mod performance;
mod pictures;
mod python;
mod qemu;
mod shell;
mod size;
mod speed_vs_error;
mod target;
mod test;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// What went wrong, as one line for a person.
type Result<T> = std::result::Result<T, String>;

/// One command for every job around the project
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    /// Where the compiler for the board comes from [default: the first that works]
    #[arg(long, global = true, env = "FLOE_ARM", value_enum)]
    arm: Option<arm::Route>,
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    /// Everything: format, clippy, host tests, the firmware in the emulator
    Test {
        /// Only the board's part
        #[arg(long)]
        firmware: bool,
    },
    /// Run a log through the firmware in the emulator
    Emulate(Box<emulate::Args>),
    /// Every bundled log and scene through the firmware, compared with this PC bit for bit
    Logs {
        /// Which board
        #[arg(long, value_enum, default_value_t)]
        board: emulate::Board,
    },
    /// The battery pulled, then what else can happen to the user's board, on the image that is
    /// flashed: one table
    Faults,
    /// Speed on this PC and on the board, one table
    Bench {
        /// Write docs/speed-vs-error.md and its picture instead
        #[arg(long)]
        docs: bool,
    },
    /// What the core alone costs on the board, held against xtask/budgets.toml
    Budgets {
        /// Make what is measured the budget of this compiler
        #[arg(long)]
        write: bool,
    },
    /// What each effect costs and brings, into docs/effects.md
    Effects,
    /// Errors and speed of the elementary functions, into docs/maths.md
    Maths,
    /// Speed of readers, replay, simulator and campaign beside others, into docs/performance.md
    Performance,
    /// The pictures of the README: a report and the live view, into docs/
    Pictures,
    /// Every kind of report in headless Chromium: narrow, wide, on paper, light and dark
    Reports,
    /// Write the firmware to a NUCLEO-L476RG on USB
    Flash {
        /// Write the one that logs, and follow its log
        #[arg(long)]
        log: bool,
    },
    /// The files to copy onto the board's USB drive: .bin and .hex
    Image,
    /// Decode the firmware's own log of an emulated test
    Defmt,
    /// Flash, RAM and stack of the firmware
    Size,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match &cli.job {
        Job::Test { firmware } => test::run(cli.arm, *firmware),
        Job::Emulate(args) => emulate::run(args, cli.arm),
        Job::Logs { board } => emulate::check_bundled(*board, cli.arm),
        Job::Faults => arm::Route::find(cli.arm).and_then(|route| {
            emulate::check_card(route).and_then(|()| emulate::check_board(route))
        }),
        Job::Bench { docs: true } => speed_vs_error::run(cli.arm),
        Job::Bench { docs: false } => bench::run(cli.arm),
        Job::Budgets { write } => budgets::run(cli.arm, *write),
        Job::Effects => effects::run(cli.arm),
        Job::Maths => maths::run(cli.arm),
        Job::Performance => performance::run_all(),
        Job::Pictures => pictures::run_all(),
        Job::Reports => browser::check(),
        Job::Flash { log } => flash::run(cli.arm, *log),
        Job::Image => image::run(cli.arm),
        Job::Defmt => defmt::run(cli.arm),
        Job::Size => size::run(cli.arm),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::from(2)
        }
    }
}
