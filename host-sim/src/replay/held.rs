//! Constant forces that a turning winch does not explain.

use floe_core::Config;

use super::result::EventSummary;
use super::stretches::SteadySummary;

/// Blocks of a constant force (a second, 16 samples at least) from its end to where a line through
/// the rise begins: up to two are not in the stretch, and the winch needs time to get up to speed.
const NEAR: f64 = 4.0;

/// Takes the next event. A block that slides evenly does not come to rest while the winch turns: where
/// the force rises from the end of a constant one to a slip, the winch stood for part of it at least.
/// So it is unknown whether the block moved, unless a person said so, from `marked_s` on.
pub fn rise_to(
    event: &EventSummary,
    steady: &mut [SteadySummary],
    config: &Config,
    marked_s: Option<f64>,
) {
    let near_s = NEAR * (16.0 / f64::from(config.rate_hz)).max(1.0);
    let before = steady.partition_point(|it| it.start_s < event.onset_s);
    let mut begin_s = None;
    for it in steady.iter_mut().take(before).rev() {
        let rise_n = event.static_force_n - it.force_over_weight * f64::from(config.weight_n);
        let of_line_s = event.onset_s - rise_n / event.loading_rate_n_per_s;
        let is_near = begin_s.unwrap_or(of_line_s) - it.stop_s < near_s;
        let is_marked = marked_s.is_some_and(|from_s| from_s < it.stop_s);
        if !(rise_n > 0.0 && is_near) || is_marked {
            break;
        }
        it.moving = it.moving.filter(|moves| !moves);
        // A long one is given in parts.
        begin_s = Some(it.start_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::table::tests::event;

    const WEIGHT_N: f64 = 630.0;

    fn steady(start_s: f64, stop_s: f64, force_n: f64) -> SteadySummary {
        let (force_over_weight, moving) = (force_n / WEIGHT_N, Some(true));
        SteadySummary { start_s, stop_s, force_over_weight, std: 1e-3, moving, sliding: (0.0, 0.0) }
    }

    /// Whether the blocks are said to move, with a slip at 30 s that begins at 780 N, at 360 N/s.
    fn moving(steady: &[SteadySummary], marked_s: Option<f64>) -> Vec<Option<bool>> {
        let slip = EventSummary { onset_s: 30.0, static_force_n: 780.0, ..event() };
        let slip = EventSummary { loading_rate_n_per_s: 360.0, ..slip };
        let config = Config { weight_n: WEIGHT_N as f32, rate_hz: 16.0, ..Config::default() };
        let mut steady = steady.to_vec();
        rise_to(&slip, &mut steady, &config, marked_s);
        steady.iter().map(|it| it.moving).collect()
    }

    #[test]
    fn a_force_that_rises_to_a_slip_may_have_been_held() {
        assert_eq!(moving(&[steady(2.0, 28.5, 420.0)], None), [None]);
        let parts =
            [steady(2.0, 12.0, 425.0), steady(12.0, 20.0, 420.0), steady(20.0, 28.5, 420.0)];
        assert_eq!(moving(&parts, None), [None; 3]);
        let held = SteadySummary { moving: Some(false), ..steady(2.0, 28.5, 420.0) };
        assert_eq!(moving(&[held], None), [Some(false)]);
    }

    #[test]
    fn a_slide_before_a_fall_or_after_the_slip_stays_one() {
        // After the fall the line reaches the force of the slide again, later than the slide ended.
        assert_eq!(moving(&[steady(2.0, 20.0, 420.0)], None), [Some(true)]);
        assert_eq!(moving(&[steady(2.0, 29.5, 790.0)], None), [Some(true)]);
        assert_eq!(moving(&[steady(31.0, 50.0, 420.0)], None), [Some(true)]);
    }

    #[test]
    fn a_person_beside_the_winch_knows() {
        let both = [steady(2.0, 12.0, 420.0), steady(12.0, 28.5, 420.0)];
        assert_eq!(moving(&both, Some(12.0)), [Some(true); 2]);
        assert_eq!(moving(&both, Some(29.0)), [None; 2]);
    }
}
