//! Accuracy of the sampling tick, and sleep without a lost wake-up.

use core::sync::atomic::{AtomicU32, Ordering};

use floe_firmware::board::mps2::{self, CLOCK_HZ};
use floe_firmware::board::sleep_unless;
use floe_firmware::sampler::Tick;
use static_cell::StaticCell;

static TICKS: AtomicU32 = AtomicU32::new(0);
static LAST: AtomicU32 = AtomicU32::new(0);
static WORST: AtomicU32 = AtomicU32::new(0);

/// Counts ticks and keeps the largest deviation of their interval.
struct Counter;

impl Tick for Counter {
    fn tick(&mut self, stamp: u32) {
        let count = TICKS.fetch_add(1, Ordering::Relaxed);
        let distance = stamp.wrapping_sub(LAST.swap(stamp, Ordering::Relaxed));
        if count > 0 {
            WORST.fetch_max(distance.abs_diff(CLOCK_HZ / 16), Ordering::Relaxed);
        }
    }
}

fn start() {
    static COUNTER: StaticCell<Counter> = StaticCell::new();
    mps2::start_tick(COUNTER.init(Counter));
}

/// Checks that a thousand ticks are 62.5 ms apart, within the few instructions that may delay the
/// interrupt.
#[inline(never)]
pub fn tick_is_exact() {
    start();
    while TICKS.load(Ordering::Relaxed) < 1000 {
        sleep_unless(|| false);
    }
    let worst = WORST.load(Ordering::Relaxed);
    semihosting::println!("1000 ticks of 1562500: {worst} off at worst");
    assert!(worst <= 2, "{worst} ticks of 40 ns off");
}

/// Checks that every tick wakes the main loop once, wherever the loop is at that moment. The time
/// awake grows through a whole period, and no tick may be missed.
#[inline(never)]
pub fn no_wake_up_is_lost() {
    const ROUNDS: u32 = 500;
    start();
    let mut seen = 0;
    for round in 0..ROUNDS {
        sleep_unless(|| TICKS.load(Ordering::Relaxed) > seen);
        let ticks = TICKS.load(Ordering::Relaxed);
        assert!(ticks > seen, "woken without a tick in round {round}");
        assert!(ticks - seen <= 2, "slept through {} ticks in round {round}", ticks - seen - 1);
        seen = ticks;
        // Busy for 0 to 1.1 periods, so that the test for work coincides with the interrupt.
        let busy = (CLOCK_HZ / 16) / 1000 * (round * 11 / 5);
        let start = mps2::clock();
        while mps2::clock().wrapping_sub(start) < busy {}
    }
    semihosting::println!("{ROUNDS} rounds, {seen} ticks, none slept through");
}
