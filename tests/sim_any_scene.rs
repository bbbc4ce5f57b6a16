//! Any valid scene, with any terms, runs to its end with physically possible states.

use std::cell::Cell;

use floe::sim::measurement::{Chance, Drift, Flop, Hum, Late, ZeroStep};
use floe::sim::motion::Segments;
use floe::sim::state::End;
use floe::sim::terms::{
    Breaking, Creep, Drag, HoldTime, PartialSlips, RateDependence, Sag, Snow, Tilt, Variation,
    WinchProfile,
};
use floe::sim::{Measurement, Method, Scene, simulate};
use floe_tests::random::check;
use proptest::prelude::*;

fn maybe<T: std::fmt::Debug + Clone + 'static>(
    term: impl Strategy<Value = T> + 'static,
) -> BoxedStrategy<Option<T>> {
    prop_oneof![3 => Just(None), 1 => term.prop_map(Some)].boxed()
}

/// Powers of ten with a uniform exponent.
fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low..high).prop_map(|x| 10_f64.powf(x))
}

fn block() -> impl Strategy<Value = Scene> {
    let difference = prop_oneof![Just(0.0), (-4.0..0.3).prop_map(|x: f64| 10_f64.powf(x))];
    let start = prop_oneof![Just(0.0), 0.0..2.0];
    (
        decades(0.0, 4.0),
        0.1..1.2,
        difference,
        decades(1.5, 5.0),
        decades(-4.0, -0.3),
        -5.0..5.0,
        start,
        any::<bool>(),
    )
        .prop_map(|(weight_n, mu, difference, k, w, slope_deg, start, sliding)| Scene {
            weight_n,
            mu,
            mu_s: mu + difference,
            stiffness_n_per_m: k,
            winch_m_per_s: w,
            slope_deg,
            start_force_n: start * weight_n,
            start_sliding: sliding && start < 0.3,
            duration_s: 8.0,
            ..Scene::default()
        })
}

fn friction_terms(scene: Scene) -> impl Strategy<Value = Scene> {
    let weight_n = scene.weight_n;
    let mu = scene.mu;
    (
        maybe((0.0..0.2, 0.0..0.1).prop_map(|(s, d)| Snow {
            depth_mm: 10.0,
            mu_s_offset: s + d,
            mu_offset: d,
        })),
        maybe(
            (0.0..0.3, 0.0..0.3).prop_map(|(a, b)| Variation { mu_s_fraction: a, mu_fraction: b }),
        ),
        maybe(
            (0.0..1.0, 0.0..1.0)
                .prop_map(|(p, d)| PartialSlips { probability: p, drop_fraction: d }),
        ),
        maybe(
            (decades(-2.0, 2.0), 0.0..0.5)
                .prop_map(|(t, b)| HoldTime { reference_s: t, per_decade: b }),
        ),
        maybe(
            (decades(-3.0, -1.0), -0.25..0.5).prop_map(move |(v, b)| RateDependence {
                reference_m_per_s: v,
                per_decade: b * mu,
            }),
        ),
        maybe(
            (0.0..0.99, decades(-3.0, -0.5))
                .prop_map(move |(f, r)| Creep { onset_fraction: f, range_n: r * weight_n }),
        ),
        maybe(
            (0.1..8.0, 0.3..3.0)
                .prop_map(move |(t, w)| Breaking { at_s: t, weight_n: w * weight_n }),
        ),
        maybe((-2.0..2.0).prop_map(|t| Tilt { deg_per_m: t })),
        maybe(decades(-1.0, 3.0).prop_map(|c| Drag { n_s2_per_m2: c, n_s_per_m: c })),
    )
        .prop_map(
            move |(
                snow,
                variation,
                partial_slips,
                hold_time,
                rate,
                creep,
                breaking,
                tilt,
                drag,
            )| {
                Scene {
                    snow,
                    variation,
                    partial_slips,
                    hold_time,
                    rate_dependence: rate,
                    creep,
                    breaking,
                    tilt,
                    drag,
                    ..scene.clone()
                }
            },
        )
}

fn cable_terms(scene: Scene) -> impl Strategy<Value = Scene> {
    let ripple = (0.0..1.0, decades(-1.0, 1.0))
        .prop_map(|(f, t)| WinchProfile::Ripple { fraction: f, period_s: t });
    let stop = (decades(-1.0, 1.0), decades(-1.0, 1.0))
        .prop_map(|(g, s)| WinchProfile::StopAndGo { go_s: g, stop_s: s });
    let sag =
        (decades(-1.0, 1.0), 0.1..1.0).prop_map(|(q, h)| Sag { weight_n_per_m: q, height_m: h });
    (any::<bool>(), maybe(sag), maybe(prop_oneof![ripple, stop])).prop_map(
        move |(shortening, sag, winch_profile)| Scene {
            shortening,
            sag,
            winch_profile,
            ..scene.clone()
        },
    )
}

fn measurement_terms(scene: Scene) -> impl Strategy<Value = Scene> {
    let chance = || maybe((0.0..0.5).prop_map(|probability| Chance { probability }));
    (
        0.0..0.06,
        maybe((0.0..50.0, 0.5..10.0).prop_map(|(a, f)| Flop {
            amplitude_n: a,
            hz: f,
            decay_per_s: 3.0,
        })),
        maybe((0.0..5.0, 1.0..100.0).prop_map(|(a, f)| Hum { amplitude_n: a, hz: f })),
        maybe((0.0..20.0).prop_map(|a| Drift { amplitude_n: a, period_s: 60.0 })),
        maybe((0.0..8.0).prop_map(|t| ZeroStep { at_s: t, height_n: -10.0 })),
        chance(),
        chance(),
        maybe((0.0..0.5, 0.0..0.06).prop_map(|(p, d)| Late { probability: p, delay_s: d })),
        -1000.0..1000.0,
    )
        .prop_map(
            move |(aperture_s, flop, hum, drift, zero_step, dropped, repeated, late, ppm)| {
                let measurement = Measurement {
                    aperture_s,
                    flop,
                    hum,
                    drift,
                    zero_step,
                    dropped,
                    repeated,
                    late,
                    clock_ppm: ppm,
                    white_n: 1.0,
                    flicker_n: 0.5,
                    ..Measurement::default()
                };
                Scene { measurement, ..scene.clone() }
            },
        )
}

fn any_scene() -> impl Strategy<Value = Scene> {
    block()
        .prop_flat_map(friction_terms)
        .prop_flat_map(cable_terms)
        .prop_flat_map(measurement_terms)
        .prop_filter("valid", |scene| scene.validate().is_ok())
}

/// Checks that segments follow each other without a gap, and that states are physically possible.
fn check_motion(scene: &Scene) {
    let mut segments = Segments::new(scene, 3, Method::for_scene(scene));
    let mut last: Option<floe::sim::motion::Segment> = None;
    for (number, segment) in segments.by_ref().enumerate() {
        assert!(number < 2_000_000, "the motion does not get on");
        if let Some(last) = last {
            assert!((last.to.time_s - segment.from.time_s).abs() < 1e-12);
            assert!(last.end != End::Stop || segment.from.speed_m_per_s == 0.0);
        }
        let scale_n = scene.weight_n * 10.0;
        assert!(segment.to.time_s >= segment.from.time_s - 1e-12);
        assert!(segment.from.force_n >= -1e-9 * scale_n, "{:?}", segment.from);
        assert!(segment.from.slack_m >= -1e-9 && segment.from.speed_m_per_s >= -1e-9);
        if segment.to.time_s > scene.duration_s {
            return;
        }
        last = Some(segment);
    }
    assert!(is_at_winch(segments.failure()), "{:?}", segments.failure());
}

/// Whether the block runs into the winch, the only failure that cannot be excluded in advance.
fn is_at_winch(failure: Option<&str>) -> bool {
    failure.is_none_or(|f| f.contains("runs into the winch"))
}

#[test]
fn any_valid_scene_runs_and_stays_physical() {
    const CASES: u32 = 200;
    let (at_winch, with_events) = (Cell::new(0), Cell::new(0));
    check(CASES, any_scene(), |scene| {
        check_motion(&scene);
        let simulation = match simulate(&scene, 3) {
            Ok(simulation) => simulation,
            Err(failure) => {
                prop_assert!(is_at_winch(Some(&failure.to_string())), "{failure}");
                at_winch.set(at_winch.get() + 1);
                return Ok(());
            }
        };
        for sample in &simulation.samples {
            prop_assert!(sample.force_n.is_finite());
        }
        for pair in simulation.events.windows(2) {
            prop_assert!(pair[1].onset_s >= pair[0].stop_s - 1e-12);
        }
        for event in &simulation.events {
            prop_assert!(event.stop_s >= event.onset_s && event.peak_force_n.is_finite());
            prop_assert!(event.dynamic_force_n.is_finite() && event.mu.is_finite());
        }
        with_events.set(with_events.get() + u32::from(simulation.events.len() > 1));
        Ok(())
    });
    let (at_winch, with_events) = (at_winch.get(), with_events.get());
    println!("{CASES} scenes: {at_winch} end at the winch, {with_events} have slips");
    assert!(at_winch < CASES / 20 && with_events > CASES / 6, "{at_winch} {with_events}");
}
