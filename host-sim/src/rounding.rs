//! Numbers as text for people: digits that fit an uncertainty, and counts.

/// Relative uncertainties below this are printed as zero.
pub const LEAST: f64 = 1e-7;

/// Decimals that show four significant digits of a number of this size.
#[must_use]
pub fn decimals(size: f64) -> usize {
    let size = size.abs();
    if size > 0.0 { (3.0 - size.log10().floor()).clamp(0.0, 8.0) as usize } else { 0 }
}

/// A count with its noun: `1 event`, `2 events`.
#[must_use]
pub fn counted(count: impl Into<u64>, thing: &str) -> String {
    let count = count.into();
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// A decimal number without the zeros at its end.
#[must_use]
pub fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A number with at most six decimals and no trailing zeros.
#[must_use]
pub fn significant(value: f64) -> String {
    trimmed(&format!("{value:.6}")).to_string()
}

/// A number as it was given; in scientific form where it would have hundreds of digits.
#[must_use]
pub fn short(value: f64) -> String {
    let is_short = value == 0.0 || (1e-9..1e9).contains(&value.abs());
    if is_short { value.to_string() } else { format!("{value:e}") }
}

/// Decimals that show two significant digits of an uncertainty.
#[must_use]
pub fn digits(std: f64) -> usize {
    if std < LEAST { 0 } else { (1.0 - std.log10().floor()).clamp(0.0, 8.0) as usize }
}

/// A value with two digits of its uncertainty: `1.2401 ± 0.0035`.
#[must_use]
pub fn plus_minus(value: f64, std: f64) -> String {
    if std < LEAST * value.abs().max(f64::MIN_POSITIVE) {
        return format!("{value:.*} ± 0", decimals(value));
    }
    let decimals = digits(std);
    format!("{value:.decimals$} ± {std:.decimals$}")
}

/// A value with its uncertainty as by [`plus_minus`], or `± ?` where that is not known.
#[must_use]
pub fn plus_minus_known(value: f64, std: Option<f64>) -> String {
    let unknown = || format!("{value:.*} ± ?", decimals(value));
    std.map_or_else(unknown, |std| plus_minus(value, std))
}

/// An uncertainty with two significant digits.
#[must_use]
pub fn own_digits(std: f64) -> String {
    if std < LEAST { "0".to_string() } else { format!("{std:.*}", digits(std)) }
}

/// A part of an uncertainty; a part far below the whole is printed as less than a power of ten that
/// is at most a hundredth of the whole.
#[must_use]
pub fn part_of(part: f64, whole: f64) -> String {
    let exponent = (0.01 * whole).log10().floor().min(0.0);
    let limit = 10_f64.powf(exponent);
    if part < LEAST * whole.max(LEAST) || part >= limit {
        return own_digits(part);
    }
    format!("<{limit:.*}", -exponent as usize)
}

/// An uncertainty with four decimals; a positive one is never printed as zero.
#[must_use]
pub fn narrow(std: f64) -> String {
    if std > 0.0 && std < 5e-5 { "<0.0001".to_string() } else { format!("{std:.4}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_of_its_uncertainty() {
        assert_eq!(plus_minus(1.240_13, 0.003_52), "1.2401 ± 0.0035");
        assert_eq!(plus_minus(22_942.3, 292.0), "22942 ± 292");
        assert_eq!(plus_minus(0.779, 0.000_234), "0.77900 ± 0.00023");
        assert_eq!(plus_minus(15.0, 0.0), "15.00 ± 0");
        assert_eq!(plus_minus(0.0, 0.0), "0 ± 0");
    }

    #[test]
    fn things_are_counted() {
        assert_eq!([0_u32, 1, 2].map(|n| counted(n, "test")), ["0 tests", "1 test", "2 tests"]);
    }

    #[test]
    fn a_part_that_does_not_count_says_only_that() {
        assert_eq!(part_of(0.0035, 0.0035), "0.0035");
        assert_eq!(part_of(0.000_38, 0.0035), "0.00038");
        assert_eq!(part_of(2.2e-7, 0.0035), "<0.00001");
        assert_eq!(part_of(2.2e-7, 0.000_35), "<0.000001");
        assert_eq!(part_of(0.0, 0.0035), "0");
        assert_eq!(part_of(0.4, 120.0), "<1");
        for whole in [0.001, 0.0031, 0.01, 0.3, 1.0] {
            let text = part_of(0.000_99 * whole, whole);
            let limit: f64 = text.strip_prefix('<').unwrap().parse().unwrap();
            assert!((0.000_99..0.010_01).contains(&(limit / whole)), "{whole}: {text}");
            // The printed limit is not below the part.
            assert_ne!(part_of(1.01 * limit, whole), text);
        }
    }

    #[test]
    fn no_uncertainty_reads_as_none() {
        assert_eq!((narrow(0.0), narrow(2e-6)), ("0.0000".to_string(), "<0.0001".to_string()));
        assert_eq!(narrow(0.000_51), "0.0005");
    }
}
