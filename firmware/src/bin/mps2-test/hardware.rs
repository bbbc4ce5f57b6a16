//! Elementary functions of the processor: the square root instruction.

/// Square root by `vsqrt`.
///
/// In assembly, because stable Rust offers no access to the instruction without std.
#[unsafe(naked)]
#[allow(unsafe_code)] // SAFETY: argument and result in s0, no other register, no memory.
pub extern "C" fn vsqrt(x: f32) -> f32 {
    core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
}

/// Square root, correctly rounded.
pub fn sqrt(x: f32) -> f32 {
    vsqrt(x)
}
