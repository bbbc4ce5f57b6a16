//! Insertion and removal of the card, and resuming the last test on it.

use super::{App, Job};
use crate::line::Line;
use crate::log;
use crate::store::{CardState, Store};
use crate::text::text;
use embedded_io::{Read, ReadReady, Write};

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    /// Watches and prepares the card and reports changes of its state. Call it after a sample when
    /// no other sample waits and no picture is due, since one step of making the file exceeds a
    /// period.
    #[inline(never)]
    pub fn tend(&mut self) {
        if self.has_samples() {
            return;
        }
        let state = self.journal.tend();
        let before = self.card.replace(state);
        // Progress is reported in steps of 10 %.
        let shown = |state: CardState| {
            if let CardState::Making(percent) = state {
                CardState::Making(percent / 10)
            } else {
                state
            }
        };
        if before.map(shown) == Some(shown(state)) {
            return;
        }
        log::info!("card: {}", state);
        if before.is_some_and(|before| !before.is_usable()) {
            self.take_over();
        }
        match state {
            CardState::Making(percent @ 10..) => {
                self.info(&text(("log file made to ", u32::from(percent), " %")));
            }
            CardState::Making(_) | CardState::Ready => self.info(state.words()),
            CardState::NoCard
            | CardState::Unreadable
            | CardState::ExFat
            | CardState::Fat12
            | CardState::NotFat
            | CardState::NoRoom
            | CardState::Full => self.console.trouble(state.words()),
        }
    }

    /// Continues after the last test on the card, unless a test has run since power-up. Takes the
    /// card's settings unless there are some already, and resumes its test if that was not ended.
    /// A card that comes later gets the current settings, and misses no end of a test.
    fn take_over(&mut self) {
        if self.testing() {
            return;
        }
        let comes_later = self.is_set;
        if self.part.run == 0 && self.recall() {
            self.resume();
        } else if comes_later {
            self.journal.remember(&self.settings);
        }
    }

    /// Takes over part and settings of the card's last record; returns whether its test was
    /// running. Not inlined: a record is large and must be off the stack when the test is resumed.
    #[inline(never)]
    fn recall(&mut self) -> bool {
        let Some(last) = self.journal.last() else { return false };
        self.journal.recall(&last);
        self.part = last.part;
        if self.is_set {
            return false;
        }
        // A running measurement was computed with the settings replaced here.
        if !matches!(self.job, Job::Idle) {
            self.abort();
        }
        self.left_ms = last.last_ms();
        self.settings = last.settings;
        self.is_set = true;
        last.running
    }

    /// Prints the greeting and the cause of a reset other than power, takes the settings of the
    /// last test from the card, and resumes that test if it was not ended.
    #[inline(never)]
    pub fn power_up(&mut self, last_words: Option<&str>) {
        log::info!("boot: {}", last_words.unwrap_or("power or the button"));
        self.info("floe, help lists the commands");
        if let Some(words) = last_words {
            self.repeat(words);
        }
        self.take_over();
    }

    /// Reports the cause of the reset; on the card it precedes the next test.
    #[inline(never)]
    fn repeat(&mut self, last_words: &str) {
        let words = text(("restarted after: ", last_words));
        if let Ok(line) = Line::Trouble(&words).to_text() {
            self.console.say(&line);
            self.journal.line(&line);
        }
    }

    /// Starts the next part of the interrupted test. The estimate begins again from nothing, so
    /// that its state cannot cause the same reset again.
    fn resume(&mut self) {
        if self.make_pipeline().is_err() {
            return;
        }
        self.part.number = self.part.number.saturating_add(1);
        self.part.gap = None;
        self.begin();
        self.info("the test goes on: stop ends it");
    }

    /// Reports that sectors cannot be written, at the first failure and then about every half hour.
    pub(super) fn check_store(&mut self) {
        let failures = self.journal.failures().div_ceil(4096);
        if failures != core::mem::replace(&mut self.failures, failures) {
            self.console.trouble("no card, full or broken: nothing is kept");
        }
    }
}
