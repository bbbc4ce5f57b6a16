//! A test is started while the converter still measures another input.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::io::Cursor;
use std::rc::Rc;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe::card;
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc, Input};
use floe_firmware::app::App;
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};
use floe_tests::scripted::Card;

/// Code of the load cell; other inputs read 0.
const CELL: i32 = 1_000_000;

/// A converter that switches its input at once.
#[derive(Default)]
struct Switched {
    running: Option<Input>,
    input: Input,
}

impl BridgeAdc for Switched {
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault> {
        let taken = self.running.replace(self.input);
        Ok(taken.map(|input| Counts(if input == Input::Bridge { CELL } else { 0 })))
    }

    fn select(&mut self, input: Input) -> bool {
        (self.input, self.running) = (input, None);
        true
    }
}

/// A console where a tick comes with each line end.
#[derive(Clone)]
struct Port<'q>(Rc<RefCell<Line<'q>>>);

struct Line<'q> {
    sampler: Sampler<'q, Switched>,
    typed: VecDeque<u8>,
    ticks: u32,
}

impl Line<'_> {
    fn tick(&mut self) {
        self.ticks += 1;
        self.sampler.tick(62_500 * self.ticks);
    }
}

impl ErrorType for Port<'_> {
    type Error = Infallible;
}

impl ReadReady for Port<'_> {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().typed.is_empty())
    }
}

impl Read for Port<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let mut line = self.0.borrow_mut();
        let Some(key) = line.typed.pop_front() else { return Ok(0) };
        if key == b'\n' {
            line.tick();
        }
        Ok(buffer.first_mut().map(|slot| *slot = key).into_iter().count())
    }
}

impl Write for Port<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

#[test]
fn a_test_has_no_sample_of_another_input() {
    let (shared, mut queue, mut pipeline) = (Shared::new(), SampleQueue::new(), None);
    let (producer, consumer) = queue.split();
    let sampler = Sampler::new(Switched::default(), producer, &shared);
    let line = Line { sampler, typed: VecDeque::new(), ticks: 0 };
    let port = Port(Rc::new(RefCell::new(line)));
    let store = Card::default();
    let mut app =
        App::new(consumer, &shared, &mut pipeline, port.clone(), store.clone(), 1_000_000);
    app.power_up(None);
    let type_in = |keys: &[u8]| port.0.borrow_mut().typed.extend(keys);
    type_in(b"set weight 630\nself-test\n");
    for _ in 0..8 {
        app.turn();
        port.0.borrow_mut().tick();
    }
    app.turn();
    type_in(b"start\n");
    for _ in 0..30 {
        app.turn();
        port.0.borrow_mut().tick();
    }
    type_in(b"stop\n");
    app.turn();
    app.turn();
    let bytes = store.bytes.borrow().clone();
    let (tests, _) = card::tests(Cursor::new(bytes)).expect("readable");
    let [test] = tests.as_slice() else { panic!("{} tests", tests.len()) };
    assert!(test.samples.len() > 20);
    let others = test.samples.iter().filter(|sample| sample.reading != Ok(Counts(CELL)));
    assert_eq!(others.count(), 0, "{:?}", test.samples.first());
}
