//! Finds or installs a compiler for the board's target `thumbv7em-none-eabihf`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::shell::{output, root, run, run_within, say, target};
use crate::{Result, apt};

/// Target triple of the board.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Where the compiler comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Route {
    /// The toolchain that runs this program knows the target already.
    Installed,
    /// `rustup target add`.
    Rustup,
    /// Debian's own Rust, with `core` compiled from its source.
    Debian,
}

impl Route {
    /// The first route that works, or the forced one.
    ///
    /// # Errors
    /// No route works; the message contains the error of each.
    pub fn find(forced: Option<Self>) -> Result<Self> {
        let candidates = match forced {
            None => vec![Self::Installed, Self::Rustup, Self::Debian],
            Some(route) => vec![route],
        };
        let mut reasons = Vec::new();
        for route in candidates {
            match route.prepare() {
                Ok(()) => {
                    say(&format!("ARM compiler: {}", route.describe()));
                    return Ok(route);
                }
                Err(reason) => reasons.push(reason),
            }
        }
        Err(format!("no compiler for {TARGET}: {}", reasons.join("; ")))
    }

    /// A cargo command for the target, with a subcommand such as `build`.
    pub fn cargo(self, subcommand: &str) -> Command {
        let mut command = match self {
            Self::Installed | Self::Rustup => crate::shell::cargo(),
            Self::Debian => debian_cargo(),
        };
        command.arg(subcommand).args(["--target", TARGET, "--target-dir"]);
        command.arg(target().join("arm"));
        if self == Self::Debian {
            command.args(["-Z", "build-std=core"]);
        }
        command
    }

    /// Builds a program of the firmware and returns its file.
    ///
    /// # Errors
    /// The build fails.
    pub fn build_firmware(self, program: &str, features: &str) -> Result<PathBuf> {
        self.build_with(program, features, &[])
    }

    /// Builds a program of the firmware with extra arguments to cargo, and returns its file.
    ///
    /// # Errors
    /// The build fails.
    pub fn build_with(self, program: &str, features: &str, more: &[&str]) -> Result<PathBuf> {
        let mut command = self.cargo("build");
        command.args(more);
        command.args(["--package", "floe-firmware", "--bin", program]);
        command.args(["--features", features, "--profile", "firmware"]);
        command.env("DEFMT_LOG", "debug");
        command.env("CARGO_ENCODED_RUSTFLAGS", self.firmware_flags().join("\u{1f}"));
        run(&mut command)?;
        Ok(target().join("arm").join(TARGET).join("firmware").join(program))
    }

    /// Compiler flags for small code, and for code without paths of this machine.
    fn firmware_flags(self) -> Vec<String> {
        let cargo_home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
        let home = std::env::var_os("HOME").map(|home| Path::new(&home).join(".cargo"));
        let sources = cargo_home.or(home).unwrap_or_default().join("registry/src");
        let registries = std::fs::read_dir(&sources).into_iter().flatten().flatten();
        let mut hidden: Vec<PathBuf> = registries.map(|entry| entry.path()).collect();
        hidden.push(root());
        // The last matching remapping applies.
        hidden.push(target().join("arm").join(TARGET).join("firmware/build"));
        let remap = |path: &PathBuf| format!("--remap-path-prefix={}/=", path.display());
        let mut flags: Vec<String> = hidden.iter().map(remap).collect();
        flags.push(format!("-Cllvm-args={}", SMALL.join(" ")));
        flags.push(FOLD.to_owned());
        if self == Self::Debian {
            flags.extend(DEBIAN_FLAGS.map(String::from));
            flags.push(format!("-Cllvm-args={LATER}"));
        }
        flags
    }

    fn describe(self) -> &'static str {
        match self {
            Self::Installed => "the installed toolchain",
            Self::Rustup => "the installed toolchain, target added by rustup",
            Self::Debian => "Debian's rustc-web with core from source",
        }
    }

    fn prepare(self) -> Result<()> {
        match self {
            Self::Installed => {
                if has_target() {
                    Ok(())
                } else {
                    Err("not in the installed toolchain".into())
                }
            }
            Self::Rustup => {
                let mut rustup = Command::new("rustup");
                rustup.args(["target", "add", TARGET]).env("RUSTUP_MAX_RETRIES", "0");
                run_within(&mut rustup, Duration::from_secs(90))?;
                if has_target() { Ok(()) } else { Err("rustup did not add it".into()) }
            }
            Self::Debian => prepare_debian(),
        }
    }
}

fn has_target() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
    let libdir = output(Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]));
    libdir.is_some_and(|dir| {
        std::fs::read_dir(dir.trim()).is_ok_and(|mut files| {
            files.any(|f| f.is_ok_and(|f| f.file_name().to_string_lossy().starts_with("libcore")))
        })
    })
}

fn prepare_debian() -> Result<()> {
    let needed = ["/usr/bin/rustc", "/usr/bin/cargo", "/usr/bin/ld.lld", "/usr/lib/rustlib/src"];
    if needed.iter().all(|path| Path::new(path).exists()) {
        return Ok(());
    }
    if !apt::present() {
        return Err("this is not a Debian machine (no apt-get)".into());
    }
    say("installing Debian's Rust and linker");
    apt::install(&["rustc-web", "cargo-web", "rust-web-src", "lld"])
}

/// Options of LLVM that make the image small. Each number is the bytes of the image saved, with
/// Rust 1.95.0.
const SMALL: [&str; 14] = [
    // Calls small functions instead of inlining them; unrolls only loops over the six unknowns.
    "--inline-threshold=6",
    "--unroll-full-max-count=6",
    // Places constants next to the code that reads them: 512.
    "--arm-promote-constant",
    "--arm-promote-constant-max-size=256",
    "--arm-promote-constant-max-total=4096",
    // Does not duplicate code to save an occasional jump or load: 220, 200 and 190. Together with
    // the next group this makes a mean step half a percent slower.
    "--unswitch-threshold=0",
    "--enable-pre=false",
    "--tail-dup-placement=false",
    // Merges even two equal instructions at the ends of blocks, and keeps sums in memory: 160 and
    // 150.
    "--tail-merge-size=2",
    "--disable-licm-promotion",
    // Does not merge two conditions by computing both in advance: 260.
    "--bonus-inst-threshold=0",
    // Spills registers where it takes the fewest bytes, and merges copies on split edges: 150 and 44.
    "--split-spill-mode=size",
    "--join-splitedges",
    // Jumps over instructions instead of making them conditional: 80, and a step is half a percent
    // faster.
    "--ifcvt-limit=0",
    // Not used: outlining of repeated code (`--enable-machine-outliner=always`) costs 5 % of the
    // time, unrotated loops (`--rotation-max-header-size=0`, 1150 bytes) 26 %.
];

/// Orders blocks for the fewest jumps, 300 bytes; the LLVM of Rust 1.95 does not support it yet.
const LATER: &str = "--apply-ext-tsp-for-size";

/// The linker keeps one copy of functions with equal code: 100 bytes.
const FOLD: &str = "-Clink-arg=--icf=all";

/// Linker flags, which cargo does not apply to build scripts when a target is given.
const DEBIAN_FLAGS: [&str; 2] = ["-Clinker=ld.lld", "-Clinker-flavor=ld.lld"];

/// Cargo of Debian with Debian's lld, because its packages have no `rust-lld`.
fn debian_cargo() -> Command {
    let mut command = Command::new("/usr/bin/cargo");
    command.current_dir(root());
    for name in ["CARGO", "RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER", "RUSTFLAGS"] {
        command.env_remove(name);
    }
    command.env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1");
    command.env("CARGO_ENCODED_RUSTFLAGS", DEBIAN_FLAGS.join("\u{1f}"));
    command
}
