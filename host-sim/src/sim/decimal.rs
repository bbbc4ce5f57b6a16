//! Fast formatting of numbers with a fixed number of decimals: the same bytes as `format!`, by
//! integer arithmetic where the rounding is certain.

/// Largest number of decimals for the fast path.
const MOST: usize = 12;
const POWERS: [f64; MOST + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12];

/// A number in units of its last decimal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fixed {
    units: u64,
    decimals: usize,
    negative: bool,
}

impl Fixed {
    /// The number; `None` where the value is too large, or so close to a tie in the last decimal
    /// that the rounding of the product could decide.
    pub(super) fn new(value: f64, decimals: usize) -> Option<Self> {
        // Below this value the rounding error of the product is less than half of `UNCLEAR`.
        const LARGEST: f64 = 4e12;
        const UNCLEAR: f64 = 1e-3;
        let scaled = value.abs() * POWERS.get(decimals)?;
        if scaled.is_nan() || scaled >= LARGEST {
            return None;
        }
        let whole = scaled as i64;
        let above = scaled - whole as f64;
        let clear = (above - 0.5).abs() > UNCLEAR;
        let units = whole as u64 + u64::from(above > 0.5);
        clear.then_some(Self { units, decimals, negative: value.is_sign_negative() })
    }

    /// The number without trailing zeros in its decimals.
    pub(super) fn trimmed(mut self) -> Self {
        while self.decimals > 1 && self.units.is_multiple_of(100) {
            self.units /= 100;
            self.decimals -= 2;
        }
        if self.decimals > 0 && self.units.is_multiple_of(10) {
            self.units /= 10;
            self.decimals -= 1;
        }
        self
    }
}

/// Bytes of the buffer: more than two numbers need.
const ROOM: usize = 64;

/// Text that is written from its end to its beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Backwards {
    bytes: [u8; ROOM],
    start: usize,
}

impl Backwards {
    pub(super) fn new() -> Self {
        Self { bytes: [0; ROOM], start: ROOM }
    }

    /// Writes a byte in front of the text.
    pub(super) fn push(&mut self, byte: u8) {
        self.push_all([byte]);
    }

    fn push_all<const N: usize>(&mut self, bytes: [u8; N]) {
        self.start -= N;
        if let Some(place) = self.bytes.get_mut(self.start..).and_then(<[u8]>::first_chunk_mut) {
            *place = bytes;
        }
    }

    /// Writes a number in front of the text, with at least one digit before the point.
    pub(super) fn push_fixed(&mut self, number: Fixed) {
        let Fixed { mut units, decimals, negative } = number;
        if decimals > 0 {
            (0..decimals / 2).for_each(|_| self.push_last_two(&mut units));
            if decimals % 2 == 1 {
                self.push_last(&mut units);
            }
            self.push(b'.');
        }
        while units >= 100 {
            self.push_last_two(&mut units);
        }
        self.push_last(&mut units);
        if units > 0 {
            self.push_last(&mut units);
        }
        if negative {
            self.push(b'-');
        }
    }

    fn push_last(&mut self, units: &mut u64) {
        self.push(b'0' + (*units % 10) as u8);
        *units /= 10;
    }

    /// Writes two digits, with a single division of the long number.
    fn push_last_two(&mut self, units: &mut u64) {
        let two = (*units % 100) as u8;
        *units /= 100;
        self.push_all([b'0' + two / 10, b'0' + two % 10]);
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(self.start..).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fixed(value: f64, decimals: usize) -> String {
        let Some(number) = Fixed::new(value, decimals) else {
            return format!("{value:.decimals$}");
        };
        let mut text = Backwards::new();
        text.push_fixed(number);
        String::from_utf8(text.bytes().to_vec()).unwrap()
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

    #[test]
    fn nearly_all_go_the_quick_way() {
        let quick = |value: &f64| Fixed::new(*value, 4).is_some();
        let values = (0..10_000).map(|i| f64::from(i).sqrt());
        assert!(values.filter(quick).count() > 9900);
    }

    #[test]
    fn zeros_at_the_end_go() {
        for (value, text) in [(0.0, "0"), (10.0, "10"), (0.0625, "0.0625"), (100.5, "100.5")] {
            let mut line = Backwards::new();
            line.push_fixed(Fixed::new(value, 6).unwrap().trimmed());
            assert_eq!(line.bytes(), text.as_bytes());
        }
    }

    proptest! {
        #[test]
        fn every_number_is_as_format_writes_it(value in -5e6..5e6_f64, decimals in 0..13_usize) {
            prop_assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
        }

        /// Ties, a 5 behind the last decimal: the exact value decides.
        #[test]
        fn near_a_half_too(units in 0..1_000_000_000_u64, decimals in 0..7_usize) {
            let value = (units as f64 + 0.5) / 10_f64.powi(decimals as i32);
            for value in [value, value.next_up(), value.next_down()] {
                prop_assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
            }
        }
    }
}
