//! The sampling interrupt: never waits for anybody.

use crate::adc::{AdcFault, BridgeAdc, Input};
use crate::sample::{Sample, SampleProducer, Shared};

/// What a board's tick interrupt calls.
pub trait Tick {
    /// One sampling period has begun, at `stamp` ticks of the board's clock.
    fn tick(&mut self, stamp: u32);
}

/// Owns the converter and the queue's entrance.
#[expect(missing_debug_implementations, reason = "the queue has none")]
pub struct Sampler<'q, A> {
    adc: A,
    queue: SampleProducer<'q>,
    shared: &'q Shared,
    next_index: u32,
    running: Option<Running>,
    input: Input,
}

/// Half a minute.
const CLIMATE_PERIODS: u32 = 480;
/// First a second after power-up, and known with the tick after.
const CLIMATE_AT: u32 = 16;
const CLIMATE_KNOWN: u32 = 17;

/// The conversion that is going on.
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

    /// Temperature and supply in turn, each once a minute.
    fn ask_for_climate(&mut self) {
        match self.next_index % CLIMATE_PERIODS {
            CLIMATE_AT => self.adc.want_climate(),
            CLIMATE_KNOWN => self.shared.set_climate(self.adc.climate()),
            _ => {}
        }
    }

    /// The conversion that is going on is given up: no sample, and no fault.
    fn change_input(&mut self) {
        let wanted = self.shared.wanted();
        if wanted != self.input && self.adc.select(wanted) {
            self.input = wanted;
            self.running = None;
        }
    }
}

/// Tells whether both ends of the queue live: who asks is the main loop, and what it
/// looks for is the tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pulse(u32);

impl Pulse {
    /// Whether the tick has come since this was last asked. A watchdog that is fed only
    /// then starts the board again whichever of the two hangs.
    pub fn beats(&mut self, shared: &Shared) -> bool {
        let before = core::mem::replace(&mut self.0, shared.ticks());
        before != self.0
    }
}

impl<A: BridgeAdc> Tick for Sampler<'_, A> {
    /// The sample of the period before goes into the queue. If that is full, the
    /// sample is lost and counted, and its index is missing for ever after.
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
