//! The application on this PC, with a converter that replays codes, a console, and a store chosen
//! by the test.

use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc};
use floe_firmware::app::{App, View};
use floe_firmware::line::Line;
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};
use floe_firmware::settings::Settings;
use floe_firmware::store::Store;

use crate::terminal::Terminal;

/// A converter that repeats a list of codes: sample `i` has code `i` modulo the list's length.
#[derive(Debug)]
struct Codes<'a> {
    codes: &'a [i32],
    next: usize,
}

impl BridgeAdc for Codes<'_> {
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault> {
        let before = self.next.checked_sub(1);
        self.next += 1;
        Ok(before.map(|at| Counts(self.codes[at % self.codes.len()])))
    }
}

/// A board that is switched on.
#[expect(missing_debug_implementations, reason = "the application has none")]
pub struct Board<'q, 'c, S> {
    sampler: Sampler<'q, Codes<'c>>,
    app: App<'q, Terminal, S>,
    terminal: Terminal,
    ticks: u32,
}

impl<S: Store> Board<'_, '_, S> {
    /// Runs a sampling period: the tick and the main loop.
    pub fn tick(&mut self) {
        self.sampler.tick(self.ticks.wrapping_mul(62_500));
        self.ticks = self.ticks.wrapping_add(1);
        self.app.turn();
        self.app.tend();
    }

    /// Types keys and lets the board read them.
    pub fn type_in(&mut self, keys: &[u8]) {
        self.terminal.type_in(keys);
        self.app.turn();
    }

    /// Output since the previous call.
    pub fn said(&mut self) -> String {
        self.terminal.said()
    }

    /// Values for the display.
    pub fn view(&self) -> View {
        self.app.view()
    }
}

/// Switches a board on and runs a function with it.
pub fn with_board<S: Store, T>(
    store: S,
    codes: &[i32],
    use_it: impl FnOnce(&mut Board<'_, '_, S>) -> T,
) -> T {
    let (shared, mut queue, mut pipeline) = (Shared::new(), SampleQueue::new(), None);
    let (producer, consumer) = queue.split();
    let sampler = Sampler::new(Codes { codes, next: 0 }, producer, &shared);
    let terminal = Terminal::default();
    let port = terminal.clone();
    let mut app = App::new(consumer, &shared, &mut pipeline, port, store, 1_000_000);
    app.power_up(None);
    use_it(&mut Board { sampler, app, terminal, ticks: 0 })
}

/// The last settings in a text.
///
/// # Panics
/// There are none.
#[must_use]
pub fn last_settings(said: &str) -> Settings {
    let settings =
        |line| if let Line::Start { settings, .. } = line { Some(settings) } else { None };
    lines(said).filter_map(settings).last().expect("settings")
}

/// All lines in a text.
pub fn lines(said: &str) -> impl Iterator<Item = Line<'_>> {
    said.lines().map(|text| Line::parse(text).unwrap_or_else(|error| panic!("{text}: {error}")))
}
