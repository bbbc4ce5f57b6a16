//! Results of a campaign as a whole.

use std::fmt::Write;

use serde::Serialize;

use super::programme::PUBLISHED;
use super::trend::{Against, Coefficient, Group, Mean, Trend, mean, points, trend};
use super::{TestRecord, simulated};
use crate::replay::result::CoefficientSummary;
use crate::rounding::{decimals, own_digits, plus_minus};

/// Name and version of the format; changes if a meaning changes.
pub const SCHEMA: &str = "floe-campaign/1";

/// Largest number of tests that are listed individually.
const MOST_LISTED: usize = 200;

/// Results of one or more campaigns.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Whether a test was simulated.
    pub synthetic: bool,
    /// Number of simulated tests.
    pub synthetic_tests: usize,
    /// Seed of a simulated programme.
    pub seed: Option<u64>,
    /// Number of tests.
    pub tests: usize,
    /// Number of events.
    pub events: u64,
    /// Means of the groups.
    pub groups: Vec<GroupMeans>,
    /// Fitted straight lines.
    pub trends: Vec<NamedTrend>,
    /// Logs that were left out, with the reason.
    pub left_out: Vec<String>,
    /// The individual tests, if there are not too many.
    pub records: Vec<TestRecord>,
}

/// Means of one group.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct GroupMeans {
    /// Which tests.
    pub group: Group,
    /// Static coefficient.
    pub mu_s: Option<Mean>,
    /// Dynamic coefficient.
    pub mu: Option<Mean>,
    /// Uncertainty that the tests may have in common, as with one instrument: mean of their
    /// systematic standard deviations of `mu_s`. It does not average out over tests.
    pub mu_s_systematic_std: Option<f64>,
    /// Mean of the systematic standard deviations of `mu`.
    pub mu_systematic_std: Option<f64>,
    /// Published mean of `mu_s`; `null` for groups by the kind of pull.
    pub published_mu_s: Option<f64>,
    /// Published mean of `mu`.
    pub published_mu: Option<f64>,
}

impl GroupMeans {
    /// Number of tests with a value.
    #[must_use]
    pub fn tests(&self) -> usize {
        self.mu_s.or(self.mu).map_or(0, |mean| mean.tests)
    }
}

/// A straight line with its coefficient, variable and group.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct NamedTrend {
    /// Which coefficient.
    pub coefficient: Coefficient,
    /// The independent variable.
    pub against: Against,
    /// The group of tests.
    pub group: Group,
    /// The line.
    pub trend: Trend,
}

impl Summary {
    /// Computes the summary of tests.
    #[must_use]
    pub fn new(tests: &[TestRecord], events: u64, seed: Option<u64>) -> Self {
        let of = |group: Group, value: fn(&TestRecord) -> Option<f64>| {
            let tests = tests.iter().filter(|test| group.holds(test));
            mean(&tests.filter_map(value).collect::<Vec<_>>())
        };
        let means = |group, published: Option<(f64, f64)>| GroupMeans {
            group,
            mu_s: of(group, |test| test.mu_s.mean),
            mu: of(group, |test| test.mu.mean),
            mu_s_systematic_std: of(group, |test| test.mu_s.systematic_std).map(|std| std.mean),
            mu_systematic_std: of(group, |test| test.mu.systematic_std).map(|std| std.mean),
            published_mu_s: published.map(|published| published.0),
            published_mu: published.map(|published| published.1),
        };
        let published = Group::ALL.into_iter().zip(PUBLISHED.map(Some));
        let kinds = Group::KINDS.into_iter().map(|kind| (kind, None));
        let some = |group: &Group| tests.iter().any(|test| group.holds(test));
        let groups = published.chain(kinds.filter(|(kind, _)| some(kind)));
        let groups = groups.map(|(group, published)| means(group, published));
        let listed = if tests.len() <= MOST_LISTED { tests } else { &[] };
        let synthetic_tests = tests.iter().filter(|test| test.synthetic.is_some()).count();
        Self {
            schema: SCHEMA,
            synthetic: synthetic_tests > 0,
            synthetic_tests,
            seed,
            tests: tests.len(),
            events,
            groups: groups.collect(),
            trends: trends(tests),
            left_out: Vec::new(),
            records: listed.to_vec(),
        }
    }

    /// Warning if a test was simulated.
    #[must_use]
    pub fn simulated(&self) -> Option<String> {
        simulated(self.synthetic_tests, self.tests)
    }

    /// The campaign as text.
    #[must_use]
    pub fn text(&self) -> String {
        let said = self.simulated().map(|said| format!("SIMULATED: {said}\n\n"));
        let mut text = said.unwrap_or_default() + &self.list();
        text += "\ngroup      tests  mu_s               systematic  mu                 systematic  \
                 published mu_s, mu\n";
        for group in &self.groups {
            let _ = writeln!(
                text,
                "{:<11}{:>5}  {:<17}  {:<10}  {:<17}  {:<10}  {}  {}",
                group.group.name(),
                group.tests(),
                of_group(group.mu_s),
                systematic(group.mu_s_systematic_std),
                of_group(group.mu),
                systematic(group.mu_systematic_std),
                published(group.published_mu_s),
                published(group.published_mu),
            );
        }
        if !self.trends.is_empty() {
            let _ = writeln!(text, "\n{:<39}slope", "trend");
        }
        for t in &self.trends {
            let (name, unit) = t.against.name();
            let what = format!("{} against {name}, {}", t.coefficient.name(), t.group.name());
            let slope = plus_minus(t.trend.slope, t.trend.slope_std_error);
            let _ = writeln!(text, "{what:<38} {slope:<18} per {unit}, {} tests", t.trend.tests);
        }
        text + "\n± of a test: one standard deviation, all that is known of it; of groups and slopes: \
                standard error from the scatter between tests alone; systematic: the mean of the tests' \
                systematic parts,\nwhich tests with one instrument may have in common and no number of \
                them averages out\n"
    }

    fn list(&self) -> String {
        if self.records.is_empty() {
            return format!("{} tests, too many to list: --parquet has their events\n", self.tests);
        }
        const LONGEST: usize = 48;
        let longest = self.records.iter().map(|test| test.test_id.chars().count()).max();
        let wide = longest.unwrap_or(0).clamp(18, LONGEST);
        let mut text = format!(
            "{:<wide$}   weight   pull   snow  events  mu_s               mu\n{:<wide$}        N   \
             mm/s     mm\n",
            "test", ""
        );
        let known = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1}"));
        for test in &self.records {
            let _ = writeln!(
                text,
                "{:<wide$}  {:>7.*}  {:>5}  {:>5}  {:>6}  {:<17}  {}",
                test.test_id,
                decimals(test.weight_n),
                test.weight_n,
                known(test.winch_m_per_s.map(|w| w * 1e3)),
                known(test.snow_mm),
                test.event_count,
                of_test(&test.mu_s),
                of_test(&test.mu),
            );
        }
        text
    }
}

/// A published mean with its published digits.
#[must_use]
pub fn published(mean: Option<f64>) -> String {
    mean.map_or("-".to_owned(), |mean| format!("{mean:?}"))
}

/// Text of an uncertainty common to the tests.
#[must_use]
pub fn systematic(std: Option<f64>) -> String {
    std.map_or("-".to_owned(), own_digits)
}

/// Text of a test's coefficient with its combined uncertainty.
#[must_use]
pub fn of_test(value: &CoefficientSummary) -> String {
    match (value.mean, value.combined_std) {
        (Some(mean), Some(std)) => plus_minus(mean, std),
        (Some(mean), None) => format!("{mean:.4} ± ?"),
        (None, _) => "-".to_owned(),
    }
}

/// Text of a mean over tests with its standard error, or without if the tests do not scatter.
#[must_use]
pub fn of_group(mean: Option<Mean>) -> String {
    match mean {
        None => "-".to_owned(),
        Some(Mean { mean, std_error: None, .. }) => format!("{mean:.4}"),
        Some(Mean { mean, std_error: Some(error), .. }) => plus_minus(mean, error),
    }
}

/// All lines that can be fitted: against weight and pull rate for each group, against snow for all
/// tests.
fn trends(tests: &[TestRecord]) -> Vec<NamedTrend> {
    let mut trends = Vec::new();
    for coefficient in Coefficient::ALL {
        for against in Against::ALL {
            for group in Group::ALL {
                let points = points(tests, group, against, coefficient);
                let line =
                    trend(&points).map(|trend| NamedTrend { coefficient, against, group, trend });
                trends.extend(line);
            }
        }
    }
    trends
}
