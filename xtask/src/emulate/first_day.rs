//! A first day on the ice, typed on the console of the image that is flashed: checks the console,
//! the card, and the evaluation of the card on a PC.

use std::fs;

use floe::campaign::recorded;
use floe::card::{self as files, Test};
use floe_board_model::run::{Incident, Setup, When};
use floe_firmware::line::Line;
use floe_tests::day::{DAY, LOOKED, NOISE, SPAN, codes, day};
use floe_tests::shown;

use super::card::Image;
use super::nucleo::{Nucleo, Played, card};
use super::outcome;
use super::record::RATE_HZ;
use crate::Result;
use crate::shell::target;

/// Weight of the block on the tripod, N.
const WEIGHT_N: f32 = 630.0;
/// Samples in the pull of 60 s.
const PULLED: usize = 960;
/// Largest mean number of samples per picture: one is due every eight, and some are delayed to a
/// period with more time.
const PICTURE_SAMPLES: u64 = 12;

/// Clock, self-test, tare, weigh, notes, a pull of 60 s, the zero again; then the card is read.
///
/// # Errors
/// The first deviation.
pub fn check_first_day(nucleo: &Nucleo) -> Result<()> {
    let image = Image::large("day")?;
    let typed = DAY.map(|(tick, line)| (When::Sample(tick), Incident::Type(line.into())));
    let last = DAY.iter().map(|&(tick, _)| tick).max().unwrap_or(0);
    let end = (When::Sample(last + 16), Incident::End);
    let looked = (When::Sample(LOOKED), Incident::Photograph);
    let script = typed.into_iter().chain([looked, end]).collect();
    let card = Some(card(image.path())?);
    let codes = codes(day(), SPAN);
    let setup = Setup { codes, rate_hz: RATE_HZ, noise: NOISE, script, card, ..Setup::quiet() };
    let played = nucleo.play(&setup)?;
    played.check()?;
    for words in ["self test passed", "N,wind from the side", "Z,1"] {
        played.said_at(words).ok_or_else(|| format!("first day: never said '{words}'"))?;
    }
    let tests = image.tests()?;
    let pull = tests.iter().find(|test| test.samples.len() > PULLED / 2);
    let pull = pull.ok_or("first day: the pull is not on the card")?;
    let said = check_pull(pull, &played.shown)?;
    // Required also while the log's file is being extended.
    let pictures = played.outcome.pictures;
    if u64::from(pictures) < last / PICTURE_SAMPLES {
        return Err(format!("first day: {pictures} pictures in {last} samples"));
    }
    let [mu_s, mu] = check_shown(&played)?;
    println!("board: first day: {said}; {pictures} pictures, display and floe live: {mu_s}, {mu}");
    Ok(())
}

/// Checks that before the end of the pull display and `floe live` agree with the console.
fn check_shown(played: &Played) -> Result<[String; 2]> {
    let photograph = played.outcome.photographs.first().ok_or("first day: no photograph")?;
    // Lines between the answer to `status` and the event that `stop` completes.
    let from = played.shown.find("\nR,").ok_or("first day: nobody said a result")?;
    let end = played.shown[from + 1..].find("\nE,").ok_or("first day: no event at the end")?;
    let before = &played.shown[..from + 1 + end];
    shown::agree(before, photograph).map_err(|e| format!("first day: {e}"))
}

/// Checks the weight, that the card's samples give the reported events bit for bit, and that
/// `campaign` reads the log that `recover` writes from them.
fn check_pull(pull: &Test, shown: &str) -> Result<String> {
    let (weight_n, std_n) = (pull.settings.config.weight_n, pull.settings.stds.weight_n);
    let std_n = std_n.ok_or("first day: a weight without a standard deviation")?;
    if (weight_n - WEIGHT_N).abs() > 4.0 * std_n || std_n > 0.2 {
        return Err(format!("first day: the block weighs {weight_n} +- {std_n} N"));
    }
    let raw = pull.samples.iter().map(|sample| sample.raw(pull.part.first_index));
    let (events, _) = outcome::host(&pull.settings.core_config(), raw)?;
    let lines = events.into_iter().filter_map(|event| Line::Event(event).to_text().ok());
    let here: Vec<String> = lines.map(|line| line.to_string()).collect();
    let said = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.starts_with("E,")).map(String::from).collect()
    };
    if here.len() < 25 || here != said(shown) || here != said(&pull.lines) {
        let (there, kept) = (said(shown).len(), said(&pull.lines).len());
        return Err(format!("first day: {} events, {there} said, {kept} kept", here.len()));
    }
    let folder = target().join("first-day");
    fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let file = folder.join(format!("{}.csv", pull.stem));
    fs::write(&file, files::csv(pull)).map_err(|e| format!("{}: {e}", file.display()))?;
    let logs = recorded::logs(&folder).map_err(|e| e.to_string())?;
    let log = logs.entries.first().ok_or("first day: the campaign has no log")?;
    let record = recorded::evaluate(log, 0).map_err(|e| e.to_string())?;
    let mu_s = record.mu_s.mean.ok_or("first day: the campaign has no mu_s")?;
    let dated = record.start_time.is_some_and(|time| time.starts_with("2027-03-02T10:16:"));
    if record.test_id != "first pull" || !dated || pull.settings.zero.after_n.is_none() {
        return Err(format!("first day: the campaign reads {}", record.test_id));
    }
    Ok(format!(
        "{} events said, kept and computed on this PC bit for bit; {weight_n:.2} +- {std_n:.2} N; \
         campaign: {mu_s:.4}",
        here.len()
    ))
}
