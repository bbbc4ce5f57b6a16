//! A test: it starts, its samples come, it ends.

use embedded_io::{Read, ReadReady, Write};
use floe_core::{Event, Phase, Pipeline, Step};

use super::{App, Job, NO_TEST, config_error};
use crate::line::{About, Line, LiveSample};
use crate::log;
use crate::notebook::Winch;
use crate::record::Part;
use crate::sample::Sample;
use crate::settings::Effects;
use crate::store::Store;
use crate::wall_clock::periods;

/// Periods between two lines of temperature and supply: a minute.
const CLIMATE_PERIODS: u32 = 960;

pub(super) struct Test {
    /// Index of its first sample, once that has come.
    pub(super) first_index: Option<u32>,
    pub(super) phase: Phase,
    /// A first answer whose event has not come yet.
    pub(super) about: Option<About>,
    /// Rate of the force, N/s, the newest there is.
    pub(super) rate_n_per_s: Option<f32>,
}

impl Test {
    /// Keeps what a display shows.
    fn note(&mut self, step: &Step) {
        self.phase = step.phase;
        self.rate_n_per_s = step.rate.map(|rate| rate.rate_n_per_s);
        if let Some(answer) = step.provisional {
            self.about = Some(About { index: step.sample.index, answer });
        }
        if let Some(event) = &step.event {
            self.about = self.about.filter(|about| !about.is_followed_by(event));
        }
    }
}

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    pub(super) fn start(&mut self) -> Result<(), &'static str> {
        self.make_pipeline()?;
        self.shared.want(crate::adc::Input::Bridge);
        let run = self.part.run.wrapping_add(1);
        // What was on this card before makes it another one too.
        self.stir(self.part.id.unwrap_or(0) ^ u64::from(run));
        self.part = Part { id: Some(self.dice), run, ..Part::default() };
        log::info!("test {} starts", run);
        self.settings.effects = Effects::of(self.settings.effects.in_use());
        self.begin();
        Ok(())
    }

    /// From the next sample on it is a test.
    pub(super) fn begin(&mut self) {
        self.journal.begin(self.part, &self.settings);
        self.say_settings();
        let (phase, about, rate_n_per_s) = (Phase::Unknown, None, None);
        self.job = Job::Test(Test { first_index: None, phase, about, rate_n_per_s });
        if let Some(words) = self.warning {
            self.trouble(words);
        }
    }

    // On its own: while it is made, a good part of it is on the stack.
    #[inline(never)]
    pub(super) fn make_pipeline(&mut self) -> Result<(), &'static str> {
        // Not by way of `map_err`, which copies it field by field: 400 bytes of flash.
        match Pipeline::new(&self.settings.core_config()) {
            Ok(pipeline) => *self.pipeline = Some(pipeline),
            Err(error) => return Err(config_error(error)),
        }
        Ok(())
    }

    #[inline(never)]
    pub(super) fn stop(&mut self) -> Result<(), &'static str> {
        if !self.testing() {
            return Err("no test is running");
        }
        while let Some(event) = self.finish_event() {
            self.tell_event(event);
        }
        while let Some(stretch) = self.pipeline.as_mut().and_then(Pipeline::finish_stretch) {
            self.tell(&Line::Stretch(stretch));
        }
        if let Some(report) = self.report() {
            self.tell(&Line::Report(report));
        }
        self.tell(&Line::Health(self.health()));
        self.tell(&Line::End { run: self.part.run });
        self.job = Job::Idle;
        self.pulled = true;
        log::info!("test {} ends", self.part.run);
        let stored = self.journal.end();
        self.check_store(stored.is_err());
        Ok(())
    }

    /// Says an event, and when its onset was.
    fn tell_event(&mut self, event: Event) {
        self.tell(&Line::Event(event));
        if let Job::Test(Test { first_index: Some(first), .. }) = self.job {
            self.sync(first.wrapping_add(event.onset.index));
        }
    }

    /// What the pipeline still holds back.
    fn finish_event(&mut self) -> Option<Event> {
        self.pipeline.as_mut().and_then(Pipeline::finish)
    }

    /// The winch turns from the next sample on, or is held.
    pub(super) fn mark_winch(&mut self, winch: Winch) -> Result<(), &'static str> {
        let (Job::Test(_), Some(pipeline)) = (&self.job, self.pipeline.as_mut()) else {
            return Err(NO_TEST);
        };
        let index = pipeline.mark_winch(winch == Winch::Moving);
        self.tell(&Line::Mark { index, winch });
        Ok(())
    }

    pub(super) fn step(&mut self, sample: Sample) {
        let (Job::Test(test), Some(pipeline)) = (&mut self.job, self.pipeline.as_mut()) else {
            return;
        };
        let begins = test.first_index.is_none();
        if begins {
            self.part.first_index = sample.index;
            self.part.start_ms = self.clock.at(sample.index);
            if self.part.number > 0 {
                self.part.gap = lost_between(self.left_ms, self.part.start_ms);
            }
            self.journal.begin(self.part, &self.settings);
        }
        let first_index = *test.first_index.get_or_insert(sample.index);
        let step = pipeline.step(sample.raw(first_index));
        if step.sample.gap > 0 {
            log::warn!("{} samples missing before {}", step.sample.gap, sample.index);
        }
        test.note(&step);
        self.force_n = step.sample.force_n;
        if begins {
            self.date(sample.index);
        }
        // Their number in 32 bits: eight years.
        if step.sample.index.is_multiple_of(CLIMATE_PERIODS) {
            self.say_climate(step.sample.index);
        }
        if self.live {
            self.show(&step);
        }
        if let Some(index) = step.spike {
            self.tell(&Line::Spike(index));
        }
        if let Some(event) = step.event {
            log::debug!("{}", event);
            self.tell_event(event);
        }
        if let Some(change) = step.change {
            self.tell(&Line::Change(change));
        }
        if let Some(stretch) = step.stretch {
            self.tell(&Line::Stretch(stretch));
        }
        self.journal.counters(self.shared.overruns(), self.health.adc_faults);
        let stored = self.journal.sample(sample);
        self.check_store(stored.is_err());
    }

    /// What is only for a display, not for the card.
    fn show(&mut self, step: &Step) {
        let floe_core::ForceSample { index, force_n, flag, gap } = step.sample;
        let (phase, rate_n_per_s) = (step.phase, step.rate.map(|rate| rate.rate_n_per_s));
        let sample = LiveSample { index, force_n, flag, phase, gap, rate_n_per_s };
        self.console.tell(&Line::Sample(sample));
        if let Some(answer) = step.provisional {
            self.console.tell(&Line::About(About { index, answer }));
        }
    }
}

/// Sampling periods between the last sample on the card and the first of the next part, if a
/// clock has run all the time.
fn lost_between(left_ms: Option<u64>, start_ms: Option<u64>) -> Option<u32> {
    periods(start_ms?.checked_sub(left_ms?)?).checked_sub(1)
}
