//! Stalls of the main loop: no sample is lost until the queue is full, then exactly those that do
//! not fit.

use floe_core::Pipeline;
use floe_firmware::app::App;
use floe_firmware::board::mps2::{self, CLOCK_HZ};
use floe_firmware::board::sleep_unless;
use floe_firmware::sample::{QUEUE_DEPTH, SampleQueue, Shared};
use floe_firmware::sampler::Sampler;
use static_cell::StaticCell;

use super::fake::{CheckedStore, SawAdc, Typed};

const TICK: u32 = CLOCK_HZ / 16;

type Logger = App<'static, Typed, CheckedStore>;

/// 1000 stalls of half a second at random, one of 3.9 s, one of 10 s.
#[inline(never)]
pub fn stalls() {
    static SHARED: Shared = Shared::new();
    static QUEUE: StaticCell<SampleQueue> = StaticCell::new();
    static PIPELINE: StaticCell<Option<Pipeline>> = StaticCell::new();
    static APP: StaticCell<Logger> = StaticCell::new();
    static SAMPLER: StaticCell<Sampler<'static, SawAdc>> = StaticCell::new();

    let (producer, consumer) = QUEUE.init_with(SampleQueue::new).split();
    let sampler = SAMPLER.init_with(|| Sampler::new(SawAdc::default(), producer, &SHARED));
    let typed = Typed(b"set weight 630\nset span 5000\nlive off\nstart\n");
    let store = CheckedStore::default();
    let pipeline = PIPELINE.init_with(|| None);
    let app = APP.init_with(|| App::new(consumer, &SHARED, pipeline, typed, store, CLOCK_HZ));
    app.turn();
    mps2::start_tick(sampler);

    let mut random = 1_u32;
    for _ in 0..1000 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        work(app, 1 + (random >> 28));
        stall(8);
    }
    work(app, 5);
    stall(62);
    work(app, 5);
    assert_eq!(SHARED.overruns(), 0);
    assert_eq!(counters(app), (0, SHARED.overruns()));

    stall(160);
    work(app, 40);
    let lost = 160 - QUEUE_DEPTH as u32;
    assert_eq!(SHARED.overruns(), lost);
    assert_eq!(counters(app), (lost, lost));
    assert_eq!(SHARED.deepest() as usize, QUEUE_DEPTH);

    let samples = app.view().health.samples;
    let store = app.store();
    assert_eq!((store.missing, store.overruns), (lost, lost));
    semihosting::println!(
        "queue of {QUEUE_DEPTH}: {samples} samples, 1000 stalls of 0.5 s and one of 3.9 s lost 0, \
         one of 10 s lost {lost}: counted, in the log, a gap for the estimator"
    );
}

/// Missing indices as the estimator sees them, and overruns.
fn counters(app: &Logger) -> (u32, u32) {
    let view = app.view();
    let report = view.report.expect("the test is running");
    (report.counters.missing, view.health.overruns)
}

/// Runs the main loop for a number of ticks, ending with an empty queue.
fn work(app: &mut Logger, ticks: u32) {
    for _ in 0..ticks {
        sleep_unless(|| app.has_samples());
        app.turn();
    }
}

/// Keeps the main loop from running for a number of ticks, like a busy card.
fn stall(ticks: u32) {
    let start = mps2::clock();
    while mps2::clock().wrapping_sub(start) < ticks * TICK - TICK / 2 {
        cortex_m::asm::wfi();
    }
}
