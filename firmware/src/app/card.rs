//! The card in its slot: it comes and goes, its last test may go on.

use super::{App, Job};
use crate::line::Line;
use crate::log;
use crate::store::{CardState, Store};
use crate::text::text;
use embedded_io::{Read, ReadReady, Write};

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    /// The card comes, goes, is being made ready: after a sample, unless others wait, and where a
    /// display has nothing to show, since a step of the log's file takes longer than a period.
    #[inline(never)]
    pub fn tend(&mut self) {
        if self.has_samples() {
            return;
        }
        let state = self.journal.tend();
        let before = self.card.replace(state);
        // Every tenth part of the log's file is said.
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
        if !before.is_some_and(CardState::is_usable) {
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
            | CardState::Full => self.console.tell(&Line::Trouble(state.words())),
        }
    }

    /// Goes on behind the last test of the card, unless there was one since power-up.
    /// Its settings are taken unless there are others already, and if it was not ended
    /// it goes on. A card that was away when a test of this board ended is told so.
    fn take_over(&mut self) {
        if self.testing() {
            return;
        }
        if self.part.run > 0 {
            // One that is there from power-up on has missed nothing.
            if self.journal.failures() > 0 {
                let stored = self.journal.remember(&self.settings);
                self.check_store(stored.is_err());
            }
        } else if self.recall() {
            self.resume();
        }
    }

    /// What the card knows; whether its last test goes on. On its own: a record is big, and
    /// off the stack when the test is resumed.
    #[inline(never)]
    fn recall(&mut self) -> bool {
        let Some(last) = self.journal.last() else { return false };
        self.journal.recall(&last);
        self.part = last.part;
        if self.is_set {
            return false;
        }
        // What is being measured has been computed with other settings.
        if !matches!(self.job, Job::Idle) {
            self.abort();
        }
        self.left_ms = last.last_ms();
        self.settings = last.settings;
        self.is_set = true;
        last.running
    }

    /// Takes the settings of the last test from the card; says hello, and why the
    /// board started, if not by being switched on. A test that was not ended goes on.
    #[inline(never)]
    pub fn power_up(&mut self, last_words: Option<&str>) {
        log::info!("boot: {}", last_words.unwrap_or("power or the button"));
        self.info("floe, help lists the commands");
        if let Some(words) = last_words {
            self.repeat(words);
        }
        self.take_over();
    }

    /// On the card the last words stand at the beginning of the next test.
    #[inline(never)]
    fn repeat(&mut self, last_words: &str) {
        let words = text(("restarted after: ", last_words));
        if let Ok(line) = Line::Trouble(&words).to_text() {
            self.console.say(&line);
            self.journal.line(&line);
        }
    }

    /// The next part of the test that was running. The estimate begins anew: what
    /// led to the reset must not lead to it again.
    fn resume(&mut self) {
        if self.make_pipeline().is_err() {
            return;
        }
        self.part.number = self.part.number.saturating_add(1);
        self.part.gap = None;
        self.begin();
        self.info("the test goes on: stop ends it");
    }

    pub(super) fn check_store(&mut self, failed: bool) {
        // Said at the first failure and about every half hour of them.
        if failed && self.journal.failures() % 4096 == 1 {
            self.console.tell(&Line::Trouble("no card, full or broken: nothing is kept"));
        }
    }
}
