//! A winch that runs back for about as long as a slip takes.

use floe::sim::Scene;
use floe::sim::winch::WinchProfile;
use floe_tests::score;

/// A heavy block, whose slips take five to six samples. The winch runs back for .3 s at two to six
/// times its speed: the force falls in as many samples, but along a straight line.
#[test]
fn winding_back_for_as_long_as_a_slip_is_no_slip() {
    for speed in [2.0, 3.0, 4.0, 6.0] {
        let steps = vec![[8.3, -speed], [8.6, 1.0]];
        let mut scene = Scene {
            weight_n: 3000.0,
            mu_s: 0.85,
            mu: 0.5,
            winch_m_per_s: 0.02,
            winch_profile: Some(WinchProfile::Steps { steps, period_s: Some(9.1) }),
            duration_s: 200.0,
            ..Scene::default()
        };
        scene.measurement.white_n = 3.0;
        let (mut invented, mut truths, mut found) = (0, 0, 0);
        for seed in 1..=12 {
            let tried = score::run(&scene, seed);
            invented += tried.detection.false_alarms;
            truths += tried.truths.len();
            found += tried.detection.hits;
        }
        println!("{speed}: {invented} invented, {found} of {truths} found");
        assert!(invented * 50 < truths && found * 50 > truths * 49, "{speed}: {invented}");
    }
}
