//! The sampling interrupt, which never waits for the main loop.

use crate::adc::{AdcFault, BridgeAdc, Input};
use crate::sample::{Sample, SampleProducer, Shared};

/// Handler that a board's tick interrupt calls.
pub trait Tick {
    /// Handles the start of a sampling period at `stamp` ticks of the board's clock.
    fn tick(&mut self, stamp: u32);
}

/// Owner of the converter and of the queue's input end.
#[expect(missing_debug_implementations, reason = "the queue has none")]
pub struct Sampler<'q, A> {
    adc: A,
    queue: SampleProducer<'q>,
    shared: &'q Shared,
    next_index: u32,
    running: Option<Running>,
    input: Input,
}

/// Sampling periods between two requests for temperature or supply: half a minute.
const CLIMATE_PERIODS: u32 = 480;
/// Period of the first request, a second after power-up; its result is known one period later.
const CLIMATE_AT: u32 = 16;
const CLIMATE_KNOWN: u32 = 17;

/// The conversion in progress.
#[derive(Clone, Copy, Debug)]
struct Running {
    index: u32,
    stamp: u32,
    input: Input,
}

impl<'q, A: BridgeAdc> Sampler<'q, A> {
    /// Measures the bridge from the first tick on.
    pub fn new(adc: A, queue: SampleProducer<'q>, shared: &'q Shared) -> Self {
        Self { adc, queue, shared, next_index: 0, running: None, input: Input::Bridge }
    }

    /// Requests temperature and supply alternately, each once a minute.
    fn ask_for_climate(&mut self) {
        match self.next_index % CLIMATE_PERIODS {
            CLIMATE_AT => self.adc.want_climate(),
            CLIMATE_KNOWN => self.shared.set_climate(self.adc.climate()),
            _ => {}
        }
    }

    /// Switches the input if requested. The conversion in progress is discarded without a sample or
    /// fault.
    fn change_input(&mut self) {
        let wanted = self.shared.wanted();
        if wanted != self.input && self.adc.select(wanted) {
            self.input = wanted;
            self.running = None;
        }
    }
}

/// Checks that main loop and tick are alive: the main loop asks whether the tick has come.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pulse(u32);

impl Pulse {
    /// Whether the tick has come since the previous call. A watchdog fed only if so resets the
    /// board when either of the two hangs.
    pub fn beats(&mut self, shared: &Shared) -> bool {
        let before = core::mem::replace(&mut self.0, shared.ticks());
        before != self.0
    }
}

impl<A: BridgeAdc> Tick for Sampler<'_, A> {
    /// Puts the sample of the previous period into the queue. If the queue is full, the sample is
    /// lost and counted, and its index stays missing.
    fn tick(&mut self, stamp: u32) {
        self.shared.count_tick();
        self.change_input();
        self.ask_for_climate();
        let taken = self.adc.tick();
        if let Some(Running { index, stamp, input }) = self.running {
            let reading = taken.and_then(|code| code.ok_or(AdcFault::NotReady));
            let sample = Sample { index, stamp, input, reading };
            if self.queue.enqueue(sample).is_err() {
                self.shared.count_overrun();
            }
            self.shared.count_depth(self.queue.len());
        }
        let (index, input) = (self.next_index, self.input);
        self.running = Some(Running { index, stamp, input });
        self.next_index = index.wrapping_add(1);
    }
}
