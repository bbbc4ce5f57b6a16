//! Permitted values of a key, in a comment of a log and in a cell of `tests.csv`.

use floe_firmware::notebook::{Kind, Track};

use super::number::{STANDARD_GRAVITY, finite, is_grouped};
use crate::error::excerpt;

/// The number of a key.
///
/// # Errors
/// The text is no number, or an impossible one; the message contains the remedy.
pub fn number(key: &str, text: &str) -> Result<f64, String> {
    // A leading comma separates cells, and one before three digits may separate thousands: neither
    // is a decimal mark.
    let other_comma = text.starts_with(',') || text.contains(',') && is_grouped(text.as_bytes());
    let number = finite(text.as_bytes()).filter(|_| !other_comma);
    let has = |what: &str| format!("has {}: {what}", excerpt(text.as_bytes()));
    let number = number.ok_or_else(|| has("write the number alone"))?;
    match key {
        "snow_mm" if number < 0.0 => Err(has("write the depth in mm, 0 for no snow")),
        "cable_length_m" if number <= 0.0 => Err(has("write the length in m, above zero")),
        "tare_counts" if number.abs() > f64::from(i32::MAX) => {
            Err(has("write the converter's code at zero force, of 32 bits at most"))
        }
        _ => Ok(number),
    }
}

/// The word of `kind` or `track`, ignoring case.
///
/// # Errors
/// Another word; the message contains the permitted ones.
pub fn word(key: &str, text: &str) -> Result<String, String> {
    let words: Vec<&str> = match key {
        "kind" => Kind::ALL.iter().map(|(_, word)| *word).collect(),
        _ => Track::ALL.iter().map(|(_, word)| *word).collect(),
    };
    let same = words.iter().find(|word| word.eq_ignore_ascii_case(text));
    same.map(|word| (*word).to_string()).ok_or_else(|| {
        let said = excerpt(text.as_bytes());
        format!("has {said}: write one of {}, or leave it out", words.join(", "))
    })
}

/// The weight of a mass, N, if it differs from the stated one by more than variations of gravity.
#[must_use]
pub fn other_weight_n(weight_n: f64, mass_kg: f64) -> Option<f64> {
    const DIFFERS: f64 = 0.005;
    let of_mass_n = mass_kg * STANDARD_GRAVITY;
    ((of_mass_n - weight_n).abs() > DIFFERS * weight_n.abs()).then_some(of_mass_n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_refused_with_what_to_write() {
        let refused = |key, text| number(key, text).unwrap_err();
        assert_eq!(refused("snow_mm", "-4"), "has '-4': write the depth in mm, 0 for no snow");
        assert_eq!(refused("cable_length_m", "0"), "has '0': write the length in m, above zero");
        assert_eq!(refused("weight_n", "nan"), "has 'nan': write the number alone");
        assert!(refused("tare_counts", "3e9").starts_with("has '3e9': write the converter's code"));
        assert_eq!(number("snow_mm", "0"), Ok(0.0));
        assert_eq!(number("winch_m_per_s", "0,0157"), Ok(0.0157));
    }

    #[test]
    fn words_are_those_of_the_logger() {
        assert_eq!(word("kind", "Over-Riding").as_deref(), Ok("over-riding"));
        assert_eq!(word("track", "fresh").as_deref(), Ok("fresh"));
        let refused = "has 'foo': write one of sliding, rafting, over-riding, or leave it out";
        assert_eq!(word("kind", "foo"), Err(refused.to_string()));
    }
}
