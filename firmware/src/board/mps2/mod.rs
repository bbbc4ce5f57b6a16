//! Arm MPS2 with image AN386: a Cortex-M4F board that QEMU emulates, used for tests.
//!
//! Timer 0 is the sampling tick, timer 1 the clock. Converter, console and card are files of the
//! emulator's host, see [`files`]; in real time UART 0 is a second console.

mod crash;
pub mod files;
pub mod uart;

use core::cell::RefCell;
use core::ptr::{read_volatile, write_volatile};

use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use embedded_hal::delay::DelayNs;

use super::stack;
use crate::sampler::Tick;

/// Both timers count at the processor's 25 MHz.
pub const CLOCK_HZ: u32 = 25_000_000;
/// Periods of the clock in a sampling period: 16 Hz exactly.
const TICK_PERIODS: u32 = CLOCK_HZ / 16;

/// APB timers of the CMSDK: control, value (down), reload, interrupt.
const TIMER0: usize = 0x4000_0000;
const TIMER1: usize = 0x4000_1000;
const CTRL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
const INT_CLEAR: usize = 0xC;
const ENABLE: u32 = 1 << 0;
const INTERRUPT: u32 = 1 << 3;

/// Number of an interrupt.
#[derive(Clone, Copy)]
struct Line(u16);

impl Line {
    const UART0_RX: Self = Self(0);
    const TIMER0: Self = Self(8);
}

// SAFETY: both constants above are this board's interrupt numbers, and no others exist.
unsafe impl cortex_m::interrupt::InterruptNumber for Line {
    fn number(self) -> u16 {
        self.0
    }
}

/// An entry of the vector table.
pub type Vector = unsafe extern "C" fn();

unsafe extern "C" {
    fn DefaultHandler();
}

/// The board's part of the vector table.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 32] = {
    let mut table: [Vector; 32] = [DefaultHandler; 32];
    table[0] = uart::on_receive;
    table[8] = on_timer0;
    table
};

static TICK: Mutex<RefCell<Option<&'static mut (dyn Tick + Send)>>> =
    Mutex::new(RefCell::new(None));

unsafe extern "C" fn on_timer0() {
    write(TIMER0 + INT_CLEAR, 1);
    let stamp = clock();
    critical_section::with(|cs| {
        if let Some(tick) = TICK.borrow_ref_mut(cs).as_mut() {
            tick.tick(stamp);
        }
    });
}

/// Starts the clock and the guard below the stack. Call it once, before anything else.
///
/// # Panics
/// On the second call.
pub fn start() {
    let peripherals = cortex_m::Peripherals::take().expect("started twice");
    stack::guard(&peripherals.MPU);
    write(TIMER1 + RELOAD, u32::MAX);
    write(TIMER1 + VALUE, u32::MAX);
    write(TIMER1 + CTRL, ENABLE);
}

/// Ticks of the clock since its start, modulo 2³².
#[must_use]
pub fn clock() -> u32 {
    !read(TIMER1 + VALUE)
}

/// Starts the sampling tick, 16 times a second from now on.
pub fn start_tick(tick: &'static mut (dyn Tick + Send)) {
    critical_section::with(|cs| *TICK.borrow_ref_mut(cs) = Some(tick));
    write(TIMER0 + RELOAD, TICK_PERIODS - 1);
    write(TIMER0 + VALUE, TICK_PERIODS - 1);
    write(TIMER0 + CTRL, ENABLE | INTERRUPT);
    // SAFETY: the handler above is in the vector table.
    unsafe { NVIC::unmask(Line::TIMER0) };
}

/// Delay by polling the clock.
#[derive(Clone, Copy, Debug, Default)]
pub struct Delay;

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        const TICK_NS: u32 = 1_000_000_000 / CLOCK_HZ;
        let start = clock();
        while clock().wrapping_sub(start) < ns.div_ceil(TICK_NS) {}
    }
}

/// Prints the largest use of the stack and ends the emulation with an exit code.
pub fn finish(code: i32) -> ! {
    let (used, size) = stack::used();
    semihosting::eprintln!("stack {used} of {size} bytes");
    semihosting::process::exit(code)
}

fn read(register: usize) -> u32 {
    // SAFETY: callers name registers of this board's timers and UART only.
    unsafe { read_volatile(register as *const u32) }
}

fn write(register: usize, value: u32) {
    // SAFETY: callers name registers of this board's timers and UART only.
    unsafe { write_volatile(register as *mut u32, value) }
}
