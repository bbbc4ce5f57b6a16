//! The `floe` command.
#![forbid(unsafe_code)]

fn main() -> std::process::ExitCode {
    floe::cli::main()
}
