//! Debian packages, installed only when something is missing.

use std::path::Path;
use std::process::Command;
use std::sync::Once;

use crate::shell::{output, run, say};
use crate::{Result, shell};

const BACKPORTS: &str = "/etc/apt/sources.list.d/floe-backports.list";

/// Installs packages; the package lists are refreshed once, on first use.
pub fn install(packages: &[&str]) -> Result<()> {
    update_once();
    run(apt().args(["install", "-y", "--no-install-recommends"]).args(packages))
}

/// Installs a package in version `major` or newer: from the release if it has one, else from the
/// release's backports, which are added to apt's sources if absent.
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
    // After a failure the added source is removed, because it would disturb later uses of apt.
    done.inspect_err(|_| drop(as_root(&format!("rm -f {BACKPORTS}"))))
}

/// Major version that a plain install would give.
fn candidate(package: &str) -> Option<u32> {
    let policy = output(Command::new("apt-cache").args(["policy", package]))?;
    let line = policy.lines().find(|l| l.trim_start().starts_with("Candidate:"))?;
    let version = line.split_whitespace().nth(1)?;
    let version = version.split_once(':').map_or(version, |(_epoch, rest)| rest);
    version.split('.').next()?.parse().ok()
}

/// Whether this machine has apt.
pub fn present() -> bool {
    Path::new("/usr/bin/apt-get").exists()
}

fn update_once() {
    static ONCE: Once = Once::new();
    // An update that fails for one mirror must not stop the job.
    ONCE.call_once(|| drop(run(apt().arg("update"))));
}

/// Codename of this machine's Debian release, from the text of `/etc/os-release`. Derivatives are
/// rejected: they have codenames of their own, or Debian's codenames with other packages.
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

/// A command that runs as root directly, else through `sudo -n` (which never asks for a password).
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
