//! Output for a file or another program: one line per event.

use std::io::{ErrorKind, Write};
use std::time::{Duration, Instant};

use floe_core::{Coefficient, Event};

use crate::cli::output::{nobody_reads, say};
use crate::error::InputError;
use crate::rounding::{counted, narrow};

use super::lines::Lines;
use super::place::Place;
use super::port::{Input, Port};
use super::save::Save;
use super::state::State;

/// Form of an event's line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Text for a person.
    Plain,
    /// A JSON object with the fields of a replay's events.
    Json,
}

/// Runs until the reader of standard output goes away.
///
/// # Errors
/// Standard output or the file cannot be written.
pub fn run(place: &Place, port: &Port, form: Form, save: Option<Save>) -> Result<(), InputError> {
    let (state, lines) = (State::default(), Lines::default());
    let mut list = List { state, lines, form, save, told: None };
    let start = Instant::now();
    while !nobody_reads() {
        let Some(input) = port.next(Duration::from_secs(1)) else { continue };
        let now = start.elapsed();
        match input {
            Input::Up => {
                list.up(place, now);
                // Requests the rate and the number of the test.
                port.say("status");
            }
            Input::Down(reason) => list.down(place, reason),
            Input::Dropped(bytes) => list.drop(bytes, now),
            Input::Bytes(bytes) => {
                if !list.take(&bytes, now)? {
                    break;
                }
            }
        }
    }
    Ok(())
}

struct List {
    state: State,
    lines: Lines,
    form: Form,
    save: Option<Save>,
    /// Number of damaged lines reported on standard error; `None` before the first.
    told: Option<u64>,
}

impl List {
    fn up(&mut self, place: &Place, now: Duration) {
        if self.state.away.is_some() {
            say(&format!("{place}: there again"));
        }
        self.state.up(now);
        self.lines.restart();
    }

    fn drop(&mut self, bytes: u64, now: Duration) {
        self.lines.restart();
        self.state.drop(bytes, now);
        say(&format!("{} bytes so far came too fast and were left out", self.state.dropped));
    }

    /// Processes bytes; returns whether standard output still has a reader.
    fn take(&mut self, bytes: &[u8], now: Duration) -> Result<bool, InputError> {
        for received in self.lines.take(bytes) {
            if let Some(save) = &mut self.save {
                save.line(&received.text)?;
            }
            let event = self.state.take(&received, now);
            self.tell_damage();
            if let Some(event) = event
                && !self.print(&event)?
            {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn down(&mut self, place: &Place, reason: String) {
        say(&format!("{place}: gone ({reason}); trying again"));
        self.state.down(reason);
    }

    /// Reports damaged lines: at the first, tenth and hundredth.
    fn tell_damage(&mut self) {
        let damaged = self.state.damaged;
        if damaged >= self.told.map_or(1, |told| told.saturating_mul(10)) {
            say(&format!("{} so far", counted(damaged, "damaged line")));
            self.told = Some(damaged);
        }
    }

    /// Prints an event; returns whether standard output still has a reader.
    fn print(&self, event: &Event) -> Result<bool, InputError> {
        let text = self.text(event)?;
        let mut out = std::io::stdout().lock();
        match writeln!(out, "{text}").and_then(|()| out.flush()) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
            Err(error) => {
                Err(InputError::new(format!("standard output cannot be written: {error}")))
            }
        }
    }

    fn text(&self, event: &Event) -> Result<String, InputError> {
        match self.form {
            Form::Plain => Ok(plain(event, self.state.seconds(event.onset))),
            Form::Json => {
                serde_json::to_string(&self.state.summary(event)).map_err(InputError::new)
            }
        }
    }
}

/// Text of an event's coefficient.
pub(super) fn coefficient(value: Option<Coefficient>) -> String {
    match value {
        Some(value) => format!("{:.4} ± {}", value.value, narrow(value.combined_std().into())),
        None => "-".to_string(),
    }
}

fn plain(event: &Event, onset_s: f64) -> String {
    let (mu_s, mu) = (coefficient(event.mu_s), coefficient(event.mu));
    let (fs, fp) = (event.static_force_n, event.dynamic_force_n);
    let reason = event.reason.map(|reason| format!(": {reason}")).unwrap_or_default();
    let (index, quality) = (event.index, event.quality);
    format!(
        "event {index}  onset {onset_s:.3} s  mu_s {mu_s}  mu {mu}  Fs {fs:.1} N  Fp {fp:.1} N  \
         {quality}{reason}"
    )
}
