//! The boards: pins, clocks, peripherals. All `unsafe` code is here.
#![allow(unsafe_code)]

mod bytes;

#[cfg(any(feature = "mps2-an386", feature = "nucleo-l476"))]
pub mod stack;

#[cfg(feature = "mps2-an386")]
pub mod mps2;
#[cfg(feature = "nucleo-l476")]
pub mod nucleo;

/// Sleeps until an interrupt unless `busy` reports work. `busy` is called with interrupts off, so
/// no wake-up is lost: a pending interrupt ends the sleep even then.
#[cfg(any(feature = "mps2-an386", feature = "nucleo-l476"))]
pub fn sleep_unless(busy: impl FnOnce() -> bool) {
    cortex_m::interrupt::disable();
    if !busy() {
        cortex_m::asm::wfi();
    }
    // SAFETY: interrupts were enabled before.
    unsafe { cortex_m::interrupt::enable() };
}
