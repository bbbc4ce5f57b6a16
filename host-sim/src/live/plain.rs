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
use super::terminal::ASK_EVERY;
use super::verdict::{SILENT_IF, silence};

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
    let mut list = List::new(form, save);
    let start = Instant::now();
    while !nobody_reads() {
        let input = port.next(Duration::from_secs(1));
        let now = start.elapsed();
        if let Some(input) = input
            && !list.input(place, input, now)?
        {
            break;
        }
        if list.should_ask(now) {
            port.say("status");
        }
        if let Some(words) = list.silence(now) {
            say(&format!("{place}: {words}"));
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
    /// Time of the last request since the port came up.
    asked: Option<Duration>,
    /// Whether the silence of the board was reported.
    is_silent: bool,
    /// Numbers of the test and in it of the last event.
    last: Option<(u32, u32)>,
    /// The board's last complaint, without its numbers.
    complained: String,
}

impl List {
    fn new(form: Form, save: Option<Save>) -> Self {
        let (state, lines) = (State::default(), Lines::default());
        Self {
            state,
            lines,
            form,
            save,
            told: None,
            asked: None,
            is_silent: false,
            last: None,
            complained: String::new(),
        }
    }

    /// Handles an event of the port; returns whether standard output still has a reader.
    fn input(&mut self, place: &Place, input: Input, now: Duration) -> Result<bool, InputError> {
        match input {
            Input::Up => self.up(place, now),
            Input::Down(reason) => self.down(place, reason)?,
            Input::Dropped(bytes) => self.drop(bytes, now)?,
            Input::Bytes(bytes) => return self.take(&bytes, now),
        }
        Ok(true)
    }

    fn up(&mut self, place: &Place, now: Duration) {
        if self.state.away.is_some() {
            say(&format!("{place}: there again"));
        }
        self.state.up(now);
        self.asked = None;
    }

    /// Whether the board should be asked for its state now: when the port has come up, for the rate
    /// and the number of the test, and after a while without a line, since a board without events
    /// says nothing of its own.
    fn should_ask(&mut self, now: Duration) -> bool {
        let long_ago = |then: Duration| now.saturating_sub(then) > ASK_EVERY;
        let quiet = |asked| long_ago(asked) && long_ago(self.state.heard);
        let should = self.state.away.is_none() && self.asked.is_none_or(quiet);
        if should {
            self.asked = Some(now);
        }
        should
    }

    /// The words when a board falls silent, once, and when it speaks again.
    fn silence(&mut self, now: Duration) -> Option<String> {
        let was_silent = self.is_silent;
        let silence = silence(&self.state, now);
        self.is_silent = silence.is_some();
        match silence {
            Some(seconds) if !was_silent => {
                Some(format!("the board is silent for {seconds} s: {SILENT_IF}"))
            }
            // A port that is gone or reopened was reported as such.
            None if was_silent && self.state.away.is_none() => {
                Some("the board speaks again".to_string())
            }
            _ => None,
        }
    }

    fn drop(&mut self, bytes: u64, now: Duration) -> Result<(), InputError> {
        self.keep_unfinished()?;
        self.state.drop(bytes, now);
        say(&format!("{} bytes so far came too fast and were left out", self.state.dropped));
        Ok(())
    }

    /// Saves the beginning of a line whose rest will not come.
    fn keep_unfinished(&mut self) -> Result<(), InputError> {
        match (self.lines.restart(), &mut self.save) {
            (Some(text), Some(save)) => save.line(&text),
            _ => Ok(()),
        }
    }

    /// Processes bytes; returns whether standard output still has a reader.
    fn take(&mut self, bytes: &[u8], now: Duration) -> Result<bool, InputError> {
        for received in self.lines.take(bytes) {
            if let Some(save) = &mut self.save {
                save.line(&received.text)?;
            }
            let event = self.state.take(&received, now);
            self.tell_damage();
            if let Some(words) = self.complaint() {
                say(&format!("the board says: {words}"));
            }
            let Some(event) = event else { continue };
            if let Some(words) = self.new_test(event.index) {
                say(&words);
            }
            if !self.print(&event)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// A new complaint of the board; one that comes again with other numbers is none.
    fn complaint(&mut self) -> Option<String> {
        let (words, _) = self.state.complaint.take()?;
        let bare = words.chars().filter(|letter| !letter.is_ascii_digit()).collect();
        (std::mem::replace(&mut self.complained, bare) != self.complained).then_some(words)
    }

    /// The words before the first event of another test, whose numbers begin anew.
    fn new_test(&mut self, index: u32) -> Option<String> {
        let (run, settings) = self.state.test.as_ref()?;
        let (known, last) = self.last.replace((*run, index))?;
        let is_new = known != *run || index <= last;
        is_new.then(|| format!("events of test {run} {}", settings.name).trim_end().to_string())
    }

    fn down(&mut self, place: &Place, reason: String) -> Result<(), InputError> {
        say(&format!("{place}: gone ({reason}); trying again"));
        self.state.down(reason);
        self.keep_unfinished()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A board that says nothing is asked every few seconds, and reported once.
    #[test]
    fn silence_is_said_once_and_so_is_its_end() {
        let (mut list, seconds) = (List::new(Form::Plain, None), Duration::from_secs);
        list.up(&Place::parse("board:4004"), seconds(1));
        let asked: Vec<u64> = (1..20).filter(|&s| list.should_ask(seconds(s))).collect();
        assert_eq!(asked, [1, 7, 13, 19]);
        let said: Vec<_> = (1..40).filter_map(|s| list.silence(seconds(s))).collect();
        assert_eq!(said, ["the board is silent for 9 s: off, or another program has it"]);
        list.take(b"\r\nI,here*0000\r\n", seconds(41)).unwrap();
        assert_eq!(list.silence(seconds(41)), None, "a damaged line is no answer");
        let line = floe_firmware::line::Line::Info("here").to_text().unwrap();
        list.take(format!("{line}\r\n").as_bytes(), seconds(42)).unwrap();
        assert_eq!(list.silence(seconds(42)).as_deref(), Some("the board speaks again"));
        assert_eq!(list.silence(seconds(43)), None);
    }

    /// A port that is gone is reported as such, and its board is not asked.
    #[test]
    fn a_port_that_is_gone_is_not_silent() {
        let (mut list, seconds) = (List::new(Form::Plain, None), Duration::from_secs);
        let place = Place::parse("board:4004");
        list.up(&place, seconds(0));
        assert!(list.silence(seconds(10)).is_some());
        list.down(&place, "closed".to_string()).unwrap();
        assert_eq!((list.silence(seconds(30)), list.should_ask(seconds(30))), (None, false));
        list.up(&place, seconds(31));
        assert_eq!((list.silence(seconds(32)), list.should_ask(seconds(32))), (None, true));
    }

    /// Also where a board that was off gives its next test the number of the one before.
    #[test]
    fn events_of_another_test_are_told_apart() {
        let mut list = List::new(Form::Json, None);
        let start = |list: &mut List, run| {
            let settings = floe_firmware::settings::Settings::default();
            list.state.test = Some((run, settings));
        };
        assert_eq!(list.new_test(0), None, "no test is known");
        start(&mut list, 1);
        let said = [0, 1, 2, 4, 0, 1].map(|index| list.new_test(index).is_some());
        assert_eq!(said, [false, false, false, false, true, false]);
        start(&mut list, 2);
        assert_eq!(list.new_test(2).as_deref(), Some("events of test 2"));
    }

    /// A converter that is silent says so with every sample.
    #[test]
    fn a_complaint_is_said_once() {
        let mut list = List::new(Form::Plain, None);
        let mut said = |words: &str| {
            list.state.complaint = Some((words.to_string(), Duration::ZERO));
            list.complaint()
        };
        let said = ["sample 9: silent", "sample 10: silent", "FLOE.LOG is full"].map(&mut said);
        assert_eq!(said, [Some("sample 9: silent".into()), None, Some("FLOE.LOG is full".into())]);
        assert_eq!(list.complaint(), None);
    }
}
