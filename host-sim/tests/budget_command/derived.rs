//! Quantities that follow from the coefficients: omega, slip length and energy.

use crate::{EXACT, number, replay_of, simulated_from};

/// The weight's own part along a slope does no work against friction.
#[test]
fn energy_is_that_of_friction_on_a_slope() {
    let folder = tempfile::tempdir().unwrap();
    let scene = include_str!("../../scenes/dff8-13.toml");
    for slope_deg in [12.0_f64, -3.0] {
        let path = folder.path().join("slope.toml");
        std::fs::write(&path, format!("slope_deg = {slope_deg:.1}\n{scene}")).unwrap();
        let log = simulated_from(&folder, &path, "1");
        let result = replay_of(&log, &EXACT);
        let normal_n = 630.0 * slope_deg.to_radians().cos();
        let events = result["events"].as_array().unwrap();
        let read = events.iter().filter(|event| !event["energy_j"].is_null());
        assert!(read.clone().count() > 20);
        for event in read {
            let work_j = number(&event["mu"]) * normal_n * number(&event["slip_length_m"]);
            assert!((number(&event["energy_j"]) / work_j - 1.0).abs() < 1e-4, "{event}");
        }
    }
}

/// Of slips of a sample those with an omega are the few that came out long: .6 of the true omega.
#[test]
fn the_omega_of_a_few_long_slips_is_not_that_of_the_test() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("short.toml");
    let short = "duration_s = 120.0\nweight_n = 630.0\nmu_s = 1.24\nmu = 0.78\n\
                 stiffness_n_per_m = 138000.0\nwinch_m_per_s = 0.0035\n\
                 [variation]\nmu_s_fraction = 0.01\nmu_fraction = 0.01\n[measurement]\nwhite_n = 2.0\n";
    std::fs::write(&scene, short).unwrap();
    for seed in ["15", "21"] {
        let log = simulated_from(&folder, &scene, seed);
        let text = std::fs::read_to_string(&log).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with("# winch_"));
        std::fs::write(&log, lines.collect::<Vec<_>>().join("\n")).unwrap();
        let result = replay_of(&log, &[]);
        let events = result["events"].as_array().unwrap();
        let with_omega = events.iter().filter(|event| !event["omega_rad_per_s"].is_null()).count();
        assert!((1..10).contains(&with_omega), "{with_omega}");
        for name in ["omega_rad_per_s", "stiffness_n_per_m", "slip_length_m", "energy_j"] {
            assert!(result[name].is_null(), "{name} {}", result[name]);
        }
        assert!(events.iter().all(|event| event["slip_length_m"].is_null()));
    }
}

/// The longest slips of a cable that is slack at times have no length: the others' mean is not the
/// test's.
#[test]
fn the_length_of_the_shorter_slips_is_not_that_of_the_test() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("at_times.toml");
    for (mu_s, is_known) in [(0.805, false), (0.75, true)] {
        let text = format!(
            "duration_s = 120.0\nweight_n = 630.0\nmu_s = {mu_s}\nmu = 0.4\nstiffness_n_per_m = 23000.0\n\
             winch_m_per_s = 0.0157\n[variation]\nmu_s_fraction = 0.01\nmu_fraction = 0.01\n\
             [measurement]\nwhite_n = 1.0\n"
        );
        std::fs::write(&scene, text).unwrap();
        let result = replay_of(&simulated_from(&folder, &scene, "1"), &EXACT);
        let events = result["events"].as_array().unwrap();
        let slack = events.iter().filter(|event| event["slack"] == true).count();
        assert_eq!(slack * 20 < events.len(), is_known, "{slack} of {}", events.len());
        for name in ["slip_length_m", "energy_j"] {
            assert_eq!(result[name].is_null(), !is_known, "{name} {}", result[name]);
        }
    }
}
