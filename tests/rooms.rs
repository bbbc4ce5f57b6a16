//! The modules of the core and their permitted imports.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Top-level modules from the lowest to the highest: each may import only from earlier ones.
const ROOMS: [&str; 20] = [
    "num",
    "units",
    "sample",
    "effect",
    "config",
    "stats",
    "signal",
    "model",
    "noise",
    "coefficient",
    "fit",
    "detector",
    "effects",
    "event",
    "stretch",
    "report",
    "budget",
    "estimator",
    "cycle",
    "pipeline",
];

fn core() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

/// Position of a top-level module, named after its file or folder below `src`.
fn rank(name: &str) -> Option<usize> {
    ROOMS.iter().position(|room| *room == name)
}

/// The paths after `crate::` in a text without its tests.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let paths = lines.flat_map(|line| line.split("crate::").skip(1));
    paths.map(|rest| {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        rest[..end.unwrap_or(rest.len())].trim_end_matches(':')
    })
}

/// Module path of a file below `src`.
fn module(file: &Path) -> String {
    let place = file.strip_prefix(core()).unwrap().with_extension("");
    let names: Vec<_> = place.iter().map(|name| name.to_str().unwrap()).collect();
    names.join("::").trim_end_matches("::mod").to_owned()
}

/// An import, from one module path to another.
type Arrow = (String, String);

/// Every import in the core, from the module with the import to the imported path.
fn arrows() -> Vec<Arrow> {
    let of_file = |file: PathBuf| {
        let (from, text) = (module(&file), fs::read_to_string(&file).unwrap());
        let paths = imports(&text).map(str::to_owned);
        paths.map(|to| (from.clone(), to)).collect::<Vec<_>>()
    };
    let found: Vec<_> = files(&core()).into_iter().flat_map(of_file).collect();
    assert!(found.len() > 100, "{} imports found: is this the core?", found.len());
    found
}

#[test]
fn arrows_go_one_way() {
    let room = |path: &str| path.split("::").next().unwrap().to_owned();
    for (from, to) in arrows().iter().filter(|(from, _)| from != "lib") {
        let own = rank(&room(from)).unwrap_or_else(|| panic!("{from}: a room without a rank"));
        let rank = rank(&room(to)).unwrap_or_else(|| panic!("{from}: crate::{to}"));
        assert!(rank <= own, "{from} imports crate::{to}, which stands above it");
    }
}

/// An import reduced to sibling modules: both paths cut after the first part that differs. `None`
/// for imports between a module and its parent.
fn between_neighbours((from, to): &Arrow) -> Option<Arrow> {
    let (from, to): (Vec<_>, Vec<_>) = (from.split("::").collect(), to.split("::").collect());
    let alike = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let differs = alike < from.len().min(to.len());
    differs.then(|| (from[..=alike].join("::"), to[..=alike].join("::")))
}

/// The arrows left after repeatedly removing those that lead to a module without imports.
fn circles(mut arrows: Vec<Arrow>) -> Vec<Arrow> {
    loop {
        let (count, begins) = (arrows.len(), arrows.iter().map(|(from, _)| from.clone()));
        let begins: HashSet<_> = begins.collect();
        arrows.retain(|(_, to)| begins.contains(to));
        if arrows.len() == count {
            return arrows;
        }
    }
}

/// Modules do not import in circles, even below the top level.
#[test]
fn neighbours_import_in_no_circle() {
    let neighbours = arrows().iter().filter_map(between_neighbours).collect();
    let left = circles(neighbours);
    assert!(left.is_empty(), "in a circle, or on the way to one: {left:#?}");
}

#[test]
fn circles_are_found() {
    let arrows = |names: &[(&str, &str)]| -> Vec<Arrow> {
        let pairs = names.iter().map(|(from, to)| ((*from).into(), (*to).into()));
        pairs.filter_map(|arrow| between_neighbours(&arrow)).collect()
    };
    let one_way = arrows(&[("a::b", "a::c::T"), ("a::c::d", "a::e::f"), ("a::e", "a::e::f")]);
    assert_eq!((one_way.len(), circles(one_way)), (2, vec![]));
    let there_and_back = arrows(&[("a::b", "a::c::T"), ("a::c::d", "a::b"), ("a::e", "b")]);
    assert_eq!(circles(there_and_back).len(), 2);
}

/// A longer file has more than one topic and must be split.
#[test]
fn files_are_read_at_one_sitting() {
    const MOST_LINES: usize = 350;
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for own in [
        "core/src",
        "firmware/src",
        "firmware/tests",
        "host-sim/src",
        "host-sim/tests",
        "host-sim/board-model/src",
        "tests",
        "xtask/src",
    ] {
        let is_code = |file: &PathBuf| file.extension().is_some_and(|it| it == "rs");
        let files: Vec<_> = files(&top.join(own)).into_iter().filter(is_code).collect();
        assert!(!files.is_empty(), "{own} has no files");
        for file in files {
            let lines = fs::read_to_string(&file).unwrap().lines().count();
            assert!(lines <= MOST_LINES, "{}: {lines} lines of {MOST_LINES}", file.display());
        }
    }
}

/// A test that the manifest does not name is never built, and never fails.
#[test]
fn every_test_is_in_the_manifest() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = fs::read_to_string(own.join("Cargo.toml")).unwrap();
    let mut tests = 0;
    for entry in fs::read_dir(own).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let main = format!("{name}/main.rs");
        let path = if own.join(&main).is_file() { main } else { name };
        if path.ends_with(".rs") && path != "build.rs" {
            assert!(manifest.contains(&format!("\npath = \"{path}\"\n")), "{path} is not built");
            tests += 1;
        }
    }
    assert_eq!(manifest.matches("[[test]]").count(), tests);
}

#[test]
fn imports_are_found() {
    let text = "use crate::num::math;\n// crate::no\nfn f() { crate::stats::g() }\n#[cfg(test)]\nuse crate::late;";
    assert_eq!(imports(text).collect::<Vec<_>>(), ["num::math", "stats::g"]);
}
