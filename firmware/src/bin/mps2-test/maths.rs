//! The elementary functions on many arguments, as one number. On the board and on
//! the PC (`cargo xtask test` takes in this very file) it has to be the same.

use floe_core::math;

/// FNV-1a over the bits of the results.
#[inline(never)]
pub fn hash() -> u32 {
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
