//! Checks of the crates from a user's view: documentation, features, examples, packages.

use std::path::{Path, PathBuf};
use std::process::Command;

use toml::{Table, Value};

use crate::Result;
use crate::shell::{cargo, output, remove, root, run, run_quoted, say, target};

/// Packages to publish, in the order of publication.
const PACKAGES: [&str; 3] = ["floe-core", "floe-firmware", "floe"];

/// Packages that the published ones do not depend on.
const OURS_ALONE: [&str; 2] = ["floe-board-model", "xtask"];

/// Builds the documentation with warnings as errors, tests `floe-core` with serde, runs its
/// examples, tests it without any effect, and builds all three crates from the packages that would
/// be published.
///
/// # Errors
/// The first check that fails.
pub fn check() -> Result<()> {
    document()?;
    run(cargo().args([
        "test",
        "--package",
        "floe-core",
        "--features",
        "serde",
        "--test",
        "serde",
    ]))?;
    for example in ["host", "microcontroller", "from_json"] {
        run(core_example(&["--features", "serde"]).arg(example))?;
    }
    linear()?;
    online_if_need_be(pack)?;
    let packages = unpack()?;
    online_if_need_be(|options| build(&packages, options))
}

/// A command that runs an example of the core; the caller adds the example's name.
fn core_example(features: &[&str]) -> Command {
    let mut command = cargo();
    command.args(["run", "--quiet", "--package", "floe-core"]).args(features).arg("--example");
    command
}

/// Tests the core without any effect: its unit tests (except those of a sagging cable's elongation,
/// which it does not compute), and that its output equals that of the whole core with every effect
/// switched off. The same code computes both, so no digit may differ.
fn linear() -> Result<()> {
    run(cargo().args(["test", "--package", "floe-core", "--no-default-features", "--lib"]))?;
    let answers = [&["--features", "serde"][..], &["--no-default-features"]]
        .map(|features| output(core_example(features).arg("linear")));
    let [Some(whole), Some(without)] = answers else {
        return Err("floe-core's example `linear` does not run".into());
    };
    // Every event and first answer is a line, and the report is one.
    if whole.lines().count() < 100 {
        return Err(format!("floe-core's example `linear` says too little: {whole}"));
    }
    if whole == without {
        return Ok(());
    }
    let differs = whole.lines().zip(without.lines()).find(|(whole, without)| whole != without);
    Err(format!("the core with effects off, and without them, says first: {differs:#?}"))
}

fn document() -> Result<()> {
    let mut doc = cargo();
    doc.args(["doc", "--no-deps"]);
    doc.args(PACKAGES.iter().flat_map(|name| ["--package", name]));
    run(doc.env("RUSTDOCFLAGS", "-D warnings"))
}

/// Runs a job offline, and again with the registry if that fails.
fn online_if_need_be(job: impl Fn(&[&str]) -> Result<()>) -> Result<()> {
    job(&["--offline"]).or_else(|reason| {
        say(&format!("{reason}\nagain, with what the registry has"));
        job(&[])
    })
}

/// Builds the packages, including changes that are not committed.
fn pack(options: &[&str]) -> Result<()> {
    let mut package = cargo();
    package.args(["package", "--no-verify", "--allow-dirty", "--target-dir"]).arg(target());
    package.args(options);
    run_quoted(package.args(PACKAGES.iter().flat_map(|name| ["--package", name])))
}

/// Unpacks the packages into a separate workspace, in which each depends on the other packages.
///
/// Cargo's own verification may use another package of the same version, from its registry or an
/// earlier build. It could build `floe` with an older `floe-core`, and pass or fail because of it.
fn unpack() -> Result<PathBuf> {
    let packages = target().join("package");
    let folder = |name: &str| format!("{name}-{}", env!("CARGO_PKG_VERSION"));
    for name in PACKAGES.map(folder) {
        remove(&packages.join(&name))?;
        let mut tar = Command::new("tar");
        // As new: packages have a date of their own, by which an older build would seem to be of them.
        tar.arg("-xzmf").arg(packages.join(format!("{name}.crate"))).arg("-C").arg(&packages);
        run(&mut tar)?;
    }
    let members = PACKAGES.map(folder).map(Value::String).to_vec();
    let path = |name: &str| (name.to_string(), toml::toml! { path = (folder(name)) }.into());
    let patch: Table = PACKAGES.map(path).into_iter().collect();
    let workspace = toml::toml! {
        [workspace]
        resolver = "3"
        members = (members)
        [patch]
        crates-io = (patch)
        [profile]
        dev = (profile()?)
    };
    let write = std::fs::write(packages.join("Cargo.toml"), workspace.to_string());
    let lock = root().join("Cargo.lock");
    write
        .and_then(|()| std::fs::copy(lock, packages.join("Cargo.lock")))
        .map_err(|e| format!("cannot write {}: {e}", packages.display()))?;
    Ok(packages)
}

/// Build profile of this workspace, so that dependencies of the packages are not built again; the
/// packages themselves are built like dependencies.
fn profile() -> Result<Value> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).map_err(|e| e.to_string())?;
    let mut manifest: Table = manifest.parse().map_err(|e| format!("Cargo.toml: {e}"))?;
    let profiles = manifest.get_mut("profile").and_then(Value::as_table_mut);
    let mut dev = profiles.and_then(|it| it.remove("dev")).ok_or("Cargo.toml: no profile.dev")?;
    let settings = dev.as_table_mut().ok_or("Cargo.toml: profile.dev is no table")?;
    let overrides = settings.get_mut("package").and_then(Value::as_table_mut);
    let overrides = overrides.ok_or("Cargo.toml: no profile.dev.package")?;
    for name in OURS_ALONE {
        overrides.remove(name);
    }
    let others = overrides.get("*").and_then(Value::as_table).cloned();
    settings.extend(others.ok_or("Cargo.toml: no profile.dev.package.\"*\"")?);
    Ok(dev)
}

/// Builds each package with its default features alone.
fn build(packages: &Path, options: &[&str]) -> Result<()> {
    for name in PACKAGES {
        let mut build = cargo();
        build.arg("build").arg("--manifest-path").arg(packages.join("Cargo.toml"));
        build.args(["--package", name, "--target-dir"]).arg(target());
        run_quoted(build.args(options))?;
    }
    Ok(())
}
