//! The crates as others would take them: documentation, features, examples, package.

use crate::Result;
use crate::shell::{cargo, run};

/// Builds the documentation with every warning an error, tests `floe-core` with serde, runs
/// its examples, and builds it from the package that would be published.
///
/// # Errors
/// The first of these that fails.
pub fn check() -> Result<()> {
    document(&["floe", "floe-firmware"], "-D warnings")?;
    // Five links of the core's comments lead to private items, or to two of one name.
    let links = "-A rustdoc::private_intra_doc_links -A rustdoc::broken_intra_doc_links";
    document(&["floe-core"], &format!("-D warnings {links}"))?;
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

fn document(packages: &[&str], flags: &str) -> Result<()> {
    let mut doc = cargo();
    doc.args(["doc", "--no-deps"]);
    for package in packages {
        doc.args(["--package", package]);
    }
    run(doc.env("RUSTDOCFLAGS", flags))
}
