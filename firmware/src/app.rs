//! The main loop's work: samples to results, commands to deeds.

use embedded_io::{Read, ReadReady, Write};
use floe_core::{Event, Phase, Pipeline, Provisional, Report, Step};

use crate::command::{Command, HELP, Setting};
use crate::console::{Console, Typed};
use crate::journal::Journal;
use crate::line::{About, Health, Line, LiveSample, Mean, Weighed};
use crate::log;
use crate::measuring::Measuring;
use crate::period::PeriodMeter;
use crate::record::Part;
use crate::sample::{Sample, SampleConsumer, Shared};
use crate::self_test::{SelfTest, part_of_range};
use crate::settings::{Effects, Settings};
use crate::store::{CardState, Store};
use crate::text::{Fixed, text};
use crate::wall_clock::{WallClock, periods};

mod around;

/// Periods between two lines of temperature and supply: a minute.
const CLIMATE_PERIODS: u32 = 960;

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

struct Test {
    /// Index of its first sample, once that has come.
    first_index: Option<u32>,
    phase: Phase,
    /// A first answer whose event has not come yet.
    about: Option<About>,
    /// Rate of the force, N/s, the newest there is.
    rate_n_per_s: Option<f32>,
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

    /// Does all there is to do now. Afterwards the board may sleep until an
    /// interrupt. Returns whether a sample was there.
    pub fn turn(&mut self) -> bool {
        let mut any = false;
        while let Some(sample) = self.queue.dequeue() {
            self.take(sample);
            any = true;
        }
        while let Some(typed) = self.console.poll() {
            self.obey(&typed);
        }
        if !self.has_samples() {
            self.tend();
        }
        any
    }

    /// The card comes, goes, is being made ready.
    #[inline(never)]
    fn tend(&mut self) {
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
            | CardState::NoRoom => self.console.tell(&Line::Trouble(state.words())),
        }
    }

    /// Goes on behind the last test of the card, unless there was one since power-up.
    /// Its settings are taken unless there are others already, and if it was not ended
    /// it goes on.
    fn take_over(&mut self) {
        let idle = !self.testing() && self.part.run == 0;
        if idle && self.recall() {
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
        self.left_ms = last.last_ms();
        self.settings = last.settings;
        self.is_set = true;
        last.running
    }

    /// Something of the board that whoever reads a test has to know: said now and
    /// in every test.
    pub fn warn(&mut self, words: &'static str) {
        self.warning = Some(words);
        self.trouble(words);
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

    /// Whether a sample waits.
    pub fn has_samples(&self) -> bool {
        self.queue.ready()
    }

    /// Whether there is something to do: no time to sleep.
    pub fn is_busy(&self) -> bool {
        self.has_samples() || matches!(self.card, Some(CardState::Making(_)))
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

    fn step(&mut self, sample: Sample) {
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
        if (step.sample.index as u32).is_multiple_of(CLIMATE_PERIODS) {
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

    // On its own, as all that is done with what was typed needs its stack.
    #[inline(never)]
    fn obey(&mut self, typed: &Typed) {
        let command = match typed {
            Typed::TooLong => Err("that line is too long"),
            Typed::Line(line) => Command::parse(line),
        };
        let done = command.and_then(|command| self.execute(command));
        if let Err(reason) = done {
            self.console.tell(&Line::Trouble(reason));
        }
    }

    #[inline(never)]
    fn execute(&mut self, command: Command) -> Result<(), &'static str> {
        match command {
            Command::Status => self.status(),
            Command::Live(live) => self.live = live,
            Command::Help => self.console.tell(&Line::Info(HELP)),
            Command::Stop => self.stop()?,
            Command::Abort => self.abort(),
            Command::Note(words) => self.note(&words)?,
            Command::Clock(moment) => self.set_clock(moment)?,
            _ if self.testing() => return Err("a test is running; stop ends it"),
            Command::Start => self.start()?,
            Command::Measure(task) => self.measure(task)?,
            Command::Accept => self.accept()?,
            Command::SelfTest => self.begin_self_test(),
            Command::Set(setting) => self.set(setting)?,
        }
        Ok(())
    }

    // On its own: settings are big, and on the stack while they change.
    #[inline(never)]
    fn set(&mut self, setting: Setting) -> Result<(), &'static str> {
        let settings = self.settings.with(setting).map_err(config_error)?;
        self.change(settings);
        Ok(())
    }

    fn change(&mut self, settings: Settings) {
        self.settings = settings;
        self.is_set = true;
        let stored = self.journal.remember(&self.settings);
        self.check_store(stored.is_err());
        self.say_settings();
    }

    fn start(&mut self) -> Result<(), &'static str> {
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
    fn begin(&mut self) {
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
    fn make_pipeline(&mut self) -> Result<(), &'static str> {
        *self.pipeline = Some(Pipeline::new(&self.settings.core_config()).map_err(config_error)?);
        Ok(())
    }

    #[inline(never)]
    fn stop(&mut self) -> Result<(), &'static str> {
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
            self.sync(first.wrapping_add(event.onset.index as u32));
        }
    }

    /// What the pipeline still holds back.
    fn finish_event(&mut self) -> Option<Event> {
        self.pipeline.as_mut().and_then(Pipeline::finish)
    }

    fn abort(&mut self) {
        if !self.testing() {
            self.shared.want(crate::adc::Input::Bridge);
            self.job = Job::Idle;
            self.info("aborted");
        }
    }

    /// Only to the console: the card has it all, and a display asks often.
    #[inline(never)]
    fn status(&mut self) {
        let settings = Line::Start { run: self.part.run, settings: self.settings.clone() };
        self.console.tell(&settings);
        if let Some(report) = self.report() {
            self.console.tell(&Line::Report(report));
        }
        self.console.tell(&Line::Health(self.health()));
    }

    fn begin_self_test(&mut self) {
        let test = SelfTest::new();
        self.shared.want(test.input());
        self.job = Job::SelfTest(test);
    }

    #[inline(never)]
    fn self_test(&mut self, mean: Mean) {
        self.console.tell(&Line::Mean(mean));
        let Job::SelfTest(test) = &mut self.job else { return };
        if let Some(trouble) = SelfTest::judge(&mean, &self.settings) {
            test.fail();
            self.console.tell(&Line::Trouble(trouble));
        }
        if test.advance() {
            return self.shared.want(test.input());
        }
        let percent = 100.0 * part_of_range(mean.mean, &self.settings);
        self.console.tell(&Line::Info(&text(("load ", Fixed(percent, 1), " % of the range"))));
        let passed = test.passed();
        self.job = Job::Idle;
        self.shared.want(crate::adc::Input::Bridge);
        self.console.tell(&Line::Health(self.health()));
        self.info(if passed { "self test passed" } else { "self test FAILED" });
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

    fn check_store(&mut self, failed: bool) {
        // Said at the first failure and about every half hour of them.
        if failed && self.journal.failures() % 4096 == 1 {
            self.console.tell(&Line::Trouble("no card, or it is full or broken: nothing is kept"));
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

/// Sampling periods between the last sample on the card and the first of the next part, if a
/// clock has run all the time.
fn lost_between(left_ms: Option<u64>, start_ms: Option<u64>) -> Option<u32> {
    periods(start_ms?.checked_sub(left_ms?)?).checked_sub(1)
}

fn config_error(error: floe_core::ConfigError) -> &'static str {
    use floe_core::ConfigError::{Calibration, Range, Rate, Slope, Std, Weight, Winch};
    match error {
        Rate => "the rate must be 1 to 2000 Hz",
        Weight => "set weight N first: the weight of the block",
        Slope => "the slope must be within 68 degrees",
        Winch => "the winch speed must be above zero, in m/s",
        Range => "the range must be above zero, in N",
        Calibration => "the span must not be zero",
        Std => "a standard deviation must not be below zero",
    }
}
