//! Generates the core in double precision: its source with every `f32` replaced by `f64`.
//!
//! `floe_tests::wide` is the reference for single precision, so nothing except the width may
//! differ. The text of `core/src` is converted word by word; code that cannot be converted stops
//! the build with a message that names it.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Module with functions on the bits of an `f32`; in the conversion libm replaces it.
const BITS: &str = "bits";

fn main() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    println!("cargo:rerun-if-changed={}", source.display());
    let wide = widened_core(&source).unwrap_or_else(|what| panic!("the core in f64: {what}"));
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR")).join("wide.rs");
    fs::write(out, wide).expect("OUT_DIR can be written");
}

/// All modules declared by `lib.rs`, and its re-exports.
fn widened_core(source: &Path) -> Result<String, String> {
    let root = read(&source.join("lib.rs"))?;
    let exports = root.lines().filter(|line| line.starts_with("pub use "));
    let exports = exports.map(|line| format!("{line}\n")).collect::<String>();
    Ok(widened_modules(&root, source)? + &exports)
}

/// The modules that a text declares, each as a nested module: from `folder/name.rs`, or from
/// `folder/name/mod.rs` with its submodules.
fn widened_modules(text: &str, folder: &Path) -> Result<String, String> {
    let mut wide = String::new();
    for name in text.lines().filter_map(declared_module).filter(|&name| name != BITS) {
        let (file, inner) = (folder.join(format!("{name}.rs")), folder.join(name));
        let file = if file.is_file() { file } else { inner.join("mod.rs") };
        let text = read(&file)?;
        let body = widened(&text).map_err(|what| format!("{}{what}", file.display()))?;
        let nested = widened_modules(&text, &inner)?;
        wide += &format!("/// `{name}` of the core.\npub mod {name} {{\n{body}{nested}}}\n");
    }
    Ok(wide)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn declared_module(line: &str) -> Option<&str> {
    let line = line.trim_start_matches("pub ").trim_start_matches("pub(crate) ");
    line.strip_prefix("mod ")?.strip_suffix(';')
}

/// A module without its tests, converted to double precision.
fn widened(text: &str) -> Result<String, String> {
    let text = without_tests(text)?;
    let mut wide = String::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = if line.trim_start().starts_with("//") {
            line.to_owned()
        } else {
            widened_line(line).map_err(|what| format!(":{number}: {what}"))?
        };
        wide += &line;
        wide.push('\n');
    }
    Ok(wide)
}

/// The text before the unit tests, which are the last item of a file.
fn without_tests(text: &str) -> Result<&str, String> {
    let Some((code, tests)) = text.split_once("\n#[cfg(test)]\n") else { return Ok(text) };
    let end = tests.find("\n}\n").map_or(tests.len(), |at| at + 3);
    if end < tests.len() || code.contains("cfg(test)") {
        return Err(": something follows the unit tests, or there are two of them".to_owned());
    }
    Ok(code)
}

fn widened_line(line: &str) -> Result<String, String> {
    // Feature-dependent derives are left out.
    if line.trim_start().starts_with(r#"#[cfg_attr(feature = "#) {
        return Ok(String::new());
    }
    if declared_module(line).is_some() {
        return Ok(String::new());
    }
    let mut wide = String::new();
    for piece in words(line) {
        let of_libm = wide.ends_with("libm::");
        wide += &match piece {
            "f32" => "f64".to_owned(),
            // sqrtf, atan2f and so on lose their suffix; the f of erf is none.
            _ if of_libm && piece != "erf" => piece.strip_suffix('f').unwrap_or(piece).to_owned(),
            // Bits are specific to the width.
            "to_bits" | "from_bits" => return Err(format!("`{piece}` cannot be widened")),
            _ if piece.ends_with("_f32") && piece.starts_with(|c: char| c.is_ascii_digit()) => {
                piece.replace("_f32", "_f64")
            }
            _ => piece.to_owned(),
        };
    }
    // All effects are enabled in the tests' core, and in the converted one.
    if let Some((before, rest)) = wide.split_once("cfg!(feature = ") {
        let after = rest.split_once(')').map_or("", |(_name, after)| after);
        wide = format!("{before}true{after}");
    }
    // micromath has single precision only, which suffices for a rough root.
    let wide = wide.replace("use crate::num::bits;", "").replace("bits::", "libm::");
    let wide = wide.replace("F32Ext::sqrt(x)", "f64::from(F32Ext::sqrt(x as f32))");
    Ok(wide.replace("crate::", "crate::wide::"))
}

/// The words of a line, and the text between them.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = line;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let end = rest.find(|c| is_word(c) != is_word(first)).unwrap_or(rest.len());
        let (piece, tail) = rest.split_at(end);
        rest = tail;
        Some(piece)
    })
}
