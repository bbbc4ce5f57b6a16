//! The same numbers as on a PC, and the ends that should never come.

use core::hint::black_box;

use super::functions::FUNCTIONS;

/// Hashes every elementary function over its range; the PC finds the same.
#[inline(never)]
pub fn maths() {
    for function in FUNCTIONS {
        semihosting::println!("{function} {:08x}", function.hash());
    }
}

/// Has to end with exit code 101.
pub fn panic() {
    panic!("deliberate");
}

/// Has to end with exit code 102: nothing is at that address.
#[allow(unsafe_code)]
pub fn fault() {
    // SAFETY: it is not safe, and the emulated board has to notice.
    unsafe { core::ptr::read_volatile(0xE800_0000 as *const u32) };
}

/// Has to be stopped at the end of the stack.
pub fn overflow() {
    semihosting::println!("{}", deeper(1));
}

#[inline(never)]
fn deeper(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    if depth == 0 { 0 } else { deeper(depth + 1).wrapping_add(black_box(frame)[7]) }
}
