//! Numbers and words three rows high, readable from two steps away.

/// Rows of a large number.
pub const ROWS: usize = 3;

/// Five rows of pixels, from the upper left; `#` is lit. Two pixel rows make a row of characters.
const GLYPHS: [(char, [&str; 5]); 32] = [
    ('0', ["###", "# #", "# #", "# #", "###"]),
    ('1', [" # ", "## ", " # ", " # ", "###"]),
    ('2', ["###", "  #", "###", "#  ", "###"]),
    ('3', ["###", "  #", "###", "  #", "###"]),
    ('4', ["# #", "# #", "###", "  #", "  #"]),
    ('5', ["###", "#  ", "###", "  #", "###"]),
    ('6', ["###", "#  ", "###", "# #", "###"]),
    ('7', ["###", "  #", "  #", "  #", "  #"]),
    ('8', ["###", "# #", "###", "# #", "###"]),
    ('9', ["###", "# #", "###", "  #", "###"]),
    ('.', [" ", " ", " ", " ", "#"]),
    ('-', ["   ", "   ", "###", "   ", "   "]),
    ('A', ["###", "# #", "###", "# #", "# #"]),
    ('C', ["###", "#  ", "#  ", "#  ", "###"]),
    ('D', ["## ", "# #", "# #", "# #", "## "]),
    ('E', ["###", "#  ", "###", "#  ", "###"]),
    ('F', ["###", "#  ", "###", "#  ", "#  "]),
    ('G', ["###", "#  ", "# #", "# #", "###"]),
    ('H', ["# #", "# #", "###", "# #", "# #"]),
    ('I', ["#", "#", "#", "#", "#"]),
    ('K', ["# #", "## ", "#  ", "## ", "# #"]),
    ('L', ["#  ", "#  ", "#  ", "#  ", "###"]),
    ('N', ["#  #", "## #", "# ##", "#  #", "#  #"]),
    ('O', ["###", "# #", "# #", "# #", "###"]),
    ('P', ["###", "# #", "###", "#  ", "#  "]),
    ('R', ["###", "# #", "## ", "# #", "# #"]),
    ('S', ["###", "#  ", "###", "  #", "###"]),
    ('T', ["###", " # ", " # ", " # ", " # "]),
    ('U', ["# #", "# #", "# #", "# #", "###"]),
    ('V', ["# #", "# #", "# #", "# #", " # "]),
    ('W', ["#   #", "#   #", "# # #", "## ##", "#   #"]),
    (' ', ["  ", "  ", "  ", "  ", "  "]),
];

/// Digits, points, minus signs and some capitals as rows of blocks; other characters are unchanged,
/// in the last row.
#[must_use]
pub fn big(text: &str) -> [String; ROWS] {
    let mut rows: [String; ROWS] = Default::default();
    for letter in text.chars() {
        match GLYPHS.iter().find(|(known, _)| *known == letter) {
            Some((_, points)) => add(&mut rows, points),
            None => {
                for (index, row) in rows.iter_mut().enumerate() {
                    row.push(if index + 1 == ROWS { letter } else { ' ' });
                }
            }
        }
    }
    rows
}

fn add(rows: &mut [String; ROWS], points: &[&str; 5]) {
    for (index, row) in rows.iter_mut().enumerate() {
        let upper = points.get(2 * index).copied().unwrap_or_default();
        let lower = points.get(2 * index + 1).copied().unwrap_or_default();
        let lower = lower.chars().chain(std::iter::repeat(' '));
        row.extend(upper.chars().zip(lower).map(|pair| match pair {
            ('#', '#') => '█',
            ('#', _) => '▀',
            (_, '#') => '▄',
            _ => ' ',
        }));
        row.push(' ');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number() {
        assert_eq!(
            big("-1.20m"),
            ["    ▄█    ▀▀█ █▀█  ", "▀▀▀  █    █▀▀ █ █  ", "    ▀▀▀ ▀ ▀▀▀ ▀▀▀ m"]
        );
        assert_eq!(big("SLIP"), ["█▀▀ █   █ █▀█ ", "▀▀█ █   █ █▀▀ ", "▀▀▀ ▀▀▀ ▀ ▀   "]);
    }
}
