//! The bundled logs equal the output of the command that made them.

use std::path::{Path, PathBuf};

use floe::cli::simulate::{Args, run};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn remade(name: &str, scene: &str, seed: u64) -> String {
    let folder = std::env::temp_dir().join(format!("floe-bundled-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let output = folder.join(name);
    let scene = root().join("host-sim/scenes").join(scene);
    run(&Args { scene, output: output.clone(), truth: None, seed, duration_s: None }).unwrap();
    let text = std::fs::read_to_string(&output).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    text
}

fn bundled(name: &str) -> String {
    std::fs::read_to_string(root().join("host-sim/logs").join(name)).unwrap()
}

#[test]
fn csv_is_what_its_command_makes() {
    // The command line contains file names, which differ here.
    let without_command = |text: String| -> Vec<String> {
        text.lines().filter(|l| !l.starts_with("# made_by")).map(str::to_owned).collect()
    };
    for (name, scene, seed) in
        [("dff8-13.csv", "dff8-13.toml", 1), ("fig6-7.csv", "fig6-7.toml", 39)]
    {
        let text = bundled(name);
        assert!(text.starts_with("# SYNTHETIC"));
        assert_eq!(without_command(remade(name, scene, seed)), without_command(text));
    }
}

#[test]
fn cr10_is_what_its_command_makes() {
    let text = bundled("dff8-13.dat");
    assert_eq!(remade("dff8-13.dat", "dff8-13.toml", 1), text);
    assert_eq!(text.lines().count(), 1920);
    assert!(text.contains("\n101,1994,99,2359,59.875,"));
    assert!(text.contains("\n101,1994,100,0,0,"), "the day rolls over");
}
