//! The application of the main loop: processes samples and executes commands.

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

/// Answer to a note or a mark when no test is running.
const NO_TEST: &str = "start a test first";

/// State of the main loop: everything except the sampling interrupt and the board.
// The small fields come first: a small offset from the beginning makes the instructions that access
// a field short.
#[expect(missing_debug_implementations, reason = "the queue has none")]
#[repr(C)]
pub struct App<'q, P, S> {
    pipeline: &'q mut Option<Pipeline>,
    shared: &'q Shared,
    queue: SampleConsumer<'q>,
    /// Whether the settings were typed by the user or read from a card.
    is_set: bool,
    live: bool,
    /// Whether the clock was set and the board's calendar has still to be set.
    is_new_time: bool,
    /// Whether a test has ended since the zero was measured.
    pulled: bool,
    clock_hz: u32,
    /// Failures to write a sector that were reported, in units of 4096.
    failures: u32,
    /// Index of the newest sample.
    newest: u32,
    card: Option<CardState>,
    force_n: Option<f32>,
    warning: Option<&'static str>,
    /// Hash state from which the identity of the next test is taken; every reading changes it.
    dice: u64,
    /// When the last sample on the card was taken, ms since 1970 (UTC), if its test is resumed.
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

/// Values for the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Current force, N.
    pub force_n: Option<f32>,
    /// Rate of the force during a test, N/s, delayed by two samples.
    pub rate_n_per_s: Option<f32>,
    /// Newest result of the weighing while the block is weighed.
    pub weighed: Option<Weighed>,
    /// Time of day, ms since 1970 (UTC), if the clock is set.
    pub unix_ms: Option<u64>,
    /// Result so far while a test is running.
    pub report: Option<Report>,
    /// Phase of the block's motion.
    pub phase: Phase,
    /// First answer on the newest slip, until its event is complete.
    pub provisional: Option<Provisional>,
    /// The state of the board.
    pub health: Health,
    /// The state of the card.
    pub card: CardState,
}

impl<'q, P: Read + ReadReady + Write, S: Store> App<'q, P, S> {
    /// Does not access the hardware yet. The caller provides the pipeline's memory, because the
    /// pipeline is most of the program's RAM and must not be moved.
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
            failures: 0,
        }
    }

    /// Processes the waiting samples and the typed commands. Returns the number of samples: if it
    /// is not zero, the caller updates the display or the card ([`App::tend`]) next.
    pub fn turn(&mut self) -> u32 {
        let mut samples = 0;
        while let Some(sample) = self.queue.dequeue() {
            self.take(sample);
            samples += 1;
        }
        // Read no line while a sample waits: a port that delivers without a pause (for example one
        // that echoes its input) must not delay the samples.
        while !self.has_samples()
            && let Some(typed) = self.console.poll()
        {
            self.obey(&typed);
        }
        self.check_store();
        samples
    }

    /// Reports a defect of the board, now and in every later test, because it matters to every
    /// reader of a test.
    pub fn warn(&mut self, words: &'static str) {
        self.warning = Some(words);
        self.trouble(words);
    }

    /// Whether a sample waits in the queue.
    pub fn has_samples(&self) -> bool {
        self.queue.ready()
    }

    /// Values for the display at this moment.
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

    /// Result so far, while a test is running.
    fn report(&self) -> Option<Report> {
        self.pipeline.as_ref().filter(|_| self.testing()).map(Pipeline::report)
    }

    /// Storage of the journal's sectors.
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
                // A lasting fault is reported once a second: every 16th faulty reading.
                self.adc_trouble(sample, fault);
            }
        }
    }

    /// One step of a multiplicative hash. Noise of the readings and the times of typing make its
    /// value different on every board.
    #[inline(never)]
    fn stir(&mut self, what: u64) {
        const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
        self.dice = (self.dice ^ what).wrapping_mul(ODD).rotate_left(29);
    }

    #[inline(never)]
    fn adc_trouble(&mut self, sample: &Sample, fault: crate::adc::AdcFault) {
        if self.health.adc_faults % 16 == 1 {
            // Before a test, or its first sample, since power-up.
            let first = if let Job::Test(test) = &self.job { test.first_index } else { None };
            let index = sample.index.wrapping_sub(first.unwrap_or(0));
            let said = ("converter at sample ", index, (": ", fault.words()));
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
        self.console.tell(&line);
    }

    fn info(&mut self, text: &str) {
        self.console.tell(&Line::Info(text));
    }

    fn trouble(&mut self, text: &str) {
        self.tell(&Line::Trouble(text));
    }

    /// Sends a line to the console, and during a test to the card as well.
    fn tell(&mut self, line: &Line<'_>) {
        let Ok(text) = line.to_text() else { return };
        self.console.say(&text);
        if self.testing() {
            self.journal.line(&text);
        }
    }
}
