//! Instruction counts from the emulator: run with `-icount shift=8`, where an instruction takes 256
//! ns of the clock's 40 ns ticks.

use core::hint::black_box;

use floe_core::{Config, Counts, Pipeline, RawSample, Reading};
use floe_firmware::board::mps2;
use floe_firmware::line::Line;
use floe_firmware::record::Record;
use floe_firmware::sample::{SampleQueue, Shared};
use floe_firmware::sampler::{Sampler, Tick};

use static_cell::StaticCell;

use super::fake::SawAdc;
use super::functions::{EMPTY, FUNCTIONS};

/// Instructions of a call, minus those of an empty call.
fn count<T>(job: impl FnOnce() -> T) -> u32 {
    ticks(job).saturating_sub(ticks(|| ()))
}

fn ticks<T>(job: impl FnOnce() -> T) -> u32 {
    let start = mps2::clock();
    black_box(job());
    (mps2::clock().wrapping_sub(start) * 40).div_ceil(256)
}

/// Prints one line per job: name, mean, worst.
#[inline(never)]
pub fn run() {
    step();
    sampler();
    lines();
    show("record", |_| (), |()| black_box(Record::default()).encode(), 4);
}

/// Counts every elementary function through the same kind of call.
#[inline(never)]
pub fn functions() {
    const ROUNDS: u32 = 256;
    for function in FUNCTIONS.iter().chain([&EMPTY]) {
        let argument = |i| function.argument(i, ROUNDS - 1);
        show(function, argument, black_box(function.call), ROUNDS);
    }
}

fn new_pipeline() -> Pipeline {
    let mut config = Config { weight_n: 630.0, ..Config::default() };
    config.calibration.counts_per_n = 5000.0;
    Pipeline::new(&config).expect("a valid configuration")
}

/// Counts the pipeline's steps over a minute of stick and slip.
#[inline(never)]
fn step() {
    static PIPELINE: StaticCell<Pipeline> = StaticCell::new();
    let pipeline = PIPELINE.init_with(new_pipeline);
    let sample = |i: u32| RawSample { index: i, reading: Reading::Counts(Counts(SawAdc::code(i))) };
    show("step", sample, |sample| pipeline.step(sample), 1920);
    show("report", |_| (), |()| pipeline.report(), 4);
}

/// Counts the sampling interrupt without a bus.
#[inline(never)]
fn sampler() {
    static SHARED: Shared = Shared::new();
    static QUEUE: StaticCell<SampleQueue> = StaticCell::new();
    let (producer, _consumer) = QUEUE.init_with(SampleQueue::new).split();
    let mut sampler = Sampler::new(SawAdc::default(), producer, &SHARED);
    show("sampler", |i| i, |i| sampler.tick(i), 64);
}

/// Counts the conversion of a sample and of an event to text.
#[inline(never)]
fn lines() {
    static PIPELINE: StaticCell<Pipeline> = StaticCell::new();
    let pipeline = PIPELINE.init_with(new_pipeline);
    let mut event = None;
    let mut i = 0;
    while event.is_none() && i < 1000 {
        let reading = Reading::Counts(Counts(SawAdc::code(i)));
        event = pipeline.step(RawSample { index: i, reading }).event;
        i += 1;
    }
    let event = event.expect("an event within a minute");
    show("event-line", |_| (), |()| Line::Event(event).to_text(), 4);
    let live = floe_firmware::line::LiveSample {
        index: 12_345,
        force_n: Some(612.345_6),
        flag: floe_core::SampleFlag::Good,
        phase: floe_core::Phase::Stick,
        gap: 0,
        rate_n_per_s: Some(361.125),
    };
    show("sample-line", |_| (), |()| Line::Sample(live).to_text(), 4);
}

fn show<I, T>(
    name: impl core::fmt::Display,
    input: impl Fn(u32) -> I,
    mut job: impl FnMut(I) -> T,
    rounds: u32,
) {
    let (mut sum, mut worst) = (0_u64, 0);
    for i in 0..rounds {
        let input = input(i);
        let instructions = count(|| job(black_box(input)));
        sum += u64::from(instructions);
        worst = worst.max(instructions);
    }
    semihosting::println!("count {name} {} {worst}", sum / u64::from(rounds));
}
