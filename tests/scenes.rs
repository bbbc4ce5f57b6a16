//! Every scene in the repository can be read and simulated.

use std::fs;
use std::path::{Path, PathBuf};

use floe::sim::{Scene, simulate};

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut scenes = Vec::new();
    for part in ["", "linear", "hard", "paper", "honesty"] {
        let files = fs::read_dir(folder.join(part)).unwrap().map(|f| f.unwrap().path());
        scenes.extend(files.filter(|f| f.extension().is_some_and(|e| e == "toml")));
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

#[test]
fn every_scene_can_be_simulated() {
    let scenes = scenes();
    assert!(scenes.len() >= 78);
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
