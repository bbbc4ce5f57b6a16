//! Execution of the commands typed on the console.

use super::{App, Job};
use crate::command::{Command, HELP, NEGATIVE, Setting};
use crate::console::Typed;
use crate::line::Line;
use crate::settings::Settings;
use crate::store::Store;
use embedded_io::{Read, ReadReady, Write};

impl<P: Read + ReadReady + Write, S: Store> App<'_, P, S> {
    // Not inlined: all commands need its stack.
    #[inline(never)]
    pub(super) fn obey(&mut self, typed: &Typed) {
        let command = match typed {
            Typed::TooLong => Err("that is too long"),
            Typed::Line(line) => Command::parse(line),
        };
        let done = command.and_then(|command| self.execute(command));
        if let Err(reason) = done {
            self.console.trouble(reason);
        }
    }

    #[inline(never)]
    fn execute(&mut self, command: Command<'_>) -> Result<(), &'static str> {
        match command {
            Command::Status => self.status(),
            Command::Live(live) => self.live = live,
            Command::Help => self.info(HELP),
            Command::Stop => self.stop()?,
            Command::Note(words) => self.note(words)?,
            Command::Winch(winch) => self.mark_winch(winch)?,
            Command::Clock(moment) => self.set_clock(moment)?,
            _ if self.testing() => return Err("a test is running; stop ends it"),
            // A measurement is computed with the settings that it began with.
            Command::Start | Command::Set(_) if matches!(self.job, Job::Measuring(_)) => {
                return Err("accept or abort?");
            }
            Command::Start => self.start()?,
            Command::Measure(task) => self.measure(task)?,
            Command::Accept => self.accept()?,
            Command::Abort => self.abort(),
            Command::SelfTest => self.begin_self_test(),
            Command::Set(setting) => self.set(setting)?,
        }
        Ok(())
    }

    // Not inlined: settings are large and on the stack while they change.
    #[inline(never)]
    fn set(&mut self, setting: Setting) -> Result<(), &'static str> {
        let settings = self.settings.with(setting).map_err(config_error)?;
        self.change(settings);
        Ok(())
    }

    pub(super) fn change(&mut self, settings: Settings) {
        self.settings = settings;
        self.is_set = true;
        self.journal.remember(&self.settings);
        self.say_settings();
    }

    pub(super) fn abort(&mut self) {
        self.shared.want(crate::adc::Input::Bridge);
        self.job = Job::Idle;
        self.info("aborted");
    }

    /// Answers on the console only: the card has these data already, and displays ask often.
    #[inline(never)]
    fn status(&mut self) {
        self.say_settings();
        if let Some(report) = self.report() {
            self.console.tell(&Line::Report(report));
        }
        self.console.tell(&Line::Health(self.health()));
    }
}

pub(super) fn config_error(error: floe_core::ConfigError) -> &'static str {
    use floe_core::ConfigError::{Calibration, Range, Rate, Slope, Std, Weight, Winch};
    match error {
        Rate => "rate: 1 to 2000 Hz",
        Weight => "set weight N, above 0",
        Slope => "slope: 68 degrees at most",
        Winch => "set winch m/s, above 0",
        Range => "set range N, above 0",
        Calibration => "the span is zero",
        Std => NEGATIVE,
    }
}
