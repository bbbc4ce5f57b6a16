//! Commands around a test: zero, span and weight, clock, notes.

use embedded_io::{Read, ReadReady, Write};

use super::{App, Job, NO_TEST, config_error};
use crate::adc::Climate;
use crate::line::Line;
use crate::measuring::{Measuring, Task};
use crate::settings::{Settings, Zero};
use crate::store::Store;
use crate::text::text;
use crate::wall_clock::Moment;

/// Half a sampling period, ms: the mean time from a tick to a command.
const HALF_A_PERIOD_MS: u64 = 31;

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    // This function and the next are not inlined: a measurement is large and on the stack when
    // moved.
    /// Starts a measurement of the load on the hook, or continues with another known weight.
    #[inline(never)]
    pub(super) fn measure(&mut self, task: Task) -> Result<(), &'static str> {
        let hint = match (task, &mut self.job) {
            (Task::Calibrate(force_n), Job::Measuring(measuring)) if measuring.is_calibration() => {
                measuring.another(force_n, &self.settings)?;
                "the weight before is kept; "
            }
            _ => {
                self.job = Job::Measuring(Measuring::new(task, &self.settings));
                ""
            }
        };
        self.shared.want(crate::adc::Input::Bridge);
        let what = match task {
            Task::Tare => "the empty hook",
            Task::Calibrate(_) => "the known weight",
            Task::Weigh => "the block",
        };
        let how = " at rest: 8 s or more, best 40; then accept or abort";
        self.info(&text((hint, what, how)));
        Ok(())
    }

    /// Reports the progress of the measurement, once a second.
    #[inline(never)]
    pub(super) fn measured(&mut self) {
        let Job::Measuring(measuring) = &self.job else { return };
        let (weighed, news) = (measuring.weighed(), measuring.news(&self.settings));
        if let Some(weighed) = weighed {
            self.console.tell(&Line::Weighed(weighed));
        }
        if let Some(news) = news {
            self.info(&news);
        }
    }

    /// Stores the result of the measurement in the settings.
    #[inline(never)]
    pub(super) fn accept(&mut self) -> Result<(), &'static str> {
        let Job::Measuring(measuring) = &self.job else {
            return Err("nothing to accept: tare, calibrate or weigh");
        };
        let tare = measuring.is_tare();
        let mut settings = measuring.accept(&self.settings)?;
        settings.check().map_err(config_error)?;
        self.job = Job::Idle;
        if tare {
            self.take_zero(&mut settings);
        }
        self.change(settings);
        Ok(())
    }

    /// Stores the zero for the next test, and for the previous test if one has ended since.
    fn take_zero(&mut self, settings: &mut Settings) {
        let moved_n =
            self.settings.force_n(floe_core::Counts(settings.config.calibration.tare_counts));
        if self.pulled {
            self.settings.zero.after_n = Some(moved_n);
            self.journal.remember(&self.settings);
            self.pulled = false;
        }
        settings.zero = Zero { before_n: Some(0.0), after_n: None };
    }

    // Not inlined, because texts are large.
    /// Writes a note to the log; between tests it belongs to the previous test.
    #[inline(never)]
    pub(super) fn note(&mut self, words: &str) -> Result<(), &'static str> {
        if !self.testing() && !self.pulled {
            return Err(NO_TEST);
        }
        let line = Line::Note(words);
        let Ok(line) = line.to_text() else { return Err("that is too long") };
        self.console.say(&line);
        self.journal.line(&line);
        if !self.testing() {
            self.journal.flush();
        }
        Ok(())
    }

    /// Sets the clock, or shows it if `moment` is `None`.
    #[inline(never)]
    pub(super) fn set_clock(&mut self, moment: Option<Moment>) -> Result<(), &'static str> {
        // Before the first sample there is no sampling period yet.
        let since_ms = if self.health.samples == 0 { 0 } else { HALF_A_PERIOD_MS };
        if let Some(Moment(unix_ms)) = moment {
            // The clock of a running test is set at most once.
            if !self.testing() || self.clock.at(self.newest).is_none() {
                let next = self.newest.wrapping_add(1);
                self.clock.set(unix_ms.saturating_sub(since_ms), next);
                self.is_new_time = true;
                self.sync(next);
            }
        }
        let next_ms = self.clock.at(self.newest.wrapping_add(1));
        self.say_clock(next_ms.map(|ms| ms.saturating_add(since_ms)));
        Ok(())
    }

    fn say_clock(&mut self, unix_ms: Option<u64>) {
        match unix_ms {
            Some(unix_ms) => self.info(&text(("clock ", Moment(unix_ms)))),
            None => self.info("the clock is not set: clock 2027-03-02T10:15:00Z"),
        }
    }

    /// Called when the sampling starts. `unix_ms`: time of day, ms since 1970 (UTC), from a
    /// calendar that kept running through the reset or from a clock command before the sampling.
    #[inline(never)]
    pub fn begin_at(&mut self, unix_ms: Option<u64>) {
        if let Some(unix_ms) = unix_ms {
            // The first conversion begins one period later.
            self.clock.set(unix_ms.saturating_add(2 * HALF_A_PERIOD_MS), 0);
        }
        self.say_clock(unix_ms);
    }

    /// Start of the period in progress, ms since 1970 (UTC), for the board's calendar; `Some` once
    /// after the clock was set.
    pub fn new_time(&mut self) -> Option<u64> {
        if self.has_samples() || !core::mem::take(&mut self.is_new_time) {
            return None;
        }
        // The newest tick started the sample after the newest one.
        self.clock.at(self.newest.wrapping_add(1))
    }

    /// Reports temperature and supply of the converter, if known.
    pub(super) fn say_climate(&mut self, index: u32) {
        let Climate { temperature_256, supply_mv } = self.shared.climate();
        let temperature_c = temperature_256.map(|code| code as f32 / 256.0);
        let supply_v = supply_mv.map(|supply_mv| supply_mv as f32 / 1000.0);
        if temperature_c.is_some() || supply_v.is_some() {
            self.tell(&Line::Climate { index, temperature_c, supply_v });
        }
    }

    /// Reports when the first sample of a test was taken, or that the clock is not set.
    pub(super) fn date(&mut self, index: u32) {
        match self.clock.at(index) {
            Some(_) => self.sync(index),
            None => self.info("the clock is not set: this test has no date"),
        }
    }

    /// During a test, reports when a sample was taken, if the clock is set.
    pub(super) fn sync(&mut self, index: u32) {
        let Job::Test(test) = &self.job else { return };
        if let (Some(first), Some(unix_ms)) = (test.first_index, self.clock.at(index)) {
            // The clock may have been set after the beginning.
            self.journal.date(self.clock.at(first));
            let index = index.wrapping_sub(first);
            self.tell(&Line::Sync { index, unix_ms });
        }
    }
}
