//! Data passed from the interrupt to the main loop.

use core::sync::atomic::{AtomicI32, AtomicU8, AtomicU32, Ordering};

use floe_core::{Counts, RawSample, Reading};
use heapless::spsc::{Consumer, Producer, Queue};

use crate::adc::{AdcFault, Climate, Input};

/// Samples per second. On the board a period is 2048 periods of a 32 768 Hz crystal.
pub const RATE_HZ: f32 = 16.0;

/// Number of samples that can wait while the main loop is busy: 95, or 5.9 s.
pub const QUEUE_DEPTH: usize = QUEUE_SLOTS - 1;
/// Slots of the queue, one of which always stays free.
const QUEUE_SLOTS: usize = 96;

/// The queue between the interrupt and the main loop.
pub type SampleQueue = Queue<Sample, QUEUE_SLOTS>;
/// The interrupt's end of the queue.
pub type SampleProducer<'q> = Producer<'q, Sample>;
/// The main loop's end of the queue.
pub type SampleConsumer<'q> = Consumer<'q, Sample>;

/// One sampling period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// Number of the sampling period since power-up.
    pub index: u32,
    /// Start of the conversion, in ticks of the board's clock.
    pub stamp: u32,
    /// What was measured.
    pub input: Input,
    /// The code, or the reason for none.
    pub reading: Result<Counts, AdcFault>,
}

impl Sample {
    /// The sample in the core's form, with its index counted from the first sample of a test.
    #[must_use]
    pub fn raw(&self, first_index: u32) -> RawSample {
        let index = self.index.wrapping_sub(first_index);
        RawSample { index, reading: self.reading.map_or_else(Reading::from, Reading::Counts) }
    }
}

/// State shared by interrupt and main loop besides the queue.
#[derive(Debug)]
pub struct Shared {
    ticks: AtomicU32,
    overruns: AtomicU32,
    deepest: AtomicU32,
    wanted: AtomicU8,
    temperature_256: AtomicI32,
    supply_mv: AtomicI32,
}

/// Stored for an unknown temperature or supply; no real value is as low.
const UNKNOWN: i32 = i32::MIN;

impl Default for Shared {
    fn default() -> Self {
        Self::new()
    }
}

impl Shared {
    /// Initial state: no sample lost, the bridge selected.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ticks: AtomicU32::new(0),
            overruns: AtomicU32::new(0),
            deepest: AtomicU32::new(0),
            wanted: AtomicU8::new(0),
            temperature_256: AtomicI32::new(UNKNOWN),
            supply_mv: AtomicI32::new(UNKNOWN),
        }
    }

    /// Ticks since power-up, modulo 2³².
    pub fn ticks(&self) -> u32 {
        self.ticks.load(Ordering::Relaxed)
    }

    /// Samples lost because the queue was full.
    pub fn overruns(&self) -> u32 {
        self.overruns.load(Ordering::Relaxed)
    }

    /// Largest number of samples that ever waited.
    pub fn deepest(&self) -> u32 {
        self.deepest.load(Ordering::Relaxed)
    }

    /// Requests another input; it takes effect within the next samples.
    pub fn want(&self, input: Input) {
        self.wanted.store(input as u8, Ordering::Relaxed);
    }

    /// Temperature and supply voltage of the converter.
    pub fn climate(&self) -> Climate {
        let known = |value: &AtomicI32| {
            Some(value.load(Ordering::Relaxed)).filter(|&value| value != UNKNOWN)
        };
        let (temperature_256, supply_mv) = (known(&self.temperature_256), known(&self.supply_mv));
        Climate { temperature_256, supply_mv }
    }

    pub(crate) fn set_climate(&self, climate: Climate) {
        let Climate { temperature_256, supply_mv } = climate;
        self.temperature_256.store(temperature_256.unwrap_or(UNKNOWN), Ordering::Relaxed);
        self.supply_mv.store(supply_mv.unwrap_or(UNKNOWN), Ordering::Relaxed);
    }

    pub(crate) fn wanted(&self) -> Input {
        const INPUTS: [Input; 4] =
            [Input::Bridge, Input::Shorted, Input::Temperature, Input::BurnOut];
        let wanted = self.wanted.load(Ordering::Relaxed);
        INPUTS.get(usize::from(wanted)).copied().unwrap_or_default()
    }

    pub(crate) fn count_tick(&self) {
        // No race: only the sampling interrupt writes.
        self.ticks.store(self.ticks().wrapping_add(1), Ordering::Relaxed);
    }

    pub(crate) fn count_overrun(&self) {
        // No race: only the sampling interrupt writes.
        self.overruns.store(self.overruns().wrapping_add(1), Ordering::Relaxed);
    }

    pub(crate) fn count_depth(&self, depth: usize) {
        let depth = u32::try_from(depth).unwrap_or(u32::MAX);
        self.deepest.store(self.deepest().max(depth), Ordering::Relaxed);
    }
}
