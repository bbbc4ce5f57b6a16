//! Sampling tick, clock and delay.

use core::cell::{Cell, RefCell};
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Waker;

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SYST};
use critical_section::Mutex;
use embassy_stm32::pac::lptim::vals::Presc;
use embassy_stm32::pac::rcc::vals::{Lptim1sel, Lsedrv, Rtcsel};
use embassy_stm32::pac::{self, Interrupt, interrupt};
use embedded_hal::delay::DelayNs;

use crate::sampler::Tick;

/// Counts of TIM2 per second, 0.05 % less than a million. The oscillator makes 488 clocks per
/// period of the crystal to which it is locked (data sheet, MSI in PLL mode); TIM2 counts one of
/// 16.
pub const CLOCK_HZ: u32 = 488 * 32_768 / 16;

/// Clocks in a sampling period (16 Hz): of the crystal, and of the 16 MHz oscillator divided by 64.
const CRYSTAL_PERIODS: u16 = 2048;
const INTERNAL_PERIODS: u16 = 15_625;

/// Clock source of the sampling tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The 32 768 Hz crystal: 16 Hz exactly.
    Crystal,
    /// HSI16: 16 Hz to 2 % at -40 degrees (data sheet).
    Internal,
}

static LAST_TICK: AtomicU32 = AtomicU32::new(0);
static TICK: Mutex<RefCell<Option<&'static mut (dyn Tick + Send)>>> =
    Mutex::new(RefCell::new(None));

/// Starts the clock from the 16 MHz system clock.
pub(super) fn start() {
    pac::RCC.apb1enr1().modify(|w| w.set_tim2en(true));
    // The timer may be accessed after two clocks, which this read-back takes.
    pac::RCC.apb1enr1().read();
    pac::TIM2.psc().write_value(16 - 1);
    pac::TIM2.arr().write_value(u32::MAX);
    // An update event loads the prescaler.
    pac::TIM2.egr().write(|w| w.set_ug(true));
    pac::TIM2.cr1().modify(|w| w.set_cen(true));
}

/// Whether crystal and calendar have kept running through a reset.
pub(super) fn calendar_runs() -> bool {
    let backup = pac::RCC.bdcr().read();
    backup.lserdy() && backup.rtcen() && backup.rtcsel() == Rtcsel::LSE
}

/// Starts the crystal, which takes some time. SysTick wakes the processor every 10 ms until the
/// sampling tick starts, so that the main loop can check.
pub(super) fn start_crystal(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(16_000_000 / 100 - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
    if !pac::RCC.bdcr().read().lseon() {
        pac::PWR.cr1().modify(|w| w.set_dbp(true));
        while !pac::PWR.cr1().read().dbp() {}
        pac::RCC.bdcr().modify(|w| {
            w.set_lsedrv(Lsedrv::MEDIUM_HIGH);
            w.set_lseon(true);
        });
    }
}

/// Whether the crystal runs. If so, locks the system clock to it and starts the calendar.
#[must_use]
pub fn crystal_runs() -> bool {
    let backup = pac::RCC.bdcr().read();
    if !backup.lserdy() {
        return false;
    }
    if !backup.rtcen() {
        pac::RCC.bdcr().modify(|w| {
            w.set_rtcsel(Rtcsel::LSE);
            w.set_rtcen(true);
        });
    }
    pac::RCC.cr().modify(|w| w.set_msipllen(true));
    true
}

/// Counts of TIM2 since the start, about 1 us each ([`CLOCK_HZ`]), modulo 2³².
#[must_use]
pub fn clock() -> u32 {
    pac::TIM2.cnt().read()
}

/// Starts the sampling tick, 16 times a second from now on.
pub fn start_tick(tick: &'static mut (dyn Tick + Send), source: Source) {
    critical_section::with(|cs| *TICK.borrow_ref_mut(cs) = Some(tick));
    pac::RCC.apb1enr1().modify(|w| w.set_lptim1en(true));
    pac::RCC.apb1enr1().read();
    let timer = pac::LPTIM1;
    let periods = match source {
        Source::Crystal => CRYSTAL_PERIODS,
        Source::Internal => {
            pac::RCC.cr().modify(|w| w.set_hsion(true));
            while !pac::RCC.cr().read().hsirdy() {}
            pac::RCC.ccipr().modify(|w| w.set_lptim1sel(Lptim1sel::HSI));
            timer.cfgr().write(|w| w.set_presc(Presc::DIV64));
            INTERNAL_PERIODS
        }
    };
    // The interrupt must be enabled while the timer is off, and the period set while it is on
    // (RM0351, LPTIM).
    timer.ier().write(|w| w.set_arrmie(true));
    timer.cr().write(|w| w.set_enable(true));
    timer.arr().write(|w| w.set_arr(periods - 1));
    while !timer.isr().read().arrok() {}
    timer.cr().modify(|w| w.set_cntstrt(true));
    LAST_TICK.store(clock(), Ordering::Relaxed);
    // SAFETY: nothing else sets priorities or uses SysTick, which has woken the processor so far.
    // The handler below is in the vector table; the console's handler, which may interrupt it,
    // shares nothing with it.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        core.SYST.disable_counter();
        core.NVIC.set_priority(Interrupt::LPTIM1, TICK_PRIORITY);
        NVIC::unmask(Interrupt::LPTIM1);
    }
}

/// Priority of the tick, below the console's, which must fetch a character within 87 us.
const TICK_PRIORITY: u8 = 0x80;

#[interrupt]
fn LPTIM1() {
    pac::LPTIM1.icr().write(|w| w.set_arrmcf(true));
    let stamp = clock();
    LAST_TICK.store(stamp, Ordering::Relaxed);
    // SAFETY: from `start_tick` on only this interrupt borrows the tick, and it does not interrupt
    // itself.
    let cs = unsafe { critical_section::CriticalSection::new() };
    if let Some(tick) = TICK.borrow_ref_mut(cs).as_mut() {
        tick.tick(stamp);
    }
}

/// Microseconds since the newest tick.
#[must_use]
pub fn since_tick() -> u32 {
    // The tick is read first: a tick after this line would be later than the clock.
    let tick = LAST_TICK.load(Ordering::Relaxed);
    clock().wrapping_sub(tick)
}

/// Delay by polling the clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct Delay;

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        let start = clock();
        // One count more, because the first count may be nearly over.
        while clock().wrapping_sub(start) <= ns.div_ceil(1000) {}
    }
}

/// Clock for the time limits of embassy's drivers; no driver waits by it.
struct TimeDriver {
    high: Mutex<Cell<(u32, u32)>>,
}

embassy_time_driver::time_driver_impl!(static DRIVER: TimeDriver = TimeDriver {
    high: Mutex::new(Cell::new((0, 0))),
});

impl embassy_time_driver::Driver for TimeDriver {
    /// The tick calls this, so no wrap (71 minutes) is missed.
    fn now(&self) -> u64 {
        critical_section::with(|cs| {
            let low = clock();
            let (wraps, last) = self.high.borrow(cs).get();
            let wraps = wraps + u32::from(low < last);
            self.high.borrow(cs).set((wraps, low));
            u64::from(wraps) << 32 | u64::from(low)
        })
    }

    fn schedule_wake(&self, _: u64, _: &Waker) {}
}
