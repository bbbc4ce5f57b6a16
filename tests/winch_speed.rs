//! A winch whose speed changes: what was learnt of the loading rate no longer holds, and an event's own
//! samples decide.
//!
//! `cargo test -p floe-tests --test winch_speed -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe::sim::winch::WinchProfile;
use floe_tests::scenes::stored;
use floe_tests::score::Score;

/// The speed goes to and fro between the nominal one and this factor of it, every nine seconds: at
/// least .95 of the slips have coefficients, and .9 of the intervals cover. (Of a change by a hundredth,
/// which one rest at 16 Hz shows with four standard deviations, .88.)
#[test]
fn events_after_a_change_of_speed_are_read_and_covered() {
    for factor in [1.02, 1.1, 1.3] {
        let steps = vec![[0.0, 1.0], [9.0, factor]];
        let winch_profile = Some(WinchProfile::Steps { steps, period_s: Some(18.0) });
        let scene = Scene { winch_profile, ..stored("honesty/base") };
        let score = Score::of(&scene, usize::MAX, 6);
        let read = score.share_read();
        let [mu_s, mu] = score.errors.map(|errors| errors.coverage());
        println!("{factor}: {read:.3} are read, cover {mu_s:.3} {mu:.3}");
        assert!(read > 0.95, "{factor}: {read:.3} are read");
        assert!(mu_s.min(mu) > 0.9, "{factor}: {mu_s:.3} {mu:.3}");
    }
}
