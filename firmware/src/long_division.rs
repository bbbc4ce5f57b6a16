//! Division of 64 by 16 bits. The processor has no instruction for it, and the library's routine
//! takes 1 kB of flash.

/// Quotient and remainder; a divisor of zero counts as one.
///
/// ```
/// assert_eq!(floe_firmware::long_division::divide(1_000_000_000_000_007, 10), (100_000_000_000_000, 7));
/// ```
#[must_use]
pub fn divide(number: u64, by: u16) -> (u64, u16) {
    let by = u32::from(by.max(1));
    let (mut quotient, mut rest) = (0, 0);
    // Long division with digits of 16 bits.
    for shift in [48, 32, 16, 0] {
        let digit = u32::from((number >> shift) as u16);
        let part = rest << 16 | digit;
        quotient = quotient << 16 | u64::from(part / by);
        rest = part % by;
    }
    (quotient, rest as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_division() {
        let mut number = 1_u64;
        for by in (1..=u16::MAX).step_by(13) {
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            for number in [0, u64::from(by), number >> 40, number, u64::MAX] {
                let expected = (number / u64::from(by), (number % u64::from(by)) as u16);
                assert_eq!(divide(number, by), expected, "{number} {by}");
            }
        }
        assert_eq!(divide(7, 0), (7, 0));
    }
}
