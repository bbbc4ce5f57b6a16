//! Oddities in a row: one or two are ignored, three are the normal case.

/// Number of oddities in a row from which on they are the normal case: a quantity has changed, or
/// all of them. A pause of the winch spoils a stick line, and with it the two events that share it.
const NORMAL: u8 = 3;

/// Counts oddities in a row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InARow(u8);

impl InARow {
    /// Takes the next case. Is it the third odd one in a row, or a later one?
    pub(crate) fn take(&mut self, is_odd: bool) -> bool {
        self.0 = if is_odd { (self.0 + 1).min(NORMAL) } else { 0 };
        self.0 == NORMAL
    }

    /// Was the last case odd?
    pub(crate) fn is_odd(self) -> bool {
        self.0 > 0
    }
}
