//! Compares methods on equal samples: speed against error.
//!
//! ```text
//!  Scene ─► Trial (samples, truth) ─┬─► Method ─► Found ─► Row (error, speed)
//!                                   ├─► Method ─► ...
//!                                   └─► ...
//! ```
//!
//! Every method gets the same samples in the same order and the same information: rate, weight,
//! slope and range of the cell. No method gets the truth.

pub mod cutter;
pub mod ellipse;
pub mod extremes;
pub mod history;
pub mod kalman;
pub mod least_squares;
pub mod loops;
pub mod matching;
pub mod measure;
pub mod method;
pub mod ours;
pub mod page;
pub mod phase_plane;
pub mod picture;
pub mod result;
pub mod scenes;
pub mod segments;
pub mod table;

pub use method::{Found, Method, Sample, Setup, Tick, Value};

use crate::sim::SceneError;

use result::{BenchResult, Host, Row, SCHEMA};
use scenes::{Effort, Trial};

/// The methods, in the order of the tables.
const METHODS: [fn(&Trial) -> Row; 6] = [
    measure::assess::<extremes::Extremes>,
    measure::assess::<phase_plane::PhasePlane>,
    measure::assess::<ellipse::Ellipse>,
    measure::assess::<kalman::Kalman>,
    measure::assess::<least_squares::LeastSquares>,
    measure::assess::<ours::Floe>,
];

/// Runs all methods on all scenes. `progress` gets the number of scenes done, the number of all
/// scenes, and the name of the next one.
///
/// # Errors
/// A scene cannot be simulated.
pub fn run(quick: bool, progress: impl Fn(usize, usize, &str)) -> Result<BenchResult, SceneError> {
    let effort = if quick { Effort::QUICK } else { Effort::FULL };
    let plans = scenes::plans(effort)?;
    let (mut rows, mut one_pass_ns) = (Vec::new(), f64::INFINITY);
    for (done, plan) in plans.iter().enumerate() {
        progress(done, plans.len(), plan.name());
        let trial = plan.run()?;
        one_pass_ns = one_pass_ns.min(measure::one_pass_ns(&trial));
        rows.extend(METHODS.map(|assess| assess(&trial)));
    }
    Ok(BenchResult { schema: SCHEMA.to_owned(), host: host(), first_seed: 1, one_pass_ns, rows })
}

fn host() -> Host {
    // Linux provides the name; elsewhere it stays unknown.
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name"));
    let processor = name.map(|name| name.trim_start_matches([' ', '\t', ':']).to_owned());
    Host { processor, debug_build: cfg!(debug_assertions) }
}

#[cfg(test)]
mod tests {
    use super::extremes::Extremes;
    use super::least_squares::LeastSquares;
    use super::measure::judge;
    use super::*;

    #[test]
    fn the_reference_reaches_the_bound_on_linear_scenes() {
        for trial in scenes::tests::linear(2.0, 1200) {
            let judgement = judge::<LeastSquares>(&trial);
            assert!(judgement.detection.f1() > 0.999, "{}", trial.name);
            for errors in [judgement.mu_s.unwrap(), judgement.mu.unwrap()] {
                let ratio = errors.over_bound.unwrap();
                assert!((0.85..1.05).contains(&ratio), "{}: {ratio}", trial.name);
                let coverage = errors.coverage_percent.unwrap();
                assert!((92.0..98.0).contains(&coverage), "{}: {coverage}", trial.name);
            }
        }
    }

    #[test]
    fn largest_and_smallest_force_err_as_in_the_model_s_table() {
        // Noise of 2 N: ratio of error to bound for mu_s and mu. The table's light block is not
        // described well enough for a comparison.
        let table = [("dff8-13", 12.0, 940.0), ("heavy", 15.0, 3700.0), ("fast", 8.0, 800.0)];
        let trials = scenes::tests::linear(2.0, 300);
        for (name, mu_s, mu) in table {
            let trial = trials.iter().find(|trial| trial.name == name).unwrap();
            let judgement = judge::<Extremes>(trial);
            let ratio = |e: Option<result::Errors>| e.unwrap().over_bound.unwrap();
            for (found, expected) in [(ratio(judgement.mu_s), mu_s), (ratio(judgement.mu), mu)] {
                assert!((0.5..2.0).contains(&(found / expected)), "{name}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_quick_run_fills_every_table_and_the_picture() {
        let result = run(true, |_, _, _| {}).unwrap();
        assert_eq!(result.rows.len() % METHODS.len(), 0);
        assert_eq!(table::blocks(&result.rows).count(), result.rows.len() / METHODS.len());
        for row in &result.rows {
            let times = row.ns_per_sample > 0.0 && row.worst_tick_ns.is_some() == row.streams;
            assert!(times && (0.0..=1.0).contains(&row.f1), "{row:?}");
        }
        let svg = picture::svg(&result);
        assert!(roxmltree::Document::parse(&svg).is_ok());
        let (text, page) = (table::text(&result), page::markdown(&result, "p.svg"));
        for row in &result.rows {
            assert!(text.contains(&row.scene) && page.contains(&row.scene));
            assert!(svg.contains(&row.method) && page.contains(&row.method));
        }
        assert!(!text.contains("NaN") && !page.contains("NaN") && !svg.contains("NaN"));
        let json = serde_json::to_string(&result).unwrap();
        assert!(json.contains("\"schema\":\"floe-bench/1\""));
    }
}
