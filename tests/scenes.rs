//! Every scene in the repository can be read and simulated.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use floe::sim::{Scene, simulate};
use serde_json::Value;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let (mut scenes, mut folders) = (Vec::new(), vec![folder]);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "toml") {
                scenes.push(path);
            }
        }
    }
    scenes
}

const WITHOUT_EVENTS: [&str; 8] = [
    "smooth",
    "weighing",
    "fig8-stiffness",
    "held_only",
    "noise_only",
    "steady_sliding",
    "hand_released",
    "breakaway",
];

/// Every term that scenes support occurs in some scene.
#[test]
fn no_term_is_without_a_scene() {
    let mut seen = HashSet::new();
    let mut known = HashSet::new();
    for path in scenes() {
        let scene = Scene::from_toml(&fs::read_to_string(&path).unwrap()).unwrap();
        let Value::Object(terms) = serde_json::to_value(&scene).unwrap() else { panic!("a table") };
        for (name, value) in terms {
            if !matches!(value, Value::Null | Value::Bool(false)) {
                seen.insert(name.clone());
            }
            known.insert(name);
        }
    }
    let missing: Vec<_> = known.difference(&seen).collect();
    assert!(known.len() > 30 && missing.is_empty(), "{missing:?}");
}

#[test]
fn every_scene_can_be_simulated() {
    let scenes = scenes();
    assert!(scenes.len() >= 95, "{} scenes", scenes.len());
    for path in scenes {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let scene = Scene::from_toml(&fs::read_to_string(&path).unwrap());
        let scene = scene.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let simulation = simulate(&scene, 1).unwrap_or_else(|e| panic!("{name}: {e}"));
        let without_events = WITHOUT_EVENTS.contains(&name.as_str());
        assert_eq!(simulation.events.is_empty(), without_events, "{name}");
        assert!(simulation.samples.iter().all(|s| s.force_n.is_finite()), "{name}");
        for event in &simulation.events {
            assert!(event.stop_s > event.onset_s && event.mu_s >= event.mu - 1e-12, "{name}");
        }
    }
}
