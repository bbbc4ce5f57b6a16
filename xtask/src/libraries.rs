//! The crates as others would take them: documentation, features, examples, package.

use crate::Result;
use crate::shell::{cargo, run};

/// Builds the documentation with every warning an error, tests `floe-core` with serde, runs
/// its examples, and builds it from the package that would be published.
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
    // What is not committed yet is packaged too.
    run(cargo().args(["package", "--package", "floe-core", "--allow-dirty", "--offline"]))
}

fn document() -> Result<()> {
    let mut doc = cargo();
    doc.args(["doc", "--no-deps"]);
    for package in ["floe-core", "floe-firmware", "floe"] {
        doc.args(["--package", package]);
    }
    run(doc.env("RUSTDOCFLAGS", "-D warnings"))
}
