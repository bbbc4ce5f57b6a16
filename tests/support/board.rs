//! The whole logger on a PC: converter model, sampler, application, card, a script.
#![allow(dead_code, missing_docs, reason = "each test uses a part of it")]

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe::chip::{Clock, LoadCell, Schedule, SerialChip, SerialLine};
use floe_core::Event;
use floe_firmware::ads122::{Ads122, SerialBus};
use floe_firmware::app::{App, View};
use floe_firmware::line::Line;
use floe_firmware::record::{Record, SECTOR_LEN, Sector};
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};
use floe_firmware::store::{Store, StoreError};

/// What was typed and what was said.
#[derive(Clone, Default)]
pub struct Terminal {
    keys: Rc<RefCell<VecDeque<u8>>>,
    screen: Rc<RefCell<Vec<u8>>>,
}

impl ErrorType for Terminal {
    type Error = Infallible;
}

impl ReadReady for Terminal {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.keys.borrow().is_empty())
    }
}

impl Read for Terminal {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        buffer[0] = self.keys.borrow_mut().pop_front().unwrap_or(0);
        Ok(1)
    }
}

impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.screen.borrow_mut().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A card that outlives the board, and may refuse.
#[derive(Clone, Default)]
pub struct Card {
    pub bytes: Rc<RefCell<Vec<u8>>>,
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

/// Runs the board with a script: what is typed before the tick of a number.
pub fn run(cell: LoadCell, trouble: Schedule, card: &Card, script: &[(u64, &str)]) -> Board {
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
    let (mut typed, mut views) = (Vec::new(), Vec::new());
    let last = script.iter().map(|&(tick, _)| tick).max().unwrap_or(0);
    for tick in 0..=last {
        for (_, text) in script.iter().filter(|&&(at, _)| at == tick) {
            typed.push((terminal.screen.borrow().len(), text.to_string()));
            terminal.keys.borrow_mut().extend(text.bytes());
        }
        app.turn();
        views.push(app.view());
        clock.wait_until((tick + 1) * 62_500_000);
        sampler.tick((clock.now_ns() / 1000) as u32);
    }
    app.turn();
    let screen = String::from_utf8(terminal.screen.borrow().clone()).expect("text");
    let delivered = chip.borrow().device().delivered().to_vec();
    Board { screen, delivered, typed, views }
}

/// What came of it.
pub struct Board {
    /// All that was said.
    pub screen: String,
    /// Codes that the converter gave.
    pub delivered: Vec<(u64, i32)>,
    /// What was typed, and how much had been said before.
    pub typed: Vec<(usize, String)>,
    /// What the display showed before each tick.
    pub views: Vec<View>,
}

impl Board {
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        self.screen.lines().map(|text| Line::parse(text).expect(text))
    }

    pub fn events(&self) -> Vec<Event> {
        let event = |line| if let Line::Event(event) = line { Some(event) } else { None };
        self.lines().filter_map(event).collect()
    }

    pub fn says(&self, words: &str) -> bool {
        self.screen.contains(words)
    }
}
