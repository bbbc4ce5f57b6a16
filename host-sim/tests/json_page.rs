//! `docs/json.md` lists exactly the fields that are written.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Paths of all fields in the notation of the page: `events[].mu_s`.
fn fields(value: &Value, place: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (name, value) in object {
                let dot = if place.is_empty() { "" } else { "." };
                let path = format!("{place}{dot}{name}");
                // An object is represented by its fields.
                if !value.is_object() {
                    found.insert(path.clone());
                }
                fields(value, &path, found);
            }
        }
        Value::Array(list) => {
            list.iter().for_each(|value| fields(value, &format!("{place}[]"), found));
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// The fields in the tables of a section, and those in its tables of lists that may be empty.
fn told(page: &str, title: &str) -> [BTreeSet<String>; 2] {
    let section = page.split("\n## ").find(|section| section.starts_with(title)).unwrap();
    let (first, empty) = section.split_once("Elements of lists").unwrap_or((section, ""));
    [first, empty].map(|part| {
        let rows = part.lines().filter(|line| line.starts_with("| `"));
        let cells = rows.map(|row| row.split('|').nth(1).unwrap());
        let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
        names.map(str::to_string).collect()
    })
}

fn written(arguments: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_floe")).args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}");
    let mut found = BTreeSet::new();
    fields(&serde_json::from_slice(&output.stdout).unwrap(), "", &mut found);
    found
}

#[test]
fn the_page_names_every_form() {
    let page = fs::read_to_string("../docs/json.md").unwrap();
    assert!(!page.contains("no `schema`"));
    for file in ["cli/stiffness.rs", "weigh.rs", "campaign/summary.rs", "log/inspection.rs"] {
        let source = fs::read_to_string(Path::new("src").join(file)).unwrap();
        let (_, behind) = source.split_once("const SCHEMA: &str = \"").unwrap();
        let schema = behind.split('"').next().unwrap();
        assert!(page.contains(&format!("`{schema}`")), "{schema} is not told");
    }
}

#[test]
fn the_page_has_every_field_and_no_other() {
    let page = fs::read_to_string("../docs/json.md").unwrap();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("json-page");
    fs::create_dir_all(&folder).unwrap();
    let log = fs::read_to_string("logs/fig6-7.csv").unwrap();
    for (test, weight_n) in [600, 630, 700].into_iter().enumerate() {
        let log = log.replace("# weight_n: 630", &format!("# weight_n: {weight_n}"));
        fs::write(folder.join(format!("{test}.csv")), log).unwrap();
    }
    let folder = folder.to_str().unwrap();
    for (title, arguments) in [
        ("`floe replay`", ["replay", "logs/fig6-7.csv", "--json"]),
        ("`floe inspect`", ["inspect", "logs/fig6-7.csv", "--json"]),
        ("`floe campaign`", ["campaign", folder, "--json"]),
    ] {
        let [told, empty] = told(&page, title);
        let written = written(&arguments);
        // The page lists the fields of `mu` under `mu_s`.
        let same = |path: &str| {
            let ended = format!("{path}.").replace(".mu.", ".mu_s.");
            ended.trim_end_matches('.').to_string()
        };
        let holds = |path: &str| told.contains(path) || empty.contains(path);
        for path in &written {
            let list = written.iter().any(|it| it.starts_with(&format!("{path}[]")));
            assert!(list || holds(path) || holds(&same(path)), "{title}: {path} is not told");
        }
        for path in &told {
            let object = written.iter().any(|it| it.starts_with(&format!("{path}.")));
            assert!(object || written.contains(path), "{title}: {path} is not written");
        }
    }
}
