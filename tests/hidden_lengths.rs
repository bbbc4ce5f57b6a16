//! Slips whose duration the samples hardly show: shorter than two samples, or ended by a slack
//! cable. If the winch's speed is known, the duration follows from speed and weight, within the
//! usual error of such speeds.

use floe_core::Config;
use floe_tests::both;
use floe_tests::scenes::stored;
use floe_tests::score::{Errors, Record, Score};

const RECORDS: u64 = 8;
const SCENES: [&str; 3] = ["hard/slack", "hard/unresolved", "honesty/short_slips"];

/// Errors of `mu_s` and `mu` if the core is given `of_winch` times the winch's true speed, or no
/// speed.
fn read(name: &str, of_winch: Option<f32>) -> [Errors; 2] {
    let scene = stored(name);
    let config = both::config(&scene);
    let winch_m_per_s = config.winch_m_per_s.zip(of_winch).map(|(speed, part)| part * speed);
    let config = Config { winch_m_per_s, ..config };
    let mut score = Score::default();
    for seed in 1..=RECORDS {
        score.add(&Record::of(&scene, seed, |_| 0.0).read(&config));
    }
    score.errors
}

#[test]
fn the_winch_tells_what_the_samples_do_not() {
    for name in SCENES {
        let ([mu_s, mu], [mu_s_alone, mu_alone]) = (read(name, Some(1.0)), read(name, None));
        for (what, with, alone) in [("mu_s", &mu_s, &mu_s_alone), ("mu", &mu, &mu_alone)] {
            println!("{name}, {what}: {:.3} % and {:.3} %", with.p95(), alone.p95());
            assert!(with.count() > 100, "{name}: {what} is read {} times", with.count());
            assert!(with.count() >= alone.count() * 99 / 100, "{name}: {what} is read less often");
            assert!(with.p95() < 0.8 * alone.p95(), "{name}: {what}");
        }
    }
}

#[test]
fn a_speed_that_is_a_tenth_off_is_within_the_intervals() {
    for name in SCENES {
        for of_winch in [0.9, 1.1] {
            for (what, errors) in ["mu_s", "mu"].into_iter().zip(read(name, Some(of_winch))) {
                let coverage = errors.coverage();
                println!("{name}, {of_winch} of the speed, {what}: {coverage:.3}");
                assert!(coverage > 0.9, "{name}, {of_winch} of the speed, {what}: {coverage}");
            }
        }
    }
}
