//! Comparisons with the PC, and the abnormal ends of a program.

use core::cmp::Ordering;
use core::hint::black_box;

use super::functions::FUNCTIONS;

/// Prints a hash of every elementary function over its range; the PC must find the same.
#[inline(never)]
pub fn maths() {
    for function in FUNCTIONS {
        semihosting::println!("{function} {:08x}", function.hash());
    }
}

/// Moves, copies, fills and compares bytes of every length at every offset in a word, and checks
/// the result.
pub fn bytes() {
    for length in 0..24 {
        for (from, to) in (0..64).map(|i| (i / 8, i % 8)) {
            let (from, to, length) = black_box((from, to, length));
            let start: [u8; 64] = core::array::from_fn(|i| i as u8 + 1);
            let (mut moved, mut copied, mut filled) = (start, start, start);
            moved.copy_within(from..from + length, to);
            copied[32 + to..][..length].copy_from_slice(&start[from..][..length]);
            filled[to..][..length].fill(0);
            for i in 0..64 {
                let came = |to: usize| (to..to + length).contains(&i).then(|| start[from + i - to]);
                assert_eq!(moved[i], came(to).unwrap_or(start[i]));
                assert_eq!(copied[i], came(32 + to).unwrap_or(start[i]));
                assert_eq!(filled[i], came(to).map_or(start[i], |_| 0));
            }
            let order = if length == 0 { Ordering::Equal } else { from.cmp(&to) };
            assert_eq!(start[from..][..length].cmp(&start[to..][..length]), order);
        }
    }
}

/// Must end with exit code 101.
pub fn panic() {
    panic!("deliberate");
}

/// Must end with exit code 102: no memory is at that address.
#[allow(unsafe_code)]
pub fn fault() {
    // SAFETY: it is not safe, and the emulated board has to notice.
    unsafe { core::ptr::read_volatile(0xE800_0000 as *const u32) };
}

/// Must be stopped at the end of the stack.
pub fn overflow() {
    semihosting::println!("{}", deeper(1));
}

#[inline(never)]
fn deeper(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    if depth == 0 { 0 } else { deeper(depth + 1).wrapping_add(black_box(frame)[7]) }
}
