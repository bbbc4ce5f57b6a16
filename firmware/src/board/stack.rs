//! A guard region below the stack, and the largest use of the stack.

use core::ptr::read_volatile;

use cortex_m::peripheral::MPU;

/// Size of the guard below the RAM, bytes: more than any function's frame. No memory in use is
/// there on either board.
const GUARD_LEN: u32 = 32 * 1024;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Makes any access below the RAM a fault, so a stack overflow ends in the fault handler or a
/// lock-up; the board restarts in both cases.
pub fn guard(mpu: &MPU) {
    const SIZE: u32 = (GUARD_LEN.ilog2() - 1) << 1;
    const NEVER_EXECUTE: u32 = 1 << 28;
    const NO_ACCESS: u32 = 0 << 24;
    const ENABLE: u32 = 1;
    const DEFAULT_MAP: u32 = 1 << 2;
    let below = &raw const _stack_end as u32 - GUARD_LEN;
    // SAFETY: region 0 covers addresses below the RAM, none of which is in use; all others keep
    // their default access.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(below);
        mpu.rasr.write(NEVER_EXECUTE | NO_ACCESS | SIZE | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Whether the stack below `place` has room for the largest exception frame and function prologue.
#[must_use]
pub fn has_room_below(place: *const u32) -> bool {
    /// Bytes of a frame with floating-point registers (104), and of those that a function saves.
    const MOST: usize = 104 + 100;
    place as usize >= &raw const _stack_end as usize + MOST
}

/// Largest number of bytes of the stack in use since the reset, which painted it, and its size.
#[must_use]
pub fn used() -> (usize, usize) {
    let start = &raw const _stack_start;
    let end = &raw const _stack_end;
    let mut word = end;
    // SAFETY: by the linker script the words from end to start are the stack.
    while word < start && unsafe { read_volatile(word) } == cortex_m_rt::STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    (start as usize - word as usize, start as usize - end as usize)
}
