//! Text about the contents of a card.

use floe_firmware::settings::Settings;

use super::{Found, Test};
use crate::error::InputError;
use crate::rounding::{counted, plus_minus};

/// A line per test, then the state of the sectors.
#[must_use]
pub fn summary(tests: &[Test], found: &Found) -> String {
    let mut text = String::new();
    for test in tests {
        let settings = &test.settings;
        let seconds = test.samples.len() as f64 / f64::from(settings.config.rate_hz);
        let (samples, missing) = (test.samples.len(), test.missing());
        let bad = test.samples.iter().filter(|s| s.reading.is_err()).count();
        text += &format!(
            "{}: {samples} samples ({seconds:.1} s), {missing} missing ({} overruns), {bad} bad, \
             weight {} N\n",
            test.stem,
            test.overruns,
            weight(settings),
        );
    }
    let (whole, damaged, lost) = (found.places.len(), found.damaged, found.lost);
    text += &format!("sectors: {whole} read, {damaged} damaged, {lost} lost");
    for (count, what) in [
        (found.newer, "of a newer version"),
        (found.unsound, "that no logger writes"),
        (found.repeated, "there again"),
    ] {
        if count > 0 {
            text += &format!(", {count} {what}");
        }
    }
    if found.is_cut_off {
        text += ", the last cut off";
    }
    text + "\n" + &conflicts(tests)
}

/// Descriptions of the unused sectors.
pub(super) fn unused(found: &Found) -> Vec<String> {
    let sectors = |count: u64, kind: &str| Some(counted(count, kind)).filter(|_| count > 0);
    let of = |count: u64, what: &str| sectors(count, "sector").map(|it| format!("{it} {what}"));
    let cut_off = found.is_cut_off.then(|| "a last sector that is cut off".to_string());
    [
        sectors(found.damaged, "damaged sector"),
        of(found.unsound, "that no logger writes"),
        of(found.newer, "of a newer version"),
        cut_off,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Error for an input without a record.
pub(super) fn no_record(found: &Found) -> InputError {
    let unused = match unused(found).join(", ") {
        unused if unused.is_empty() => unused,
        unused => format!(" ({unused})"),
    };
    InputError::new(format!(
        "holds no record of a floe logger{unused}: name the card's FLOE.LOG, or an image of the whole \
         card; a log as text goes to floe replay"
    ))
}

/// Descriptions of tests that contradict each other.
fn conflicts(tests: &[Test]) -> String {
    let mut text = String::new();
    for test in tests {
        if let Some(why) = test.split {
            text += &format!("{}: taken apart from its number's other samples: {why}\n", test.stem);
        }
    }
    for same in tests.chunk_by(|a, b| a.part.run == b.part.run) {
        let mut identities: Vec<_> = same.iter().map(|test| test.part.id).collect();
        identities.dedup();
        if let (Some(first), true) = (same.first(), identities.len() > 1) {
            let (run, count) = (first.part.run, identities.len());
            text += &format!("number {run} is on the card for {count} different tests\n");
        }
    }
    text
}

/// Weight of a test with its uncertainty.
#[must_use]
pub fn weight(settings: &Settings) -> String {
    let weight_n = settings.config.weight_n;
    match settings.stds.weight_n {
        Some(std_n) => plus_minus(weight_n.into(), std_n.into()),
        None => weight_n.to_string(),
    }
}
