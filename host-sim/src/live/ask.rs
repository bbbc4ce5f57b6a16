//! Converts keys to commands.

use floe_firmware::command::Command;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// Longest answer, characters; a board accepts 80.
const LONGEST: usize = 60;

/// A question to the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Question {
    Weight,
    Name,
    Slope,
    Calibrate,
    Note,
    Stop,
    Command,
}

impl Question {
    fn text(self) -> &'static str {
        match self {
            Self::Weight => "weight of the block, N",
            Self::Name => "name of the test",
            Self::Slope => "slope of the ice, degrees, uphill positive",
            Self::Calibrate => "force that hangs on the cell now, N",
            Self::Note => "note",
            Self::Stop => "stop the test? Enter stops it",
            Self::Command => "command",
        }
    }

    fn wants_text(self) -> bool {
        self != Self::Stop
    }

    fn wants_number(self) -> bool {
        matches!(self, Self::Weight | Self::Slope | Self::Calibrate)
    }

    fn command(self, answer: &str) -> String {
        let answer = answer.trim();
        match self {
            Self::Weight => format!("set weight {answer}"),
            Self::Name => format!("set name {answer}"),
            Self::Slope => format!("set slope {answer}"),
            Self::Calibrate => format!("calibrate {answer}"),
            Self::Note => format!("note {answer}"),
            Self::Stop => "stop".to_string(),
            Self::Command => answer.to_string(),
        }
    }
}

/// Action of a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Deed {
    /// No action, or one on the display only.
    None,
    /// Send this text to the board.
    Say(String),
    /// Leave the display.
    Quit,
}

/// State of the last row: the keys, or a question and its answer so far.
#[derive(Clone, Debug, Default)]
pub struct Ask {
    question: Option<Question>,
    typed: String,
    refused: Option<&'static str>,
    /// Whether all keys are shown until the next key.
    help: bool,
}

/// Kind of a key's action.
#[derive(Clone, Copy, Debug)]
enum Does {
    /// Sends the key's word to the board.
    Say,
    Ask(Question),
    Quit,
    /// Handled by [`Ask::key`].
    Else,
}

/// The keys with their words and actions; those shown in the last row come first.
const KEYS: [(&str, &str, Does); 16] = [
    ("s", "start", Does::Say),
    ("x", "stop", Does::Ask(Question::Stop)),
    ("?", "keys", Does::Else),
    ("q", "quit", Does::Quit),
    ("b", "weigh", Does::Say),
    ("t", "tare", Does::Say),
    ("y", "accept", Does::Say),
    ("z", "abort", Does::Say),
    ("c", "calibrate", Does::Ask(Question::Calibrate)),
    ("w", "weight", Does::Ask(Question::Weight)),
    ("n", "name", Does::Ask(Question::Name)),
    ("a", "slope", Does::Ask(Question::Slope)),
    ("m", "note", Does::Ask(Question::Note)),
    ("e", "self-test", Does::Say),
    (":", "any command", Does::Ask(Question::Command)),
    ("Esc", "leave a question", Does::Else),
];
/// Number of keys shown in the last row.
const FEW: usize = 7;

fn listed() -> impl Iterator<Item = String> {
    KEYS.iter().map(|(key, word, _)| format!("{key} {word}"))
}

impl Ask {
    /// Text of the last row.
    #[must_use]
    pub fn text(&self) -> String {
        let Some(question) = self.question else {
            return listed().take(FEW).collect::<Vec<_>>().join("  ");
        };
        let refused = self.refused.map(|why| format!("  ({why})")).unwrap_or_default();
        let cursor = if question.wants_text() { "_" } else { ", Esc does not" };
        let colon = if question.wants_text() { ": " } else { "" };
        format!("{}{colon}{}{cursor}{refused}", question.text(), self.typed)
    }

    /// All keys, if they are shown.
    #[must_use]
    pub fn keys(&self) -> Option<Vec<String>> {
        self.help.then(|| listed().collect())
    }

    /// Whether a question is open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.question.is_some()
    }

    /// Handles a key.
    pub fn key(&mut self, key: KeyEvent) -> Deed {
        if key.kind == KeyEventKind::Release {
            return Deed::None;
        }
        if key.modifiers.contains(KeyModifiers::CONTROL) {
            return if key.code == KeyCode::Char('c') { Deed::Quit } else { Deed::None };
        }
        let helped = std::mem::take(&mut self.help);
        match self.question {
            None if key.code == KeyCode::Char('?') => {
                self.help = !helped;
                Deed::None
            }
            None => self.choose(key.code),
            Some(question) => self.answer(question, key.code),
        }
    }

    fn choose(&mut self, code: KeyCode) -> Deed {
        let pressed = code.as_char().map(String::from).unwrap_or_default();
        match KEYS.iter().find(|(key, ..)| *key == pressed) {
            Some((_, word, Does::Say)) => Deed::Say((*word).to_string()),
            Some((.., Does::Quit)) => Deed::Quit,
            Some((.., Does::Ask(question))) => {
                *self = Self { question: Some(*question), ..Self::default() };
                Deed::None
            }
            Some((.., Does::Else)) | None => Deed::None,
        }
    }

    fn answer(&mut self, question: Question, code: KeyCode) -> Deed {
        self.refused = None;
        if code == KeyCode::Enter {
            return self.finish(question);
        } else if code == KeyCode::Esc {
            *self = Self::default();
        } else if code == KeyCode::Backspace {
            self.typed.pop();
        } else if let Some(letter) = code.as_char().filter(|_| question.wants_text()) {
            let fits = self.typed.len() < LONGEST && !letter.is_control();
            // Keyboards of some countries have a decimal comma.
            let letter = if letter == ',' && question.wants_number() { '.' } else { letter };
            self.typed.extend(fits.then_some(letter));
        }
        Deed::None
    }

    /// Ends a question; the board's own parser checks the command before it is sent.
    fn finish(&mut self, question: Question) -> Deed {
        if !self.typed.is_ascii() {
            self.refused = Some("the board has letters without accents only");
            return Deed::None;
        }
        let command = question.command(&self.typed);
        match Command::parse(&command) {
            Ok(_) => {
                *self = Self::default();
                Deed::Say(command)
            }
            Err(why) => {
                self.refused = Some(why);
                Deed::None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Presses keys in turn; returns the action of the last one.
    fn press(ask: &mut Ask, keys: &str) -> Deed {
        let mut deed = Deed::None;
        for letter in keys.chars() {
            let code = match letter {
                '\n' => KeyCode::Enter,
                '\x1B' => KeyCode::Esc,
                '\x08' => KeyCode::Backspace,
                letter => KeyCode::Char(letter),
            };
            deed = ask.key(KeyEvent::new(code, KeyModifiers::NONE));
        }
        deed
    }

    #[test]
    fn keys_become_commands() {
        let say = |text: &str| Deed::Say(text.to_string());
        for (keys, deed) in [
            ("w630\n", say("set weight 630")),
            ("w63,5\n", say("set weight 63.5")),
            ("w64\x08\x08630\n", say("set weight 630")),
            ("w1\x1Bs", say("start")),
            ("a-2\n", say("set slope -2")),
            ("nDFF8-13\n", say("set name DFF8-13")),
            ("x\n", say("stop")),
            ("xs", Deed::None),
            ("x\x1B", Deed::None),
            ("t", say("tare")),
            ("b", say("weigh")),
            ("y", say("accept")),
            ("z", say("abort")),
            ("mwind, 3 m/s\n", say("note wind, 3 m/s")),
            (":note a, b\n", say("note a, b")),
            ("a-1,5\n", say("set slope -1.5")),
            ("mwind 3 m/s\n", say("note wind 3 m/s")),
            ("nmy test\n", say("set name my test")),
            ("c98.1\n", say("calibrate 98.1")),
            (":set winch 0.016\n", say("set winch 0.016")),
            ("q", Deed::Quit),
            ("wq", Deed::None),
            ("?", Deed::None),
            ("?q", Deed::Quit),
        ] {
            assert_eq!(press(&mut Ask::default(), keys), deed, "{keys:?}");
        }
        let quit = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        let mut ask = Ask::default();
        press(&mut ask, "w6");
        assert_eq!(ask.key(quit), Deed::Quit);
    }

    #[test]
    fn a_wrong_answer_is_refused_and_can_be_mended() {
        let mut ask = Ask::default();
        assert_eq!(press(&mut ask, "w6x\n"), Deed::None);
        assert!(ask.text().contains("a number like 12.5"), "{}", ask.text());
        assert_eq!(press(&mut ask, "\x0830\n"), Deed::Say("set weight 630".to_string()));
        assert!(!ask.is_open());
        assert_eq!(press(&mut ask, ":begin\n"), Deed::None);
        assert!(ask.text().contains("unknown command"), "{}", ask.text());
        assert_eq!(press(&mut ask, "\x1Bmna\u{ef}ve\n"), Deed::None);
        assert_eq!(ask.text(), "note: na\u{ef}ve_  (the board has letters without accents only)");
        let mended = Deed::Say("note naive".to_string());
        assert_eq!(press(&mut ask, "\x08\x08\x08ive\n"), mended);
        let long = format!("\x1B:{}", "x".repeat(500));
        press(&mut ask, &long);
        assert!(ask.text().len() < 100);
    }
}
