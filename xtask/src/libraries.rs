//! The crates as others would take them: documentation, features, examples, package.

use crate::Result;
use crate::shell::{cargo, run, run_quoted, say};

/// What can be published, in its order.
const PACKAGES: [&str; 3] = ["floe-core", "floe-firmware", "floe"];

/// Builds the documentation with every warning an error, tests `floe-core` with serde, runs
/// its examples, and builds all three from the packages that would be published.
///
/// # Errors
/// The first of these that fails.
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
        let mut command = cargo();
        command.args(["run", "--quiet", "--package", "floe-core", "--features", "serde"]);
        run(command.args(["--example", example]))?;
    }
    package(&["--offline"]).or_else(|reason| {
        say(&format!("{reason}\nagain, with what the registry has"));
        package(&[])
    })
}

/// Each is built from its package, with the others' packages; what is not committed yet too.
/// What they depend on is built already, and without debugging information.
fn package(options: &[&str]) -> Result<()> {
    let mut package = cargo();
    package.env("CARGO_PROFILE_DEV_DEBUG", "false");
    package.args(["package", "--allow-dirty"]).args(options);
    run_quoted(package.args(PACKAGES.iter().flat_map(|name| ["--package", name])))
}

fn document() -> Result<()> {
    let mut doc = cargo();
    doc.args(["doc", "--no-deps"]);
    doc.args(PACKAGES.iter().flat_map(|name| ["--package", name]));
    run(doc.env("RUSTDOCFLAGS", "-D warnings"))
}
