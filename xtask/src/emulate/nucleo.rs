//! The user's board in the emulator, running the image that is flashed.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use floe_board_model::run::{
    CONSOLE_FILE, CardSetup, Incident, LOGGED_FILE, OUTCOME_FILE, Outcome, SETUP_FILE, Setup, When,
};
use floe_firmware::line::Line;
use object::{Object, ObjectSymbol};

use super::card::Image;
use super::directory::Directory;
use super::machine::{Run, invite, tail};
use super::record::{NOISE, RATE_HZ, Record};
use crate::Result;
use crate::arm::Route;
use crate::qemu;
use crate::shell::{cargo, run, target};

/// Samples before the test, during which the commands are typed, one per sample.
const REST: usize = 32;
/// Samples in which the board must end the test.
const LAST: u64 = 16;

/// An emulator and an image, ready to run.
#[derive(Debug)]
pub struct Nucleo {
    qemu: &'static str,
    plugin: PathBuf,
    firmware: PathBuf,
    stack: (u32, u32),
    rtt: Option<u32>,
}

/// Console, log and outcome of a run.
#[derive(Debug)]
pub struct Played {
    /// Output of the console.
    pub shown: String,
    /// The firmware's log, not decoded.
    pub logged: Vec<u8>,
    /// Outcome recorded by the model.
    pub outcome: Outcome,
}

impl Played {
    /// Time of the first line that contains these words, s.
    #[must_use]
    pub fn said_at(&self, words: &str) -> Option<f64> {
        let mut lines = self.shown.lines().zip(&self.outcome.line_times_s);
        lines.find(|(line, _)| line.contains(words)).map(|(_, &time_s)| time_s)
    }

    /// Checks that there is no breach and that no typed character was lost.
    ///
    /// # Errors
    /// The breaches, or the number of lost characters.
    pub fn check(&self) -> Result<()> {
        let breaches = self.outcome.breaches.join("; ");
        match (breaches.is_empty(), self.outcome.typed_lost) {
            (false, _) => Err(format!("forbidden: {breaches}")),
            (_, 0) => Ok(()),
            (_, lost) => Err(format!("{lost} characters typed were lost")),
        }
    }
}

impl Nucleo {
    /// Builds image and model and finds the emulator.
    ///
    /// # Errors
    /// A build fails, or the emulator cannot be installed.
    pub fn prepare(forced: Option<Route>) -> Result<Self> {
        Self::with_features(forced, "nucleo-l476")
    }

    /// Builds the image with other features and the model, and finds the emulator.
    ///
    /// # Errors
    /// A build fails, or the emulator cannot be installed.
    pub fn with_features(forced: Option<Route>, features: &str) -> Result<Self> {
        let qemu = qemu::find()?;
        run(cargo().args(["build", "--quiet", "--package", "floe-board-model"]))?;
        let name = format!("{DLL_PREFIX}floe_board_model{DLL_SUFFIX}");
        let plugin = target().join("debug").join(name);
        let firmware = Route::find(forced)?.build_firmware("nucleo-l476", features)?;
        let (stack, rtt) = symbols(&firmware)?;
        Ok(Self { qemu, plugin, firmware, stack, rtt })
    }

    /// The image file.
    pub fn firmware(&self) -> &Path {
        &self.firmware
    }

    /// Runs a setup from power-up to its end.
    ///
    /// # Errors
    /// The emulator failed.
    pub fn play(&self, setup: &Setup) -> Result<Played> {
        let directory = Directory::new()?;
        let setup = Setup { stack: self.stack, rtt: self.rtt, ..setup.clone() };
        let text = serde_json::to_string(&setup).map_err(|e| e.to_string())?;
        directory.write(SETUP_FILE, &text)?;
        let mut command = qemu::nucleo(self.qemu, &self.plugin, &self.firmware, directory.place());
        let done = command.stdin(Stdio::null()).stdout(Stdio::null()).output();
        let done = done.map_err(|e| format!("cannot start {}: {e}", self.qemu))?;
        let said = String::from_utf8_lossy(&done.stderr).trim().replace('\n', "; ");
        if !done.status.success() {
            return Err(format!("{}: {}: {said}", self.qemu, done.status));
        }
        let read =
            |name| fs::read(directory.path(name)).map_err(|e| format!("{name}: {e}: {said}"));
        Ok(Played {
            outcome: serde_json::from_slice(&read(OUTCOME_FILE)?).map_err(|e| e.to_string())?,
            shown: String::from_utf8_lossy(&read(CONSOLE_FILE)?).into_owned(),
            logged: read(LOGGED_FILE)?,
        })
    }

    /// Largest use of the stack in a test with events, while the log's file is made on a new card.
    ///
    /// # Errors
    /// The emulator failed, or there was a breach.
    pub fn stack_used(&self) -> Result<u64> {
        let image = Image::large("stack")?;
        let setup = super::machine::Setup { card: Some(image.path()), ..Default::default() };
        Ok(self.run(&Record::stick_slip(), setup)?.stack)
    }

    /// Runs a record from power-up to the end of the test.
    ///
    /// # Errors
    /// The emulator failed, or there was a breach.
    pub fn run(&self, record: &Record, setup: super::machine::Setup<'_>) -> Result<Run> {
        let start = Instant::now();
        setup.port.map(invite).transpose()?;
        let played = self.play(&test_of(record, setup)?)?;
        let shown = played.shown;
        let words = || format!("; the board's last words: {}", tail(&shown));
        let check = Played { shown: String::new(), logged: Vec::new(), ..played };
        if setup.port.is_none() {
            check.check().map_err(|e| e + &words())?;
        }
        let first =
            first_index(&shown).ok_or_else(|| "no test was started".to_string() + &words())?;
        let delivered = check.outcome.delivered.iter();
        let delivered = delivered.filter_map(|&(n, code)| Some((n.checked_sub(first)?, code)));
        let rest = REST as u64;
        if !(rest..=rest + later(setup)).contains(&first) && setup.port.is_none() {
            return Err(format!("the test began at sample {first}, not {REST}{}", words()));
        }
        Ok(Run {
            delivered: delivered.collect(),
            logged: played.logged,
            stack: check.outcome.stack_used.into(),
            wall: start.elapsed(),
            shown,
        })
    }
}

/// Samples by which a command may be late. A command typed during the drawing of a picture is
/// executed with the next sample, and up to 120 ms later while the file of a new card is being
/// made.
fn later(setup: super::machine::Setup<'_>) -> u64 {
    if setup.card.is_some() { 2 } else { 1 }
}

/// Script of a test with a record: settings, start, stop.
fn test_of(record: &Record, setup: super::machine::Setup<'_>) -> Result<Setup> {
    let live = if setup.samples { "live on" } else { "live off" };
    let commands = record.commands();
    let typed = commands.lines().chain([live]);
    let mut script: Vec<(When, Incident)> = (2..)
        .zip(typed)
        .map(|(sample, line)| (When::Sample(sample), Incident::Type(format!("{line}\r\n"))))
        .collect();
    let end = (REST + record.codes.len()) as u64 + later(setup);
    script.push((When::Sample(REST as u64), Incident::Type("status\r\nstart\r\n".into())));
    match setup.cut_at {
        Some(cut) => script.push((When::Sample(REST as u64 + cut), Incident::End)),
        None => {
            script.push((When::Sample(end), Incident::Type("\r\nstop\r\n".into())));
            script.push((When::Sample(end + LAST), Incident::End));
        }
    }
    let (codes, troubles) = record.after_rest(REST).played();
    let card = setup.card.map(card).transpose()?;
    let port = setup.port;
    let noise = NOISE;
    Ok(Setup { codes, rate_hz: RATE_HZ, noise, troubles, script, card, port, ..Setup::quiet() })
}

/// A card that is inserted at power-up.
///
/// # Errors
/// The image does not exist.
pub fn card(image: &Path) -> Result<CardSetup> {
    let image = image.canonicalize().map_err(|e| format!("{}: {e}", image.display()))?;
    Ok(CardSetup { image, present: true, write_s: 0.8e-3, unreadable: false })
}

/// Index of the test's first sample: the board's samples at the end of the test, by its health line,
/// less those of the test, by its report. Nothing is taken between these two lines; between a health
/// line before the start and the start a sample may be.
fn first_index(shown: &str) -> Option<u64> {
    let (mut all, mut of_test) = (None, None);
    for line in shown.lines() {
        match Line::parse(line) {
            Ok(Line::Health(health)) => all = Some(u64::from(health.samples)),
            Ok(Line::Report(report)) => {
                let counters = report.counters;
                of_test = Some(u64::from(counters.samples) + u64::from(counters.missing));
            }
            Ok(Line::End { .. }) => return all?.checked_sub(of_test?),
            _ => {}
        }
    }
    None
}

/// Addresses of the stack's ends and of the log's RTT control block.
fn symbols(firmware: &Path) -> Result<((u32, u32), Option<u32>)> {
    let bytes = fs::read(firmware).map_err(|e| format!("{}: {e}", firmware.display()))?;
    let elf = object::File::parse(&*bytes).map_err(|e| e.to_string())?;
    let address =
        |name: &str| elf.symbols().find(|s| s.name() == Ok(name)).map(|s| s.address() as u32);
    match (address("_stack_end"), address("_stack_start")) {
        (Some(lower), Some(upper)) => Ok(((lower, upper), address("_SEGGER_RTT"))),
        _ => Err("the image does not name its stack".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::{Config, Counters, Pipeline, Report};
    use floe_firmware::line::Health;
    use floe_firmware::settings::Settings;

    /// Health and report are also requested earlier and during the test.
    #[test]
    fn a_test_begins_where_it_was_started_whoever_asks() {
        let start = |run| Line::Start { run, settings: Settings::default() };
        let health = |samples| Line::Health(Health { samples, ..Health::default() });
        let config = Config { weight_n: 630.0, ..Config::default() };
        let empty = Pipeline::new(&config).expect("valid").report();
        let report = |samples, missing| {
            let counters = Counters { samples, missing, ..Counters::default() };
            Line::Report(Report { counters, ..empty })
        };
        let lines = [
            start(5),
            health(7),
            start(6),
            report(2, 0),
            health(36),
            report(7, 1),
            health(40),
            Line::End { run: 6 },
            health(90),
        ];
        let said = lines.map(|line| line.to_text().expect("short").to_string());
        assert_eq!(first_index(&said.join("\r\n")), Some(32));
        assert_eq!(first_index(&said[..7].join("\r\n")), None);
    }
}
