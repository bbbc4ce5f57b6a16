//! Debian packages, installed only when something is missing.

use std::path::Path;
use std::process::Command;
use std::sync::Once;

use crate::shell::{output, run, say};
use crate::{Result, shell};

const BACKPORTS: &str = "/etc/apt/sources.list.d/floe-backports.list";

/// Installs packages; the lists are refreshed once, when first needed.
pub fn install(packages: &[&str]) -> Result<()> {
    update_once();
    run(apt().args(["install", "-y", "--no-install-recommends"]).args(packages))
}

/// Installs a package in a major version or newer: from the release if that has
/// it, else from its backports, which are added to apt's sources when absent.
pub fn install_newest(package: &str, major: u32) -> Result<()> {
    update_once();
    if candidate(package).is_some_and(|found| found >= major) {
        return install(&[package]);
    }
    let suite = format!("{}-backports", codename()?);
    if !has_suite(&suite) {
        say(&format!("adding {suite} to apt's sources ({BACKPORTS})"));
        write_as_root(&format!("deb http://deb.debian.org/debian {suite} main"))?;
        run(apt().arg("update"))?;
    }
    run(apt().args(["install", "-y", "--no-install-recommends", "-t", &suite, package]))
}

/// Major version that a plain install would bring.
fn candidate(package: &str) -> Option<u32> {
    let policy = output(Command::new("apt-cache").args(["policy", package]))?;
    let line = policy.lines().find(|l| l.trim_start().starts_with("Candidate:"))?;
    let version = line.split_whitespace().nth(1)?;
    let version = version.split_once(':').map_or(version, |(_epoch, rest)| rest);
    version.split('.').next()?.parse().ok()
}

/// Whether this machine has apt at all.
pub fn present() -> bool {
    Path::new("/usr/bin/apt-get").exists()
}

fn update_once() {
    static ONCE: Once = Once::new();
    // A mirror that is partly out of reach must not stop the others.
    ONCE.call_once(|| drop(run(apt().arg("update"))));
}

fn codename() -> Result<String> {
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    release
        .lines()
        .find_map(|l| l.strip_prefix("VERSION_CODENAME="))
        .map(|name| name.trim_matches('"').to_string())
        .ok_or_else(|| "cannot tell which Debian release this is (/etc/os-release)".to_string())
}

fn has_suite(suite: &str) -> bool {
    output(Command::new("apt-cache").arg("policy")).is_some_and(|p| p.contains(suite))
}

fn write_as_root(line: &str) -> Result<()> {
    let script = format!("echo '{line}' > {BACKPORTS}");
    run(privileged("sh").args(["-c", &script]))
}

fn apt() -> Command {
    let mut command = privileged("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive").arg("-q");
    command
}

/// As root directly, else through `sudo -n` (which never asks).
fn privileged(program: &str) -> Command {
    let root = shell::output(Command::new("id").arg("-u")).is_some_and(|id| id.trim() == "0");
    if root {
        return Command::new(program);
    }
    let mut command = Command::new("sudo");
    command.args(["-n", "env", "DEBIAN_FRONTEND=noninteractive", program]);
    command
}
