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
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let suite = format!("{}-backports", debian(&release)?);
    let from_there =
        || run(apt().args(["install", "-y", "--no-install-recommends", "-t", &suite, package]));
    if has_suite(&suite) {
        return from_there();
    }
    say(&format!("adding {suite} to apt's sources ({BACKPORTS})"));
    let line = format!("deb http://deb.debian.org/debian {suite} main");
    let added = as_root(&format!("echo '{line}' > {BACKPORTS}"));
    let done = added.and_then(|()| run(apt().arg("update"))).and_then(|()| from_there());
    // A source that is of no use would be in the way of whatever apt does next.
    done.inspect_err(|_| drop(as_root(&format!("rm -f {BACKPORTS}"))))
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

/// Which release of Debian this is, from the text of `/etc/os-release`: what is built upon it has
/// names of its own, or Debian's name and other packages.
fn debian(release: &str) -> Result<&str> {
    let value = |key| {
        let mut values = release.lines().filter_map(|line| line.strip_prefix(key));
        values.next().map(|value| value.trim_matches('"'))
    };
    let name = value("VERSION_CODENAME=").filter(|_| value("ID=") == Some("debian"));
    name.ok_or_else(|| "no Debian release in /etc/os-release: no backports to add".to_string())
}

fn has_suite(suite: &str) -> bool {
    output(Command::new("apt-cache").arg("policy")).is_some_and(|p| p.contains(suite))
}

fn as_root(script: &str) -> Result<()> {
    run(privileged("sh").args(["-c", script]))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_debian_has_its_backports() {
        assert_eq!(debian("ID=debian\nVERSION_CODENAME=bookworm\n").as_deref(), Ok("bookworm"));
        for other in [
            "ID=linuxmint\nID_LIKE=\"ubuntu debian\"\nVERSION_CODENAME=wilma\n",
            "ID=raspbian\nID_LIKE=debian\nVERSION_CODENAME=bookworm\n",
            "ID=debian\n",
            "",
        ] {
            assert!(debian(other).is_err(), "{other}");
        }
    }
}
