//! The whole logger on a PC with scripted input: converter model, sampler, application, card.

use std::cell::RefCell;
use std::rc::Rc;

use floe::chip::{Clock, LoadCell, Schedule, SerialChip, SerialLine};
use floe_core::Event;
use floe_firmware::ads122::{Ads122, SerialBus};
use floe_firmware::app::{App, View};
use floe_firmware::line::Line;
use floe_firmware::record::{Record, SECTOR_LEN, Sector};
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};
use floe_firmware::settings::Settings;
use floe_firmware::store::{Store, StoreError};

use crate::board;
use crate::terminal::Terminal;

/// A card that is kept when the board is dropped, and can refuse to write.
#[derive(Clone, Debug, Default)]
pub struct Card {
    /// The written sectors.
    pub bytes: Rc<RefCell<Vec<u8>>>,
    /// Whether the card refuses to write.
    pub broken: Rc<RefCell<bool>>,
}

impl Store for Card {
    fn last(&mut self) -> Option<Record> {
        let bytes = self.bytes.borrow();
        let sector: &Sector = bytes.rchunks_exact(SECTOR_LEN).next()?.try_into().ok()?;
        Record::decode(sector).ok()
    }

    fn next_sector(&self) -> u32 {
        (self.bytes.borrow().len() / SECTOR_LEN) as u32
    }

    fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
        if *self.broken.borrow() {
            return Err(StoreError::Write);
        }
        self.bytes.borrow_mut().extend(sector);
        Ok(())
    }
}

/// Runs the logger; each text of the script is typed before the tick of its number.
pub fn run(cell: LoadCell, trouble: Schedule, card: &Card, script: &[(u64, &str)]) -> Session {
    let clock = Clock::default();
    let chip = Rc::new(RefCell::new(SerialChip::new(cell, trouble, 86_806)));
    let line = SerialLine::new(chip.clone(), clock.clone());
    let adc = Ads122::new(SerialBus::new(line, clock.clone()), clock.clone());
    let terminal = Terminal::default();
    let (shared, mut queue) = (Shared::new(), SampleQueue::new());
    let (producer, consumer) = queue.split();
    let mut sampler = Sampler::new(adc, producer, &shared);
    let mut pipeline = None;
    let (port, store) = (terminal.clone(), card.clone());
    let mut app = App::new(consumer, &shared, &mut pipeline, port, store, 1_000_000);
    app.power_up(None);
    let (mut screen, mut typed, mut views) = (String::new(), Vec::new(), Vec::new());
    let last = script.iter().map(|&(tick, _)| tick).max().unwrap_or(0);
    for tick in 0..=last {
        for (_, text) in script.iter().filter(|&&(at, _)| at == tick) {
            typed.push((screen.len(), text.to_string()));
            terminal.type_in(text.as_bytes());
        }
        app.turn();
        app.tend();
        views.push(app.view());
        clock.wait_until((tick + 1) * 62_500_000);
        sampler.tick((clock.now_ns() / 1000) as u32);
        screen += &terminal.said();
    }
    app.turn();
    screen += &terminal.said();
    let delivered = chip.borrow().device().delivered().to_vec();
    Session { screen, delivered, typed, views }
}

/// Results of a run.
#[derive(Debug)]
pub struct Session {
    /// Output of the console.
    pub screen: String,
    /// Codes that the converter delivered.
    pub delivered: Vec<(u64, i32)>,
    /// Typed texts, each with the length of the output before it.
    pub typed: Vec<(usize, String)>,
    /// Values for the display before each tick.
    pub views: Vec<View>,
}

impl Session {
    /// All lines of the output.
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        board::lines(&self.screen)
    }

    /// The last settings of the output.
    ///
    /// # Panics
    /// There are none.
    #[must_use]
    pub fn last_settings(&self) -> Settings {
        board::last_settings(&self.screen)
    }

    /// All events of the output.
    pub fn events(&self) -> Vec<Event> {
        let event = |line| if let Line::Event(event) = line { Some(event) } else { None };
        self.lines().filter_map(event).collect()
    }

    /// Whether the output contains these words.
    pub fn says(&self, words: &str) -> bool {
        self.screen.contains(words)
    }
}
