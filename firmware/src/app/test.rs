//! Start, samples and end of a test.

use embedded_io::{Read, ReadReady, Write};
use floe_core::{Event, Phase, Pipeline, Step};

use super::{App, Job, NO_TEST, config_error};
use crate::adc::Input;
use crate::line::{About, Line, LiveSample};
use crate::log;
use crate::notebook::Winch;
use crate::record::Part;
use crate::sample::Sample;
use crate::settings::Effects;
use crate::store::Store;
use crate::wall_clock::periods;

/// Sampling periods between two lines of temperature and supply: one minute.
const CLIMATE_PERIODS: u32 = 960;

pub(super) struct Test {
    /// Index of the test's first sample, `None` before that sample.
    pub(super) first_index: Option<u32>,
    pub(super) phase: Phase,
    /// First answer on a slip whose event is not complete yet.
    pub(super) about: Option<About>,
    /// Newest rate of the force, N/s.
    pub(super) rate_n_per_s: Option<f32>,
}

impl Test {
    /// Stores the values that the display needs.
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
        // The identity depends on the card's previous test too.
        self.stir(self.part.id.unwrap_or(0) ^ u64::from(run));
        self.part = Part { id: Some(self.dice), run, ..Part::default() };
        log::info!("test {} starts", run);
        self.settings.effects = Effects::of(self.settings.effects.in_use());
        self.begin();
        Ok(())
    }

    /// Starts a test or a part of one with the next sample.
    pub(super) fn begin(&mut self) {
        self.journal.begin(self.part, &self.settings);
        self.say_settings();
        let (phase, about, rate_n_per_s) = (Phase::Unknown, None, None);
        self.job = Job::Test(Test { first_index: None, phase, about, rate_n_per_s });
        if let Some(words) = self.warning {
            self.trouble(words);
        }
    }

    // Not inlined: a large part of the new pipeline is on the stack.
    #[inline(never)]
    pub(super) fn make_pipeline(&mut self) -> Result<(), &'static str> {
        // `map_err` would copy the pipeline field by field: 400 bytes of flash.
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
        self.journal.end();
        Ok(())
    }

    /// Reports an event and the time of its onset.
    fn tell_event(&mut self, event: Event) {
        self.tell(&Line::Event(event));
        if let Job::Test(Test { first_index: Some(first), .. }) = self.job {
            self.sync(first.wrapping_add(event.onset.index));
        }
    }

    /// Returns the event that the pipeline still holds back.
    fn finish_event(&mut self) -> Option<Event> {
        self.pipeline.as_mut().and_then(Pipeline::finish)
    }

    /// Records that the winch turns or is held from the next sample on.
    pub(super) fn mark_winch(&mut self, winch: Winch) -> Result<(), &'static str> {
        let (Job::Test(_), Some(pipeline)) = (&self.job, self.pipeline.as_mut()) else {
            return Err(NO_TEST);
        };
        let index = pipeline.mark_winch(winch == Winch::Moving);
        self.tell(&Line::Mark { index, winch });
        Ok(())
    }

    pub(super) fn step(&mut self, sample: Sample) {
        // The queue may still hold readings of the self test.
        let (Job::Test(test), Some(pipeline), Input::Bridge) =
            (&mut self.job, self.pipeline.as_mut(), sample.input)
        else {
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
        // A 32-bit index lasts eight years.
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
        self.journal.sample(sample);
    }

    /// Sends the line that only a display needs, not the card.
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

/// Sampling periods between the last sample on the card and the first of the next part; `None`
/// without both times.
fn lost_between(left_ms: Option<u64>, start_ms: Option<u64>) -> Option<u32> {
    periods(start_ms?.checked_sub(left_ms?)?).checked_sub(1)
}
