//! A guard below the stack, and how deep the stack was.

use core::ptr::read_volatile;

use cortex_m::peripheral::MPU;

/// Bytes below the RAM that nobody may touch; more than any function's frame. On
/// neither board is anything there that is needed.
const GUARD_LEN: u32 = 32 * 1024;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// From here on a stack that runs out of the RAM's lower end is a fault, which ends
/// in the fault's handler or in a lock-up; either way the board starts again.
pub fn guard(mpu: &MPU) {
    const SIZE: u32 = (GUARD_LEN.ilog2() - 1) << 1;
    const NEVER_EXECUTE: u32 = 1 << 28;
    const NO_ACCESS: u32 = 0 << 24;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP: u32 = 1 << 2;
    let below = &raw const _stack_end as u32 - GUARD_LEN;
    // SAFETY: region 0 covers what lies below the RAM, of which nothing is in use;
    // everything else stays as without the unit.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(below);
        mpu.rasr.write(NEVER_EXECUTE | NO_ACCESS | SIZE | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Whether there is room below a place in the stack for what an exception and a function's
/// beginning put there at most.
#[must_use]
pub fn has_room_below(place: *const u32) -> bool {
    /// With the floating-point registers, and those that a function keeps.
    const MOST: usize = 104 + 100;
    place as usize >= &raw const _stack_end as usize + MOST
}

/// Bytes of the stack that were ever used, and its size: the reset code has painted
/// it.
#[must_use]
pub fn used() -> (usize, usize) {
    let start = &raw const _stack_start;
    let end = &raw const _stack_end;
    let mut word = end;
    // SAFETY: from the linker script: the words from end to start are the stack.
    while word < start && unsafe { read_volatile(word) } == cortex_m_rt::STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    (start as usize - word as usize, start as usize - end as usize)
}
