//! Recognizes lines that resemble a key of the metadata.

use super::number::finite;

/// Beginning of such a line, and correct key and value; longer beginnings come first.
const MEANT: [(&str, &str, &str); 13] = [
    ("weight_std", "weight_std_n", "2"),
    ("slope_std", "slope_std_deg", "0.2"),
    ("zero_std", "zero_std_n", "0.5"),
    ("span_std", "span_std_percent", "0.1"),
    ("damping", "damping_std", "0.005"),
    ("winch_std", "winch_std_m_per_s", "0.0002"),
    ("zero_after", "zero_after_n", "1.2"),
    ("weight_kg", "mass_kg", "64.2"),
    ("weight", "weight_n", "630"),
    ("mass", "mass_kg", "64.2"),
    ("slope", "slope_deg", "1.5"),
    ("winch", "winch_m_per_s", "0.0157"),
    ("zero", "zero_before_n", "1.2"),
];

/// Correct key and value for a line, if a key was meant and a number follows.
#[must_use]
pub fn meant(text: &str, is_key: impl FnOnce(&str) -> bool) -> Option<(String, String)> {
    let cut = |marks: &[char]| text.split_once(marks);
    let (key, value) =
        cut(&[':', '=', ',', ';', '\t']).or_else(|| cut(&[' '])).unwrap_or((text, ""));
    let (key, value) = (key.trim().to_ascii_lowercase().replace([' ', '-'], "_"), value.trim());
    if !value.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    let is_key = is_key(&key);
    let meant = MEANT.iter().find(|(start, ..)| key.starts_with(start));
    match meant.filter(|_| !is_key || finite(value.as_bytes()).is_none()) {
        Some((_, key, value)) => Some(((*key).to_string(), (*value).to_string())),
        None => is_key.then(|| (key, value.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use crate::log::metadata::Metadata;

    /// The proposed line has the meaning of the original, not another one.
    #[test]
    fn how_well_it_is_known_is_not_what_it_is() {
        for (line, write) in [
            ("# weight_std: 3", "weight_std_n: 2"),
            ("# Slope std: 0.5", "slope_std_deg: 0.2"),
            ("# zero_std: 1", "zero_std_n: 0.5"),
            ("# span_std: 0.4", "span_std_percent: 0.1"),
            ("# damping: 0.01", "damping_std: 0.005"),
            ("# winch_std: 2", "winch_std_m_per_s: 0.0002"),
            ("# zero_after: 3", "zero_after_n: 1.2"),
            ("# weight-n: 700", "weight_n: 700"),
            ("# weight_kg: 64", "mass_kg: 64.2"),
        ] {
            let mut metadata = Metadata::default();
            metadata.take(line.as_bytes(), 1).unwrap();
            let note = &metadata.notes.first().expect(line).text;
            assert!(note.ends_with(&format!("is not read: write '# {write}'")), "{note}");
        }
    }
}
