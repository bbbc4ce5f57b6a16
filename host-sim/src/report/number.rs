//! Numbers for people: significant digits and suitable units.

/// `x` with a fixed number of decimals and a real minus sign.
pub(super) fn fixed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
}

/// Decimals that give `digits` significant digits, 0 to 9.
pub(super) fn decimals_for(x: f64, digits: i32) -> usize {
    if x == 0.0 || !x.is_finite() {
        return 0;
    }
    (digits - 1 - x.abs().log10().floor() as i32).clamp(0, 9) as usize
}

/// `x` with four significant digits.
pub(super) fn significant(x: f64) -> String {
    fixed(x, decimals_for(x, 4))
}

/// Decimals of a value whose standard error is `error`: two digits of the error.
pub(super) fn decimals_of_error(error: Option<f64>) -> usize {
    error.filter(|&e| e > 0.0).map_or(4, |e| decimals_for(e, 2))
}

/// A count, in groups of three digits.
pub(super) fn count(n: u64) -> String {
    let digits = n.to_string();
    let group = |(i, digit): (usize, char)| {
        let gap = i > 0 && digits.len() > 4 && (digits.len() - i).is_multiple_of(3);
        gap.then_some('\u{202f}').into_iter().chain([digit])
    };
    digits.char_indices().flat_map(group).collect()
}

/// A unit with an SI prefix that keeps its numbers short.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// Factor from the base unit to this one.
    pub factor: f64,
    /// Prefix and base unit.
    pub name: String,
}

impl Unit {
    /// The unit for values of up to `largest` in the unit `base`.
    pub fn suited(largest: f64, base: &str) -> Self {
        let (factor, prefix) = match largest.abs() {
            x if x >= 2e6 => (1e-6, "M"),
            x if x >= 2e3 => (1e-3, "k"),
            x if x >= 0.5 || x == 0.0 => (1.0, ""),
            x if x >= 5e-4 => (1e3, "m"),
            _ => (1e6, "µ"),
        };
        Self { factor, name: format!("{prefix}{base}") }
    }
}

/// A value with its unit, four significant digits.
pub(super) fn quantity(x: f64, base: &str) -> String {
    let unit = Unit::suited(x, base);
    format!("{} {}", significant(x * unit.factor), unit.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(fixed(-0.001, 1), "0.0");
        assert_eq!(significant(361.09), "361.1");
        assert_eq!(significant(0.001234567), "0.001235");
        assert_eq!(significant(0.0), "0");
        assert_eq!(count(1920), "1920");
        assert_eq!(count(1234567), "1\u{202f}234\u{202f}567");
        assert_eq!(quantity(23000.0, "N/m"), "23.00 kN/m");
        assert_eq!(quantity(0.0841, "N"), "84.10 mN");
        assert_eq!(decimals_of_error(Some(0.00021)), 5);
        assert_eq!(decimals_of_error(None), 4);
    }
}
