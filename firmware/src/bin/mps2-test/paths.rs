//! The same numbers as on a PC, and the ends that should never come.

use core::hint::black_box;

use floe_core::math;

/// Hashes every elementary function over its range; the PC prints the same.
#[inline(never)]
pub fn maths() {
    semihosting::println!("maths {:08x}", hash());
}

/// FNV-1a over the bits of the results, as in `xtask/src/target.rs`.
fn hash() -> u32 {
    let mut hash = 0x811C_9DC5_u32;
    let mut add = |x: f32| {
        for byte in x.to_bits().to_le_bytes() {
            hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    };
    for i in 0..4096_u16 {
        let x = f32::from(i) / 64.0 - 32.0;
        let (sin, cos) = math::sin_cos(x);
        add(sin);
        add(cos);
        add(math::atan2(x, 0.7));
        add(math::acos(x / 32.0));
        add(math::sqrt(x * x * 1000.0));
    }
    hash
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
