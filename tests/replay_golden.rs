//! Replays of the bundled logs and of seeded scenes compared with stored summaries.
//!
//! A summary is readable text: counts, means, errors, quantiles. Counts must be equal. Other
//! numbers agree within a twentieth of their uncertainty, or 0.1 % if they have none, since
//! libraries on other machines may round differently.
//!
//! `FLOE_GOLDEN=write cargo test -p floe-tests --test replay_golden` rewrites the summaries; the
//! commit must state the reason.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use floe::log::{Log, LogOptions};
use floe::replay::replay;
use floe::replay::result::{EventSummary, ReplayResult};
use floe::replay::test::{TestOptions, configure};
use floe::sim::measurement::{Chance, Flop};
use floe::sim::{Scene, simulate};
use floe_tests::brute::Pull;
use floe_tests::scenes;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Text of a summary: names, numbers and their tolerances.
#[derive(Default)]
struct Summary(String);

impl Summary {
    fn exact(&mut self, name: &str, value: impl std::fmt::Display) {
        writeln!(self.0, "{name} = {value}").unwrap();
    }

    /// Adds numbers with a tolerance of a twentieth of their uncertainty; 0.1 % if it is zero.
    fn about(&mut self, name: &str, values: &[Option<f64>], uncertainty: f64) {
        let largest = values.iter().flatten().fold(0.0_f64, |max, v| max.max(v.abs()));
        let tolerance = if uncertainty > 0.0 { uncertainty / 20.0 } else { 1e-3 * largest };
        write!(self.0, "{name} ~").unwrap();
        for value in values {
            match value {
                Some(value) => write!(self.0, " {}", rounded(*value)).unwrap(),
                None => write!(self.0, " none").unwrap(),
            }
        }
        writeln!(self.0, " (to {tolerance:.1e})").unwrap();
    }
}

/// Rounds to six digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap()
}

/// Adds minimum, quartiles and maximum.
fn quantiles(
    events: &[EventSummary],
    of: impl Fn(&EventSummary) -> Option<f64>,
) -> Vec<Option<f64>> {
    let mut values: Vec<f64> = events.iter().filter_map(of).collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    [0, 1, 2, 3, 4].map(|quarter| values.get(quarter * last / 4).copied()).into()
}

fn summary(result: &ReplayResult) -> String {
    let mut s = Summary::default();
    let (log, estimate, events) = (&result.log, &result.estimate, &*result.events);
    s.exact("format", &log.format);
    s.exact("rate_hz", log.rate_hz);
    s.exact("samples", log.samples);
    let counts = [log.missing, log.duplicates, log.rejected, log.saturated];
    s.exact("missing, duplicates, rejected, saturated", format!("{counts:?}"));
    s.exact("warnings", log.warnings.len());
    s.exact("events", events.len());
    s.exact("events with coefficients", estimate.events);
    for quality in ["good", "unresolved", "slack", "clipped"] {
        s.exact(quality, events.iter().filter(|e| e.quality == quality).count());
    }
    for (name, e, of, std) in [
        (
            "mu_s",
            estimate.mu_s,
            (|e| e.mu_s) as fn(&EventSummary) -> _,
            (|e| e.mu_s_std) as fn(&EventSummary) -> _,
        ),
        ("mu", estimate.mu, |e| e.mu, |e| e.mu_std),
    ] {
        let error = e.std_error.unwrap_or(0.0);
        s.about(
            &format!("{name} mean, std_error, spread"),
            &[e.mean, e.std_error, e.spread],
            error,
        );
        let stds = quantiles(events, std);
        let typical = stds[2].unwrap_or(0.0);
        s.about(&format!("{name} quantiles"), &quantiles(events, of), typical);
        s.about(&format!("{name} std quantiles"), &stds, typical);
    }
    s.about("noise_n", &[result.noise_n], 0.0);
    let q = &result.quantities;
    let (rate, omega) = (q.loading_rate_n_per_s, q.omega_rad_per_s);
    s.about("loading rate, omega, stiffness", &[rate, omega, q.stiffness_n_per_m], 0.0);
    s.about("recurrence_s", &[q.recurrence_s], 0.0);
    s.about("stick_s quantiles", &quantiles(events, |e| e.stick_s), 0.02);
    s.about("slip_s quantiles", &quantiles(events, |e| Some(e.slip_s)), 0.02);
    s.about("peak force quantiles", &quantiles(events, |e| Some(e.peak_force_n)), 0.0);
    s.about(
        "first and last onset_s",
        &[events.first().map(|e| e.onset_s), events.last().map(|e| e.onset_s)],
        0.02,
    );
    s.0
}

/// Whether two lines have the same words, and numbers within the line's tolerance.
fn agrees(line: &str, stored: &str) -> bool {
    if line == stored {
        return true;
    }
    let parts = |line: &str| {
        let (name, rest) = line.split_once(" ~ ")?;
        let (values, tolerance) = rest.split_once(" (to ")?;
        let tolerance: f64 = tolerance.trim_end_matches(')').parse().ok()?;
        let values: Vec<Option<f64>> = values.split(' ').map(|v| v.parse().ok()).collect();
        Some((name.to_owned(), values, tolerance))
    };
    let (Some(got), Some(stored)) = (parts(line), parts(stored)) else { return false };
    let near = |(a, b): (&Option<f64>, &Option<f64>)| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= stored.2,
        (a, b) => a == b,
    };
    got.0 == stored.0 && got.1.len() == stored.1.len() && got.1.iter().zip(&stored.1).all(near)
}

fn compare(name: &str, result: &ReplayResult) {
    let path = root().join("tests/golden").join(format!("{name}.snap"));
    let got = summary(result);
    if std::env::var("FLOE_GOLDEN").is_ok_and(|value| value == "write") {
        std::fs::write(&path, got).unwrap();
        return;
    }
    let stored = std::fs::read_to_string(&path).unwrap_or_default();
    let different: Vec<String> = got
        .lines()
        .zip(stored.lines().chain(std::iter::repeat("(nothing)")))
        .filter(|(got, stored)| !agrees(got, stored))
        .map(|(got, stored)| format!("  got    {got}\n  stored {stored}"))
        .collect();
    assert!(different.is_empty(), "{name}.snap differs:\n{}", different.join("\n"));
    assert_eq!(got.lines().count(), stored.lines().count(), "{name}.snap has more lines");
}

fn replayed(text: Vec<u8>, options: &TestOptions) -> ReplayResult {
    let input = Box::new(std::io::Cursor::new(text));
    let mut log = Log::from_reader(input, &LogOptions::default()).unwrap();
    let config = configure(&log, options).unwrap();
    replay("log", &mut log, &config, |_, _| {}).unwrap()
}

fn bundled(file: &str, options: &TestOptions) {
    let text = std::fs::read(root().join("host-sim/logs").join(file)).unwrap();
    compare(&file.replace('.', "-"), &replayed(text, options));
}

/// Replays a scene through a CSV file, with indices from its time column.
fn simulated(name: &str, scene: &Scene) {
    let mut text = format!("# weight_n: {}\n# slope_deg: {}\n", scene.weight_n, scene.slope_deg);
    writeln!(text, "# rate_hz: {}\ntime_s,force_n", scene.rate_hz).unwrap();
    for sample in simulate(scene, 1).unwrap().samples {
        writeln!(text, "{},{:.3}", sample.time_s, sample.force_n).unwrap();
    }
    compare(name, &replayed(text.into_bytes(), &TestOptions::default()));
}

fn minutes(pull: Pull, minutes: f64) -> Scene {
    scenes::scene(&Pull { duration_s: 60.0 * minutes, ..pull })
}

#[test]
fn bundled_csv() {
    bundled("dff8-13.csv", &TestOptions::default());
}

#[test]
fn bundled_cr10() {
    bundled("dff8-13.dat", &TestOptions { weight_n: Some(630.0), ..TestOptions::default() });
}

#[test]
fn heavy_block() {
    simulated("heavy", &minutes(scenes::heavy(), 10.0));
}

#[test]
fn light_block() {
    simulated("light", &minutes(scenes::light(), 2.0));
}

#[test]
fn fast_uphill() {
    let uphill = Pull { slope_rad: 6.0_f64.to_radians(), ..scenes::fast() };
    simulated("fast-uphill", &minutes(uphill, 2.0));
}

/// A cable that drops on the ice after each slip, and a logger that loses, repeats and misreads
/// samples.
#[test]
fn troubled() {
    let mut scene = minutes(scenes::snow(), 5.0);
    let m = &mut scene.measurement;
    m.flop = Some(Flop { amplitude_n: 25.0, hz: 3.0, decay_per_s: 4.0 });
    m.range_n = 5000.0;
    m.step_n = 0.1;
    m.dropped = Some(Chance { probability: 0.01 });
    m.repeated = Some(Chance { probability: 0.005 });
    m.spikes = Some(Chance { probability: 0.005 });
    simulated("troubled", &scene);
}

/// Tests the comparison: equal counts, numbers within the tolerance, no other difference.
#[test]
fn summaries_are_compared_as_said() {
    for (got, stored, same) in [
        ("events = 5", "events = 5", true),
        ("events = 5", "events = 6", false),
        ("mu ~ 0.78 0.001 (to 5e-5)", "mu ~ 0.78004 0.001 (to 5e-5)", true),
        ("mu ~ 0.78 0.001 (to 5e-5)", "mu ~ 0.78006 0.001 (to 5e-5)", false),
        ("mu ~ 0.78 none (to 0.00005)", "mu ~ 0.78 0.001 (to 0.00005)", false),
        ("mu ~ 0.78 (to 0.1)", "mu ~ 0.78 0.001 (to 0.1)", false),
        ("mu_s ~ 0.78 (to 0.1)", "mu ~ 0.78 (to 0.1)", false),
        ("mu ~ 0.78 (to 0.1)", "(nothing)", false),
    ] {
        assert_eq!(agrees(got, stored), same, "{got} | {stored}");
    }
}
