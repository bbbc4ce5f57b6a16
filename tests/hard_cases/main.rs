//! The hard cases: every scene in `host-sim/scenes/hard` and the linear scenes, with limits on
//! detection, bias, 95th percentile and coverage.
//!
//! `cargo test -p floe-tests --test hard_cases -- --nocapture` prints the table; `FLOE_TABLE=write`
//! writes it to `docs/hard-cases.md`, `FLOE_CSV=FILE` writes it as CSV to a file.

use std::fs;
use std::path::{Path, PathBuf};

use floe::sim::Scene;
use floe_tests::aims::{self, Check};
use floe_tests::scenes;
use floe_tests::score::{Errors, Score, run};

mod limits;

use limits::limits;

/// Smallest number of events per scene, unless `RECORDS` records have fewer.
const EVENTS: usize = 1500;
const RECORDS: u64 = 200;

/// A scene and its score.
struct Row {
    name: String,
    /// The first line of the scene's file.
    about: String,
    score: Score,
}

fn scene_files() -> Vec<PathBuf> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut files = vec![scenes.join("dff8-13.toml")];
    for folder in ["linear", "hard"] {
        let mut own: Vec<_> =
            fs::read_dir(scenes.join(folder)).unwrap().map(|file| file.unwrap().path()).collect();
        own.sort();
        files.extend(own.into_iter().filter(|f| f.extension().is_some_and(|e| e == "toml")));
    }
    files
}

fn row(file: &Path) -> Row {
    let text = fs::read_to_string(file).unwrap();
    let scene = Scene::from_toml(&text).unwrap();
    Row {
        name: file.file_stem().unwrap().to_str().unwrap().to_owned(),
        about: text.lines().next().unwrap().trim_matches(['#', ' ', ':']).to_owned(),
        score: Score::of(&scene, EVENTS, RECORDS),
    }
}

impl Row {
    fn text(&self) -> String {
        let Self { name, about, score } = self;
        let cells = |e: &Errors| {
            if e.count() == 0 {
                return "- | - | - | -".to_owned();
            }
            let bound = e.over_bound().map_or("-".to_owned(), |x| format!("{x:.2}"));
            format!("{:+.3} | {:.3} | {:.3} | {bound}", e.bias(), e.p95(), e.coverage())
        };
        let [mu_s, mu] = score.errors.each_ref().map(cells);
        let (events, f1) = (score.events(), score.detection.f1());
        let why = limits(name).why;
        let read = if events > 0 { format!("{:.3}", score.share_read()) } else { "-".to_owned() };
        format!("| {name} | {about} | {events} | {f1:.3} | {read} | {mu_s} | {mu} | {why} |")
    }

    /// The row as CSV, one line per coefficient.
    fn csv(&self) -> String {
        let Self { name, score, .. } = self;
        let line = |i: usize| {
            let (all, settled) = (&score.errors[i], &score.settled[i]);
            let bound = |e: &Errors| e.over_bound().map_or(String::new(), |x| format!("{x:.4}"));
            format!(
                "{name},{},{},{:.4},{},{:.4},{:.4},{:.4},{:.4},{:.4},{},{},{:.4},{:.5}\n",
                COEFFICIENTS[i],
                score.events(),
                score.detection.f1(),
                score.detection.false_alarms,
                score.share_read(),
                all.bias(),
                all.rms(),
                all.p95(),
                all.coverage(),
                bound(all),
                bound(settled),
                settled.coverage(),
                settled.median_std(),
            )
        };
        line(0) + &line(1)
    }

    /// The figures with their aims.
    fn checks(&self) -> Vec<Check> {
        let limits = limits(&self.name);
        let Score { detection, errors, .. } = &self.score;
        let name = self.name.as_str();
        let mut checks = vec![Check::least(name, "F1", detection.f1(), limits.f1)];
        if ["smooth", "flop"].contains(&name) {
            let invented = detection.false_alarms as f64;
            checks.push(Check::most(name, "number of invented events", invented, 0.0));
        }
        if self.score.events() > 0 {
            let read = self.score.share_read();
            checks.push(Check::least(name, "share with coefficients", read, 0.95));
        }
        for (i, e) in errors.iter().enumerate().filter(|(_, e)| e.count() > 0) {
            let of = |what: &str| format!("{what} of {}", COEFFICIENTS[i]);
            let n = e.count() as f64;
            let coverage = aims::share_limits(limits.coverage[i], e.count());
            checks.extend([
                Check::most(name, &of("bias"), e.bias().abs(), limits.bias[i]),
                Check::most(name, &of("95th percentile"), e.p95(), limits.p95[i]),
                Check::between(name, &of("coverage"), e.coverage(), coverage),
            ]);
            if let Some((ratio, most)) = e.over_bound().zip(limits.over_bound.map(|b| b[i])) {
                // Three standard errors of a root mean square.
                let most = most * (1.0 + 3.0 / (2.0 * n).sqrt());
                checks.push(Check::most(name, &of("error over the bound"), ratio, most));
            }
        }
        checks.extend(self.sharpness());
        checks
    }

    /// Checks that on a linear scene the intervals are no wider than the reference.
    fn sharpness(&self) -> Vec<Check> {
        if limits(&self.name).over_bound.is_none() {
            return Vec::new();
        }
        let check = |i: usize| {
            let before = reference_std(&self.name, COEFFICIENTS[i]);
            let ratio = self.score.settled[i].median_std() / before;
            let what = format!("median std of {} over the reference's", COEFFICIENTS[i]);
            Check::most(&self.name, &what, ratio, 1.03)
        };
        vec![check(0), check(1)]
    }
}

const COEFFICIENTS: [&str; 2] = ["mu_s", "mu"];

/// Reference for the median standard deviation from event 3 on, percent, from commit 7d0c2b2.
fn reference_std(scene: &str, coefficient: &str) -> f64 {
    let row = format!("{scene},{coefficient},");
    let line = REFERENCE.lines().find(|line| line.starts_with(&row)).expect("a row");
    line.rsplit(',').next().unwrap().parse().unwrap()
}
const REFERENCE: &str = include_str!("../golden/hard-cases-7d0c2b2.csv");

const HEAD: &str = "\
# The hard cases

Every scene of `host-sim/scenes/hard`, and the linear ones: what the core makes of it. Seeds 1, 2, ...
up to 1500 events or 200 records, each with another sampling phase. Every event counts, the first ones too; only
the last one of a record, whose line its end cuts, does not. This page is written by
`FLOE_TABLE=write cargo test -p floe-tests --test hard_cases`; the same test holds every row to its limits
and says so when the page is no longer true.

The aim of a row: F1 of detection at least 0.99, bias under 0.5 %, 95 % of the errors under 1.5 %, the 95 %
interval true in 90 to 99 % of the events (linear scenes: 93 to 97 %, and root-mean-square error within 0.8
of the bound for mu_s and 1.0 for mu), and no event invented. Coverage and error over the bound may miss by three
standard errors of so many events (1500: 0.84 and 1.05). The last column says why a case is held to something else;
the limits are in `tests/hard_cases/limits.rs`, the figures that miss theirs below the table and, with how far they
may, in `tests/golden/hard-cases-not-yet.csv`. What commit 7d0c2b2 reached is kept in
`tests/golden/hard-cases-7d0c2b2.csv`: on linear scenes the median standard deviation from event 3 on may exceed that
by 3 %. *bound*: root-mean-square error over the Cramér-Rao bound of the event by itself, for the white noise alone;
`-`: the model does not hold. *read*: share of the true events that got both coefficients. Errors in percent of the
true coefficient.

| scene | what it is | events | F1 | read | mu_s: bias % | 95 % | coverage | bound | mu: bias % | 95 % | coverage | bound | held to less because |
|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|
";

const CSV_HEAD: &str = "\
scene,coefficient,events,f1,invented,read_share,bias_percent,rms_percent,p95_percent,coverage,\
rms_over_bound,settled_rms_over_bound,settled_coverage,settled_median_std_percent\n";

fn page_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hard-cases.md")
}

/// Columns with numbers, and their largest accepted difference: a change of the core moves them a
/// little, and this is more than chance does. All other columns must be equal.
const ROW: [(usize, f64); 11] = [
    (3, 10.0),
    (4, 0.005),
    (5, 0.01),
    (6, 0.1),
    (7, 0.15),
    (8, 0.02),
    (9, 0.1),
    (10, 0.1),
    (11, 0.15),
    (12, 0.02),
    (13, 0.1),
];
/// Columns with numbers in the list of missed aims, and their largest accepted difference.
const MISSED: [(usize, f64); 2] = [(3, 0.15), (4, 0.15)];

/// Whether a row of the page agrees with the current row.
fn agree(page: &str, now: &str, figures: &[(usize, f64)]) -> bool {
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let (page, now) = (cells(page), cells(now));
    let same = |(column, (a, b)): (usize, (&String, &String))| {
        let most = figures.iter().find(|(figure, _)| *figure == column).map(|(_, most)| *most);
        match (most, a.parse::<f64>(), b.parse::<f64>()) {
            (Some(most), Ok(a), Ok(b)) => (a - b).abs() <= most,
            _ => a == b,
        }
    };
    page.len() == now.len() && page.iter().zip(&now).enumerate().all(same)
}

#[test]
fn every_case_keeps_its_limits() {
    let rows: Vec<Row> = scene_files().iter().map(|file| row(file)).collect();
    let table: Vec<String> = rows.iter().map(Row::text).collect();
    println!("{}", table.join("\n"));
    let checks: Vec<Check> = rows.iter().flat_map(Row::checks).collect();
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/hard-cases-not-yet.csv");
    if std::env::var("FLOE_TABLE").is_ok_and(|what| what == "write") {
        aims::shrink(&list, &checks);
        let missed = aims::section(&checks, aims::reason(&aims::not_yet(&list)));
        fs::write(page_file(), format!("{HEAD}{}\n{missed}", table.join("\n"))).unwrap();
    }
    if let Ok(file) = std::env::var("FLOE_CSV") {
        fs::write(file, rows.iter().fold(CSV_HEAD.to_owned(), |csv, row| csv + &row.csv()))
            .unwrap();
    }
    let list = aims::not_yet(&list);
    let faults = aims::faults(&checks, &list);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert_page(&table, &aims::section(&checks, aims::reason(&list)));
}

fn assert_page(table: &[String], missed: &str) {
    let page = fs::read_to_string(page_file()).unwrap();
    let (told, told_missed) = page.split_at(page.find("\n## ").expect("a section"));
    assert!(told.starts_with(HEAD), "docs/hard-cases.md: FLOE_TABLE=write");
    let told = told.lines().skip(HEAD.lines().count());
    let pairs = [
        (told.collect::<Vec<_>>(), table.iter().map(String::as_str).collect::<Vec<_>>(), &ROW[..]),
        (told_missed.lines().collect(), missed.lines().collect(), &MISSED[..]),
    ];
    for (told, now, figures) in pairs {
        assert_eq!(told.len(), now.len(), "docs/hard-cases.md: FLOE_TABLE=write");
        for (told, now) in told.iter().zip(&now) {
            let agree = agree(told, now, figures);
            assert!(agree, "docs/hard-cases.md (FLOE_TABLE=write) says\n{told}\nnow\n{now}");
        }
    }
}

/// The first samples must not decide about a whole record.
#[test]
fn no_record_loses_its_events_at_the_start() {
    for file in scene_files() {
        let mut scene = Scene::from_toml(&fs::read_to_string(&file).unwrap()).unwrap();
        scene.duration_s = 30.0;
        for seed in 1..=RECORDS / 2 {
            let detection = run(&scene, seed).detection;
            let lost = detection.misses > 1 && detection.misses > detection.hits;
            assert!(!lost, "{}, seed {seed}: {detection:?}", file.display());
        }
    }
}

#[test]
fn a_row_that_has_moved_is_seen() {
    let row =
        "| a | b | 1560 | 1.000 | 0.998 | +0.1 | 0.1 | 0.95 | 0.69 | +0.1 | 0.1 | 0.95 | - | |";
    let with = |column: usize, cell: &str| {
        let mut cells: Vec<&str> = row.split('|').collect();
        cells[column] = cell;
        agree(row, &cells.join("|"), &ROW)
    };
    assert!(with(6, "+0.19") && with(3, "1562") && with(9, "0.72"));
    let moved = [(1, "c"), (2, "c"), (3, "0"), (6, "+0.31"), (9, "-"), (9, "1.69"), (13, "1.0")];
    for (column, cell) in moved.into_iter().chain([(14, "why")]) {
        assert!(!with(column, cell), "{column}: {cell}");
    }
}

/// Flop of other magnitudes, frequencies and decays, on other blocks and at other rates, causes no
/// false slips and no bias, and the intervals still cover the truth.
#[test]
fn flop_of_any_kind_is_no_slip_and_no_bias() {
    let base = scenes::stored("hard/flop");
    // Amplitude, N; frequency, Hz; decay, 1/s; rate, Hz; weight, N.
    for kind in [
        [10.0, 3.3, 3.0, 16.0, 630.0],
        [30.0, 6.0, 3.0, 16.0, 630.0],
        [30.0, 3.3, 5.0, 16.0, 630.0],
        // Flop that lasts for the whole stick.
        [30.0, 3.3, 1.0, 16.0, 630.0],
        [30.0, 3.3, 3.0, 32.0, 630.0],
        [30.0, 3.3, 3.0, 64.0, 630.0],
        [30.0, 3.3, 3.0, 128.0, 630.0],
        [30.0, 3.3, 3.0, 16.0, 3000.0],
    ] {
        let [amplitude_n, hz, decay_per_s, rate_hz, weight_n] = kind;
        let mut scene = Scene { rate_hz, weight_n, ..base.clone() };
        let flop = scene.measurement.flop.as_mut().unwrap();
        (flop.amplitude_n, flop.hz, flop.decay_per_s) = (amplitude_n, hz, decay_per_s);
        let score = Score::of(&scene, 400, RECORDS);
        assert!((score.detection.f1() - 1.0).abs() < 1e-9, "{kind:?} {:?}", score.detection);
        for e in &score.errors {
            assert!(e.bias().abs() < 0.1, "{kind:?}: bias {}", e.bias());
            assert!(e.coverage() > 0.93, "{kind:?}: coverage {}", e.coverage());
        }
    }
}
