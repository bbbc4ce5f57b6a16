//! The README agrees with the code.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Value of `key = "value"` in a manifest.
fn manifest_value(manifest: &str, key: &str) -> String {
    let line = manifest.lines().find(|line| line.starts_with(&format!("{key} = "))).unwrap();
    line.split('"').nth(1).unwrap().to_owned()
}

/// Versions after the word Rust in a text, as in "Rust 1.88".
fn rust_versions(text: &str) -> Vec<&str> {
    text.split("Rust ")
        .skip(1)
        .map(|rest| rest.split(|c: char| !(c.is_ascii_digit() || c == '.')).next().unwrap_or(""))
        .map(|version| version.trim_end_matches('.'))
        .filter(|version| version.contains('.'))
        .collect()
}

#[test]
fn commands_that_exist() {
    let readme = read("README.md");
    for command in ["cargo run --release", "cargo xtask test"] {
        assert!(readme.contains(command), "the README does not say `{command}`");
    }
    // `cargo run` without a name runs `floe`, the default binary of the default member.
    assert!(read("Cargo.toml").contains(r#"default-members = ["host-sim"]"#));
    assert_eq!(manifest_value(&read("host-sim/Cargo.toml"), "default-run"), "floe");
    assert!(read(".cargo/config.toml").contains("xtask"), "`cargo xtask` needs its alias");
}

/// Every `floe ...` in the README is a command with a file of its own.
#[test]
fn subcommands_are_known() {
    let readme = read("README.md");
    let code = readme.split("```").skip(1).step_by(2);
    let mut commands = 0;
    for line in code.flat_map(str::lines) {
        let Some(rest) = line.trim_start_matches("$ ").strip_prefix("floe ") else { continue };
        let word = rest.split_whitespace().next().unwrap_or_default();
        let file = root().join("host-sim/src/cli").join(word).with_extension("rs");
        assert!(word.starts_with('-') || file.is_file(), "README: {line}");
        commands += 1;
    }
    assert!(commands > 1, "the README shows {commands} commands");
}

#[test]
fn rate_and_schema() {
    let readme = read("README.md");
    let rate = format!("{} Hz", floe_core::Config::default().rate_hz);
    assert!(readme.contains(&rate), "the README does not name the default rate, {rate}");
    let schema = floe::replay::result::SCHEMA;
    assert!(readme.contains(schema), "the README does not name the schema {schema}");
}

/// The README gives the number of log formats in the table of `docs/logs.md`.
#[test]
fn forms_of_logs() {
    let page = read("docs/logs.md");
    let forms = page.lines().filter(|line| line.starts_with("| ")).count() - 1;
    assert!(page.contains(&format!("\n{forms} forms.")), "docs/logs.md: {forms} rows");
    let shown = format!("shows {forms} forms");
    assert!(read("README.md").contains(&shown), "the README does not say `{shown}`");
}

/// The code in the core's README is that of its example.
#[test]
fn the_core_readme_shows_its_example() {
    let readme = read("core/README.md");
    let shown = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert!(read("core/examples/host.rs").contains(shown.trim_end()), "{shown}");
}

#[test]
fn rust_version() {
    let version = manifest_value(&read("Cargo.toml"), "rust-version");
    let readme = read("README.md");
    let named = rust_versions(&readme);
    assert!(!named.is_empty(), "the README does not say which Rust it needs, Rust {version}");
    assert!(named.iter().all(|named| *named == version), "README {named:?}, Cargo.toml {version}");
}

/// Every place named in `docs/method.md`, such as `fit.rs::Data::normal`, exists: the file has the
/// function or type, and the type before it.
#[test]
fn places_in_the_code_exist() {
    let page = read("docs/method.md");
    let places: Vec<&str> =
        page.split('`').skip(1).step_by(2).filter(|code| code.contains(".rs::")).collect();
    assert!(places.len() > 40, "{} places", places.len());
    for place in places {
        let mut parts = place.split("::");
        let code = read(&format!("core/src/{}", parts.next().unwrap()));
        for name in parts {
            assert!(defines(&code, name), "docs/method.md: {place}: no {name}");
        }
    }
}

/// Whether a file defines a function, a type or functions of a type of this name. The functions of
/// a type may be in another file than the type.
fn defines(code: &str, name: &str) -> bool {
    let ends = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
    ["fn ", "struct ", "enum ", "type ", "impl "].iter().any(|kind| {
        let defined = format!("{kind}{name}");
        code.match_indices(&defined).any(|(at, _)| ends(&code[at + defined.len()..]))
    })
}

#[test]
fn a_name_that_only_begins_like_another_is_not_defined() {
    assert!(defines("impl Data<'_> {\n    fn normal(&self)", "normal"));
    assert!(!defines("impl Data<'_> {\n    fn normal_of(&self)", "normal"));
}

#[test]
fn versions_are_found_in_text() {
    assert_eq!(rust_versions("needs Rust 1.88 or later. Rust is fine"), ["1.88"]);
    assert_eq!(rust_versions("Rust 1.90."), ["1.90"]);
}
