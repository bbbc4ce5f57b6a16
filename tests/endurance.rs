//! The application over long times, and with arbitrary console input.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc};
use floe_firmware::app::App;
use floe_firmware::line::Line;
use floe_firmware::record::{Record, Sector};
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};
use floe_firmware::settings::Settings;
use floe_firmware::store::{NoStore, Store, StoreError};
use floe_tests::board::{Board, last_settings, lines, with_board};
use floe_tests::fuzz::Dice;
use floe_tests::number;
use floe_tests::records::stick_slip;

/// A card of unlimited size that checks its sectors and keeps the last one.
#[derive(Clone, Default)]
struct Checker(Rc<RefCell<Checked>>);

#[derive(Default)]
struct Checked {
    sectors: u32,
    samples: u64,
    next_index: Option<u32>,
    gaps: u64,
    last: Option<Sector>,
}

impl Store for Checker {
    fn last(&mut self) -> Option<Record> {
        self.0.borrow().last.and_then(|sector| Record::decode(&sector).ok())
    }

    fn next_sector(&self) -> u32 {
        self.0.borrow().sectors
    }

    fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
        let record = Record::decode(sector).expect("a sector that can be read back");
        let mut checked = self.0.borrow_mut();
        for sample in &record.samples {
            checked.gaps += u64::from(checked.next_index.is_some_and(|next| next != sample.index));
            checked.next_index = Some(sample.index.wrapping_add(1));
            checked.samples += 1;
        }
        checked.sectors += 1;
        checked.last = Some(*sector);
        Ok(())
    }
}

/// Largest memory use of this process so far, kB.
fn high_water() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

const BEGIN: &[u8] = b"set weight 630\nset span 5000\nlive off\nstart\n";

/// Runs for `FLOE_DAYS` days, else an hour.
#[test]
fn nothing_is_lost_however_long() {
    let days = number("FLOE_DAYS", 1.0 / 24.0);
    let ticks = (days * 86_400.0 * 16.0) as u64;
    let (store, codes) = (Checker::default(), stick_slip(3200));
    let (events, health, early) = with_board(store.clone(), &codes, |board| {
        board.type_in(BEGIN);
        let (mut events, mut early) = (0, 0);
        for tick in 0..ticks {
            board.tick();
            if tick % 16_000 == 0 || tick + 1 == ticks {
                let said = board.said();
                events += lines(&said).filter(|line| matches!(line, Line::Event(_))).count();
            }
            if tick == ticks / 10 {
                early = high_water();
            }
        }
        (events, board.view().health, early)
    });
    let checked = store.0.borrow();
    let grown = high_water().saturating_sub(early);
    assert!(early > 0 || !cfg!(target_os = "linux"), "the memory in use is not known");
    println!(
        "{days:.3} days: {} samples, {} of them on the card, {} lost, at most {} waiting, {} \
         sectors, {events} events, {grown} kB more memory than after a tenth of the time",
        health.samples, checked.samples, health.overruns, health.deepest, checked.sectors
    );
    assert_eq!((u64::from(health.samples), health.overruns, checked.gaps), (ticks - 1, 0, 0));
    assert!(checked.samples + 8 > ticks - 1 && health.deepest <= 1 && grown < 2048);
    assert!(events as f64 > 0.9 * ticks as f64 / 32.0);
}

/// The settings as the board reports them.
fn settings<S: Store>(board: &mut Board<'_, '_, S>) -> Settings {
    let _ = board.said();
    board.type_in(b"\nstatus\n");
    last_settings(&board.said())
}

/// Random bytes during a test lose no sample and set nothing.
#[test]
fn noise_on_the_console_changes_no_test() {
    let bytes = number("FLOE_NOISE_BYTES", 1e6) as usize;
    let (store, codes) = (Checker::default(), stick_slip(3200));
    with_board(store.clone(), &codes, |board| {
        board.type_in(BEGIN);
        board.tick();
        let before = settings(board);
        let mut dice = Dice::new(1);
        let ticks = bytes / 100;
        for tick in 0..ticks {
            let noise = dice.bytes(100);
            board.type_in(&noise);
            board.tick();
            if tick % 100 == 0 {
                let said = board.said();
                assert!(!lines(&said).any(|line| matches!(line, Line::End { .. })), "{said}");
            }
        }
        assert_eq!(settings(board), before);
        let health = board.view().health;
        assert_eq!((health.samples as usize, health.overruns), (ticks, 0));
    });
    assert_eq!(store.0.borrow().gaps, 0);
    println!("{bytes} random bytes: no sample lost, nothing set");
}

struct Still;

impl BridgeAdc for Still {
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault> {
        Ok(Some(Counts(0)))
    }
}

/// A wire that connects the board's output to its input, so that all output is typed; the tick
/// continues meanwhile.
#[derive(Clone)]
struct Echo<'q>(Rc<RefCell<Wire<'q>>>);

struct Wire<'q> {
    sampler: Sampler<'q, Still>,
    typed: VecDeque<u8>,
    said: u32,
}

impl Wire<'_> {
    /// Characters per sampling period at 115 200 baud.
    const A_PERIOD: u32 = 720;
    /// Number of characters after which the wire is cut: 20 s.
    const MOST: u32 = 320 * Self::A_PERIOD;
    /// Room of the NUCLEO's input buffer, characters.
    const ROOM: usize = 128;

    fn say(&mut self, byte: u8) {
        self.said += 1;
        if self.said.is_multiple_of(Self::A_PERIOD) {
            self.sampler.tick(self.said);
        }
        if self.said < Self::MOST && self.typed.len() < Self::ROOM {
            self.typed.push_back(byte);
        }
    }
}

impl ErrorType for Echo<'_> {
    type Error = Infallible;
}

impl ReadReady for Echo<'_> {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().typed.is_empty())
    }
}

impl Read for Echo<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let typed = self.0.borrow_mut().typed.pop_front();
        Ok(buffer.iter_mut().zip(typed).map(|(slot, byte)| *slot = byte).count())
    }
}

impl Write for Echo<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        bytes.iter().for_each(|&byte| self.0.borrow_mut().say(byte));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Each answer is typed as input and answered again.
#[test]
fn a_board_that_hears_itself_loses_no_sample() {
    let (shared, mut queue, mut pipeline) = (Shared::new(), SampleQueue::new(), None);
    let (producer, consumer) = queue.split();
    let sampler = Sampler::new(Still, producer, &shared);
    let wire = Rc::new(RefCell::new(Wire { sampler, typed: VecDeque::new(), said: 0 }));
    let port = Echo(wire.clone());
    let mut app = App::new(consumer, &shared, &mut pipeline, port, NoStore, 1_000_000);
    app.power_up(None);
    while wire.borrow().said < Wire::MOST {
        app.turn();
    }
    assert_eq!((shared.overruns(), shared.deepest()), (0, 1));
}

/// A random well-formed command.
fn command(dice: &mut Dice) -> String {
    let number = dice.below(2_000_000) as f32 / 1000.0 - 100.0;
    let what = *dice.pick(&["weight", "slope", "winch", "range", "span", "name", "nonsense"]);
    match dice.below(12) {
        0 => "status".to_string(),
        1 => format!("live {}", dice.pick(&["on", "off", "maybe"])),
        2 => format!("set tare {}", dice.below(1 << 24) as i32 - (1 << 23)),
        3 => "help".to_string(),
        4 => "abort".to_string(),
        5 => "accept".to_string(),
        6 => (*dice.pick(&["start", "stop", "start test"])).to_string(),
        _ => format!("set {what} {number}"),
    }
}

/// Random well-formed lines: every change of a setting is reported, and every reported change
/// happens.
#[test]
fn no_setting_changes_without_being_said() {
    let count = number("FLOE_LINES", 1e4) as usize;
    let (store, codes) = (Checker::default(), stick_slip(3200));
    let (mut changed, mut refused) = (0, 0);
    with_board(store.clone(), &codes, |board| {
        let mut dice = Dice::new(2);
        let mut known = settings(board);
        for _ in 0..count {
            let typed = command(&mut dice);
            board.type_in(format!("{typed}\n").as_bytes());
            board.tick();
            let said = board.said();
            refused += lines(&said).filter(|line| matches!(line, Line::Trouble(_))).count();
            let told = lines(&said).filter_map(|line| {
                if let Line::Start { settings, .. } = line { Some(settings) } else { None }
            });
            let told = told.last().unwrap_or_else(|| known.clone());
            changed += usize::from(told != known);
            assert_eq!(settings(board), told, "{typed}: {said}");
            known = told;
        }
        let health = board.view().health;
        assert_eq!((health.samples as usize, health.overruns), (count - 1, 0));
    });
    println!("{count} lines: {changed} changes, each said; {refused} refused; no sample lost");
    assert!(changed > count / 10 && refused > count / 10);
    // The last sector on the card is a readable record.
    let last = store.0.borrow().last.map(|sector| Record::decode(&sector).expect("a record"));
    assert!(last.is_some());
}

/// `FLOE_DAMAGES` damaged sectors of several kinds: none is accepted as a record.
#[test]
fn no_damage_is_taken_for_a_record() {
    let count = number("FLOE_DAMAGES", 1e5) as usize;
    let (store, codes) = (Checker::default(), stick_slip(3200));
    with_board(store.clone(), &codes, |board| {
        board.type_in(BEGIN);
        (0..64).for_each(|_| board.tick());
    });
    let sector = store.0.borrow().last.expect("a sector");
    let mut dice = Dice::new(3);
    let (mut other, mut damaged) = (sector, 0);
    for number in 0..count {
        let from = dice.below(512);
        match number % 3 {
            // Flipped bits at random positions.
            0 => (0..=dice.below(20)).for_each(|_| other[dice.below(512)] ^= 1 << dice.below(8)),
            // A burst of noise.
            1 => other[from..]
                .iter_mut()
                .take(1 + dice.below(64))
                .for_each(|b| *b = dice.bits() as u8),
            // A torn write: the end is zero or erased.
            _ => other[from..].fill(*dice.pick(&[0, 0xFF])),
        }
        if other != sector {
            assert!(Record::decode(&other).is_err(), "damage {number}");
            damaged += 1;
        }
        other = sector;
    }
    println!("{damaged} of {count} random damages change the sector: none accepted");
    assert!(damaged * 10 > count * 9, "{damaged} of {count}");
}
