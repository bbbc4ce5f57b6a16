//! The rooms of the core: which may know which.

use std::collections::HashSet;
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

/// The paths behind `crate::` that a text without its tests names.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let paths = lines.flat_map(|line| line.split("crate::").skip(1));
    paths.map(|rest| {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        rest[..end.unwrap_or(rest.len())].trim_end_matches(':')
    })
}

/// Path of the module that a file below `src` holds.
fn module(file: &Path) -> String {
    let place = file.strip_prefix(core()).unwrap().with_extension("");
    let names: Vec<_> = place.iter().map(|name| name.to_str().unwrap()).collect();
    names.join("::").trim_end_matches("::mod").to_owned()
}

/// From one module to another, both named by their paths.
type Arrow = (String, String);

/// Every import of the core, from the module that has it to the path that it names.
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

/// An import as one between neighbours: of what two paths begin with alike the parts that differ
/// first. None to the folder that a module is in, nor to what a folder holds.
fn between_neighbours((from, to): &Arrow) -> Option<Arrow> {
    let (from, to): (Vec<_>, Vec<_>) = (from.split("::").collect(), to.split("::").collect());
    let alike = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let differs = alike < from.len().min(to.len());
    differs.then(|| (from[..=alike].join("::"), to[..=alike].join("::")))
}

/// The arrows that are left when those to where none begins are taken away, again and again.
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

/// Inside a room too.
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
    assert_eq!(imports(text).collect::<Vec<_>>(), ["num::math", "stats::g"]);
}
