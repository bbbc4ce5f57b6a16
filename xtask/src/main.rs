//! Every job around the project: `cargo xtask` lists them.
#![forbid(unsafe_code)]

mod apt;
mod arm;
mod qemu;
mod shell;
mod test;

use std::process::ExitCode;

/// What went wrong, as one line for a person.
type Result<T> = std::result::Result<T, String>;

const USAGE: &str = "\
cargo xtask JOB
  test [--arm ROUTE]   everything: format, clippy, host tests, the board's code
ROUTE (or FLOE_ARM=ROUTE) forces where the ARM compiler comes from:
  installed            the present toolchain already has thumbv7em-none-eabihf
  rustup               rustup target add thumbv7em-none-eabihf
  debian               Debian's rustc-web, cargo-web, rust-web-src and lld";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<()> {
    let (job, rest) = arguments.split_first().ok_or_else(|| USAGE.to_string())?;
    match job.as_str() {
        "test" => test::run(rest),
        _ => Err(format!("unknown job {job}\n{USAGE}")),
    }
}
