//! The main loop's work: samples to results, commands to deeds.

use embedded_io::{Read, ReadReady, Write};
use floe_core::{Phase, Pipeline, Provisional, Report};

use crate::console::Console;
use crate::journal::Journal;
use crate::line::{Health, Line, Weighed};
use crate::log;
use crate::measuring::Measuring;
use crate::period::PeriodMeter;
use crate::record::Part;
use crate::sample::{Sample, SampleConsumer, Shared};
use crate::self_test::SelfTest;
use crate::settings::Settings;
use crate::store::{CardState, Store};
use crate::text::text;
use crate::wall_clock::WallClock;

mod around;
mod card;
mod console;
mod self_test;
mod test;

use console::config_error;
use test::Test;

/// For a note or a mark without one.
const NO_TEST: &str = "start a test first";

/// Everything but the sampling interrupt and the board.
// The small fields first: their distance from the beginning is a part of every instruction
// that uses them, and a small one makes it a short one.
#[expect(missing_debug_implementations, reason = "the queue has none")]
#[repr(C)]
pub struct App<'q, P, S> {
    pipeline: &'q mut Option<Pipeline>,
    shared: &'q Shared,
    queue: SampleConsumer<'q>,
    /// Whether the settings are somebody's, typed or those of a card.
    is_set: bool,
    live: bool,
    /// Whether the clock has been set and the board's calendar has not.
    is_new_time: bool,
    /// Whether a test has ended since the zero was taken.
    pulled: bool,
    clock_hz: u32,
    /// Number of the newest sample.
    newest: u32,
    card: Option<CardState>,
    force_n: Option<f32>,
    warning: Option<&'static str>,
    /// Stirred by every reading: what makes the identity of the next test.
    dice: u64,
    /// When the last sample on the card of a test that goes on was taken, ms since 1970.
    left_ms: Option<u64>,
    part: Part,
    period: PeriodMeter,
    clock: WallClock,
    health: Health,
    settings: Settings,
    console: Console<P>,
    job: Job,
    journal: Journal<S>,
}

/// What the samples are used for.
#[expect(clippy::large_enum_variant, reason = "there is one of them, and no heap")]
enum Job {
    Idle,
    Test(Test),
    Measuring(Measuring),
    SelfTest(SelfTest),
}

/// What a display shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Force now, N.
    pub force_n: Option<f32>,
    /// Rate of the force during a test, N/s, two samples late.
    pub rate_n_per_s: Option<f32>,
    /// The weight so far, while the block is weighed.
    pub weighed: Option<Weighed>,
    /// Time of day, ms since 1970 (UTC), if the clock is set.
    pub unix_ms: Option<u64>,
    /// The result so far, while a test is running.
    pub report: Option<Report>,
    /// What the block is doing.
    pub phase: Phase,
    /// A first answer on the newest slip, until its event.
    pub provisional: Option<Provisional>,
    /// The state of the board.
    pub health: Health,
    /// The state of the card.
    pub card: CardState,
}

impl<'q, P: Read + ReadReady + Write, S: Store> App<'q, P, S> {
    /// Touches nothing yet. The pipeline's place is the caller's: it is most of the
    /// memory, and should not travel.
    #[inline]
    pub fn new(
        queue: SampleConsumer<'q>,
        shared: &'q Shared,
        pipeline: &'q mut Option<Pipeline>,
        port: P,
        store: S,
        clock_hz: u32,
    ) -> Self {
        Self {
            queue,
            shared,
            console: Console::new(port),
            journal: Journal::new(store, clock_hz),
            pipeline,
            clock_hz,
            settings: Settings::default(),
            is_set: false,
            part: Part::default(),
            dice: 0,
            live: true,
            job: Job::Idle,
            health: Health::default(),
            period: PeriodMeter::default(),
            force_n: None,
            clock: WallClock::default(),
            is_new_time: false,
            left_ms: None,
            newest: 0,
            pulled: false,
            card: None,
            warning: None,
        }
    }

    /// Takes the samples that wait, and does what was typed. Returns the number of samples: if
    /// there were any, it is the turn of the display or of the card ([`App::tend`]).
    pub fn turn(&mut self) -> u32 {
        let mut samples = 0;
        while let Some(sample) = self.queue.dequeue() {
            self.take(sample);
            samples += 1;
        }
        // No line while a sample waits: a port that talks without a pause (one that repeats
        // what it hears, say) must not keep the samples from being taken.
        while !self.has_samples()
            && let Some(typed) = self.console.poll()
        {
            self.obey(&typed);
        }
        samples
    }

    /// Something of the board that whoever reads a test has to know: said now and
    /// in every test.
    pub fn warn(&mut self, words: &'static str) {
        self.warning = Some(words);
        self.trouble(words);
    }

    /// Whether a sample waits.
    pub fn has_samples(&self) -> bool {
        self.queue.ready()
    }

    /// What a display should show now.
    pub fn view(&self) -> View {
        let test = match &self.job {
            Job::Test(test) => Some(test),
            Job::Idle | Job::Measuring(_) | Job::SelfTest(_) => None,
        };
        let weighed = match &self.job {
            Job::Measuring(measuring) => measuring.weighed(),
            Job::Idle | Job::Test(_) | Job::SelfTest(_) => None,
        };
        View {
            force_n: self.force_n,
            rate_n_per_s: test.and_then(|test| test.rate_n_per_s),
            weighed,
            unix_ms: self.clock.at(self.newest),
            report: self.report(),
            phase: test.map_or(Phase::Unknown, |t| t.phase),
            provisional: test.and_then(|t| t.about).map(|about| about.answer),
            health: self.health(),
            card: self.card.unwrap_or_default(),
        }
    }

    /// The result so far, while a test is running.
    fn report(&self) -> Option<Report> {
        self.pipeline.as_ref().filter(|_| self.testing()).map(Pipeline::report)
    }

    /// The card.
    pub fn store(&self) -> &S {
        self.journal.store()
    }

    #[inline(never)]
    fn take(&mut self, sample: Sample) {
        self.count(&sample);
        match &mut self.job {
            Job::Idle => self.show_force(&sample),
            Job::Test(_) => self.step(sample),
            Job::Measuring(measuring) => {
                let news = measuring.add(&sample);
                self.show_force(&sample);
                if news {
                    self.measured();
                }
            }
            Job::SelfTest(test) => {
                if let Some(mean) = test.add(&sample) {
                    self.self_test(mean);
                }
            }
        }
    }

    fn count(&mut self, sample: &Sample) {
        self.period.add(sample);
        self.newest = sample.index;
        self.stir(u64::from(sample.stamp));
        self.health.samples = self.health.samples.wrapping_add(1);
        match sample.reading {
            Ok(code) => {
                self.stir(u64::from(code.0 as u32));
                let (lowest, highest) = self.settings.config.calibration.range_counts;
                let full = code.0 <= lowest || code.0 >= highest;
                self.health.saturated = self.health.saturated.wrapping_add(u32::from(full));
            }
            Err(fault) => {
                self.health.adc_faults = self.health.adc_faults.wrapping_add(1);
                log::warn!("sample {}: {}", sample.index, fault);
                // While a fault lasts it is said once a second, with every change.
                self.adc_trouble(sample, fault);
            }
        }
    }

    /// A step of a multiplicative hash: the noise of the readings and the moments
    /// at which somebody typed make it different everywhere.
    #[inline(never)]
    fn stir(&mut self, what: u64) {
        const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
        self.dice = (self.dice ^ what).wrapping_mul(ODD).rotate_left(29);
    }

    #[inline(never)]
    fn adc_trouble(&mut self, sample: &Sample, fault: crate::adc::AdcFault) {
        if self.health.adc_faults % 16 == 1 {
            let said = ("converter at sample ", sample.index, (": ", fault.words()));
            self.trouble(&text(said));
        }
    }

    fn show_force(&mut self, sample: &Sample) {
        self.force_n = sample.reading.ok().map(|code| self.settings.force_n(code));
    }

    fn health(&self) -> Health {
        let seconds = |ticks: u32| ticks as f32 / self.clock_hz as f32;
        Health {
            overruns: self.shared.overruns(),
            deepest: self.shared.deepest(),
            period_s: self.period.mean_s(self.clock_hz),
            jitter_s: self.period.extremes().map(|(low, high)| seconds(high - low)),
            sectors: self.journal.sectors(),
            store_failures: self.journal.failures(),
            ..self.health
        }
    }

    fn testing(&self) -> bool {
        matches!(self.job, Job::Test(_))
    }

    fn say_settings(&mut self) {
        let line = Line::Start { run: self.part.run, settings: self.settings.clone() };
        self.tell(&line);
    }

    fn info(&mut self, text: &str) {
        self.console.tell(&Line::Info(text));
    }

    fn trouble(&mut self, text: &str) {
        self.tell(&Line::Trouble(text));
    }

    /// Says a line, and during a test writes it to the card too.
    fn tell(&mut self, line: &Line<'_>) {
        let Ok(text) = line.to_text() else { return };
        self.console.say(&text);
        if self.testing() {
            self.journal.line(&text);
        }
    }
}
