//! Methods side by side on the same samples: speed against error.
//!
//! ```text
//!  Scene ─► Trial (samples, truth) ─┬─► Method ─► Found ─► Row (error, speed)
//!                                   ├─► Method ─► ...
//!                                   └─► ...
//! ```
//!
//! Every method sees the same samples in the same order and knows the same:
//! rate, weight, slope and the range of the cell. None sees the truth.

pub mod cutter;
pub mod ellipse;
pub mod extremes;
pub mod history;
pub mod kalman;
pub mod least_squares;
pub mod linear_fit;
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
use scenes::Trial;

/// The methods, in the order of the tables.
const METHODS: [fn(&Trial) -> Row; 6] = [
    measure::assess::<extremes::Extremes>,
    measure::assess::<phase_plane::PhasePlane>,
    measure::assess::<ellipse::Ellipse>,
    measure::assess::<kalman::Kalman>,
    measure::assess::<least_squares::LeastSquares>,
    measure::assess::<ours::Floe>,
];

/// Runs all methods on all scenes; `progress` gets the number of scenes done, of
/// all scenes, and the name of the one that begins.
///
/// # Errors
/// A scene that cannot be simulated.
pub fn run(quick: bool, progress: impl Fn(usize, usize, &str)) -> Result<BenchResult, SceneError> {
    let plans = scenes::plans(quick)?;
    let (mut rows, mut one_pass_ns) = (Vec::new(), f64::INFINITY);
    for (done, plan) in plans.iter().enumerate() {
        progress(done, plans.len(), plan.name());
        let trial = plan.run()?;
        one_pass_ns = one_pass_ns.min(measure::one_pass_ns(&trial));
        rows.extend(METHODS.map(|assess| assess(&trial)));
    }
    Ok(BenchResult { schema: SCHEMA, host: host(), first_seed: 1, one_pass_ns, rows })
}

fn host() -> Host {
    // Linux says it; elsewhere it stays unknown.
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name"));
    let processor = name.map(|name| name.trim_start_matches([' ', '\t', ':']).to_owned());
    Host { processor, debug_build: cfg!(debug_assertions) }
}
