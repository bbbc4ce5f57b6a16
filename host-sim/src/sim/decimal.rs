//! Numbers with a fixed number of decimals, quickly: the bytes that `format!` writes, by
//! way of a whole number where the rounding is clear.

/// Largest number of decimals that goes the quick way.
const MOST: usize = 12;
const POWERS: [f64; MOST + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12];

/// Appends `value` with `decimals` decimals.
pub fn push_fixed(text: &mut Vec<u8>, value: f64, decimals: usize) {
    let Some(units) = units(value, decimals) else {
        text.extend_from_slice(format!("{value:.decimals$}").as_bytes());
        return;
    };
    if value.is_sign_negative() {
        text.push(b'-');
    }
    push_units(text, units, decimals);
}

/// `value` in units of its last decimal; `None` where it is too large or so near to a half
/// that the product's own rounding could decide.
fn units(value: f64, decimals: usize) -> Option<u64> {
    // Up to here the product is wrong by less than half of what is unclear.
    const LARGEST: f64 = 4e12;
    const UNCLEAR: f64 = 1e-3;
    let scaled = value.abs() * POWERS.get(decimals)?;
    let whole = scaled as u64;
    let above = scaled - whole as f64;
    let clear = (above - 0.5).abs() > UNCLEAR;
    (clear && scaled < LARGEST).then(|| whole + u64::from(above > 0.5))
}

/// From the last digit on: the decimals, the point, at least one digit before it.
fn push_units(text: &mut Vec<u8>, mut units: u64, decimals: usize) {
    let mut bytes = [b'.'; 32];
    let point = if decimals > 0 { decimals } else { usize::MAX };
    let least = decimals + usize::from(decimals > 0);
    let mut length = 0;
    for byte in bytes.iter_mut().rev() {
        if length > least && units == 0 {
            break;
        }
        if length != point {
            *byte = b'0' + (units % 10) as u8;
            units /= 10;
        }
        length += 1;
    }
    text.extend_from_slice(bytes.get(bytes.len() - length..).unwrap_or_default());
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fixed(value: f64, decimals: usize) -> String {
        let mut text = Vec::new();
        push_fixed(&mut text, value, decimals);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn halves_signs_and_what_is_no_number_are_as_format_writes_them() {
        let small = [0.0, -0.0, 0.5, 1.5, 2.5, -0.00001, 0.125];
        let large = [199_999.937_5, 3.999_999_999_999e6, 1e10, 1e300, f64::NAN, -f64::INFINITY];
        for value in small.into_iter().chain(large) {
            for decimals in [0, 1, 2, 4, 6, 12, 15] {
                assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
            }
        }
    }

    proptest! {
        #[test]
        fn every_number_is_as_format_writes_it(value in -5e6..5e6_f64, decimals in 0..13_usize) {
            prop_assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
        }

        /// Ends in a 5 behind the last decimal: the exact value decides.
        #[test]
        fn near_a_half_too(units in 0..1_000_000_000_u64, decimals in 0..7_usize) {
            let value = (units as f64 + 0.5) / 10_f64.powi(decimals as i32);
            for value in [value, value.next_up(), value.next_down()] {
                prop_assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
            }
        }
    }
}
