//! What the processor has of elementary functions: one instruction.

/// Square root by `vsqrt`.
///
/// Written out because the compiler offers no stable way to it without std.
#[unsafe(naked)]
#[allow(unsafe_code)] // SAFETY: argument and result in s0, no other register, no memory.
pub extern "C" fn vsqrt(x: f32) -> f32 {
    core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
}

/// Square root, correctly rounded.
pub fn sqrt(x: f32) -> f32 {
    vsqrt(x)
}
