//! Marks of the winch by a person next to it: the times from which it turned or was held.
//!
//! In a log they are `# winch_marks_s: held 60.25, moving 75.5`, in seconds of its own time; on the
//! board's card one `W` line each.

use floe_firmware::line::Line;
use floe_firmware::notebook::{Winch, from_word, word};

/// A mark, valid from its time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WinchMark {
    /// Time in the log's own time, s.
    pub from_s: f64,
    /// Whether the winch turns; otherwise it is held.
    pub turns: bool,
}

impl WinchMark {
    /// What to say of a mark without effect: one that comes more than a second after the end of its
    /// log, at `end_s`.
    #[must_use]
    pub fn after(&self, end_s: f64) -> Option<String> {
        let winch = word(Winch::ALL, if self.turns { &Winch::Moving } else { &Winch::Held });
        (self.from_s > end_s + 1.0).then(|| {
            format!(
                "the mark '{winch} {}' comes after the end of the log at {end_s:.2} s and has no effect: \
                 write the log's own seconds",
                self.from_s
            )
        })
    }
}

/// The marks in a text such as `held 60.25, moving 75.5`.
pub(super) fn parse(text: &str) -> Result<Vec<WinchMark>, String> {
    let mut words = text.split_whitespace();
    let mut marks: Vec<WinchMark> = Vec::new();
    while let Some(what) = words.next() {
        let number = words.next().map(|word| word.trim_end_matches([',', ';']).replace(',', "."));
        let from_s =
            number.and_then(|it| it.parse().ok()).filter(|from_s: &f64| from_s.is_finite());
        let (Some(winch), Some(from_s)) = (from_word(Winch::ALL, what), from_s) else {
            return Err(format!(
                "has '{text}': write moments in seconds, like 'held 60.25, moving 75.5'"
            ));
        };
        if marks.last().is_some_and(|last| last.from_s > from_s) {
            return Err(format!("has '{text}': write the moments in their order"));
        }
        marks.push(WinchMark { from_s, turns: winch == Winch::Moving });
    }
    Ok(marks)
}

/// The comment with the marks in the board's lines; empty without marks.
pub(crate) fn comment(lines: &str, rate_hz: f32) -> String {
    let mark = |line| match Line::parse(line) {
        Ok(Line::Mark { index, winch }) => {
            Some(format!("{} {}", word(Winch::ALL, &winch), f64::from(index) / f64::from(rate_hz)))
        }
        _ => None,
    };
    let marks: Vec<String> = lines.lines().filter_map(mark).collect();
    if marks.is_empty() {
        String::new()
    } else {
        format!("# winch_marks_s: {}\n", marks.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_read_as_they_are_written() {
        let marks = parse("held 60.25, moving 75,5; held 80").unwrap();
        let [held, moving, again] = marks.as_slice() else { panic!("{marks:?}") };
        assert_eq!(*held, WinchMark { from_s: 60.25, turns: false });
        assert_eq!(*moving, WinchMark { from_s: 75.5, turns: true });
        assert_eq!(again.from_s.to_bits(), 80.0_f64.to_bits());
        let line = |index, winch| Line::Mark { index, winch }.to_text().unwrap();
        let lines = format!("{}\n{}\n", line(964, Winch::Held), line(1208, Winch::Moving));
        assert_eq!(comment(&lines, 16.0), "# winch_marks_s: held 60.25, moving 75.5\n");
        assert_eq!(comment("nothing\n", 16.0), "");
    }

    #[test]
    fn what_is_no_mark_is_refused() {
        for text in ["held", "60.25", "stopped 60", "held nan", "moving 1, held x"] {
            assert!(parse(text).unwrap_err().contains("'held 60.25, moving 75.5'"), "{text}");
        }
        assert!(parse("held 60, moving 50").unwrap_err().ends_with("in their order"));
    }
}
