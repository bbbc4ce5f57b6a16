//! The tests on this PC: cargo builds all at once, then their programs run on all processors. Cargo
//! itself would run them one after another, and most of them have one long test.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use floe_tests::parallel;

use crate::Result;
use crate::shell::{self, cargo, say};

/// A test program, and its working directory.
struct Tests {
    program: PathBuf,
    package: PathBuf,
}

/// Result of a test program.
struct Outcome {
    name: String,
    passed: bool,
    seconds: f32,
    said: String,
}

/// Runs every test of the workspace, then the examples in its documentation. Tests of the
/// firmware's card and display are included: `floe-tests` enables these features, and a build of
/// the workspace enables all features that any package requests.
///
/// # Errors
/// The build or a test fails; all others are run first.
pub fn run() -> Result<()> {
    let outcomes = parallel::each(&built()?, Tests::outcome);
    for Outcome { name, passed, seconds, said } in &outcomes {
        println!("{said}");
        say(&format!("{name}: {}, {seconds:.0} s", if *passed { "ok" } else { "FAILED" }));
    }
    let failed = outcomes.iter().filter(|it| !it.passed);
    let mut failed: Vec<_> = failed.map(|it| it.name.as_str()).collect();
    if shell::run(cargo().args(["test", "--workspace", "--doc"])).is_err() {
        failed.push("the documentation's examples");
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("tests failed: {}", failed.join(", "))) }
}

/// The test programs, from cargo's messages.
fn built() -> Result<Vec<Tests>> {
    let mut build = cargo();
    build.args(["test", "--workspace", "--no-run", "--message-format=json-render-diagnostics"]);
    say("$ cargo test --workspace --no-run");
    let output = build.stderr(Stdio::inherit()).output().map_err(|e| e.to_string())?;
    if !output.status.success() {
        return Err("the tests do not build".into());
    }
    let lines = String::from_utf8_lossy(&output.stdout);
    let all: Vec<_> = lines.lines().filter_map(Tests::of).collect();
    if all.is_empty() { Err("cargo built no tests".into()) } else { Ok(all) }
}

impl Tests {
    /// The test program that a message of cargo describes, if it does.
    fn of(message: &str) -> Option<Self> {
        let message: serde_json::Value = serde_json::from_str(message).ok()?;
        let program = message.get("executable")?.as_str()?;
        let manifest = message.get("manifest_path")?.as_str()?;
        let is_test = message.get("profile")?.get("test")?.as_bool()?;
        let package = Path::new(manifest).parent()?.to_path_buf();
        is_test.then(|| Self { program: program.into(), package })
    }

    fn outcome(&self) -> Outcome {
        let start = Instant::now();
        let output = Command::new(&self.program)
            .current_dir(&self.package)
            .env("CARGO_MANIFEST_DIR", &self.package)
            .stdin(Stdio::null())
            .output();
        let (passed, said) = match output {
            Ok(it) => {
                let said = [it.stdout, it.stderr].concat();
                (it.status.success(), String::from_utf8_lossy(&said).into_owned())
            }
            Err(error) => (false, error.to_string()),
        };
        let name = self.program.file_stem().unwrap_or_default().to_string_lossy();
        let name = name.rsplit_once('-').map_or(&*name, |(name, _)| name).to_owned();
        Outcome { name, passed, seconds: start.elapsed().as_secs_f32(), said }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_programs_of_tests_are_run() {
        let message = |test: bool| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/a/core/Cargo.toml",
                "profile":{{"test":{test}}},"executable":"/a/target/floe_core-0123"}}"#
            )
        };
        let found = Tests::of(&message(true)).expect("a program of tests");
        assert_eq!(found.package, Path::new("/a/core"));
        assert!(Tests::of(&message(false)).is_none());
        assert!(Tests::of(r#"{"reason":"build-finished","success":true}"#).is_none());
    }
}
