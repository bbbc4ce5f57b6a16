//! The rooms of the core: which may know which.

use std::fs;
use std::path::{Path, PathBuf};

/// From the bottom up: a room imports from those before it, never from those after.
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

/// Where a room stands; its name is that of the first folder or file below `src`.
fn rank(name: &str) -> Option<usize> {
    ROOMS.iter().position(|room| *room == name)
}

/// The rooms that a text without its tests names as `crate::room`.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let names = lines.flat_map(|line| line.split("crate::").skip(1));
    names.map(|rest| rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap())
}

#[test]
fn arrows_go_one_way() {
    let (src, mut arrows) = (core(), 0);
    for file in files(&src) {
        let place = file.strip_prefix(&src).unwrap().display().to_string();
        let room = place.split(['/', '\\', '.']).next().unwrap();
        if room == "lib" {
            continue;
        }
        let own = rank(room).unwrap_or_else(|| panic!("{place}: a room without a rank"));
        for other in imports(&fs::read_to_string(&file).unwrap()) {
            let rank = rank(other).unwrap_or_else(|| panic!("{place}: crate::{other}"));
            assert!(rank <= own, "{place} imports from crate::{other}, which stands above it");
            arrows += 1;
        }
    }
    assert!(arrows > 100, "{arrows} imports found: is this the core?");
}

/// A file that is longer holds two things: it is to be split where they meet.
#[test]
fn files_are_read_at_one_sitting() {
    const MOST_LINES: usize = 350;
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let own = ["core/src", "firmware/src", "xtask/src", "tests", "host-sim/board-model/src"];
    let files = own.iter().flat_map(|folder| files(&top.join(folder)));
    for file in files.filter(|file| file.extension().is_some_and(|it| it == "rs")) {
        let lines = fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= MOST_LINES, "{}: {lines} lines of {MOST_LINES}", file.display());
    }
}

#[test]
fn imports_are_found() {
    let text = "use crate::num::math;\n// crate::no\nfn f() { crate::stats::g() }\n#[cfg(test)]\nuse crate::late;";
    assert_eq!(imports(text).collect::<Vec<_>>(), ["num", "stats"]);
}
