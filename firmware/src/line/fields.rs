//! Formatting and parsing of single fields.

use core::str::{FromStr, Split};

use super::{Decimal, LineError};
use crate::adc::Input;
use crate::measuring::Hindrance;
use crate::notebook::{Kind, Track, WeightFrom, Winch, from_word, word};
use crate::text::{Out, Show};
use floe_core::{Cause, Phase, Quality, Reason, SampleFlag};

/// Writes a field per call.
pub(super) struct Writer<'w>(pub Out<'w>);

impl Writer<'_> {
    pub(super) fn put(&mut self, value: impl Show) {
        ",".show(&mut self.0);
        value.show(&mut self.0);
    }

    /// Writes the fewest digits that read back as the same `f32`.
    pub(super) fn put_f32(&mut self, value: f32) {
        self.put(Decimal(value));
    }

    pub(super) fn put_some_f32(&mut self, value: Option<f32>) {
        match value {
            Some(value) => self.put_f32(value),
            None => self.put(""),
        }
    }

    pub(super) fn put_some(&mut self, value: Option<impl Show>) {
        match value {
            Some(value) => self.put(value),
            None => self.put(""),
        }
    }

    pub(super) fn put_some_word<T: Word>(&mut self, value: Option<T>) {
        match value {
            Some(value) => self.put_word(value),
            None => self.put(""),
        }
    }

    pub(super) fn put_word<T: Word>(&mut self, value: T) {
        self.put(word(T::WORDS, &value));
    }
}

/// Reads a field per call.
pub(super) struct Reader<'a>(pub Split<'a, char>);

impl<'a> Reader<'a> {
    pub(super) fn text(&mut self) -> Result<&'a str, LineError> {
        self.0.next().ok_or(LineError::Field)
    }

    pub(super) fn take<T: FromStr>(&mut self) -> Result<T, LineError> {
        self.text()?.parse().map_err(|_| LineError::Field)
    }

    pub(super) fn take_some<T: FromStr>(&mut self) -> Result<Option<T>, LineError> {
        match self.text()? {
            "" => Ok(None),
            text => text.parse().map(Some).map_err(|_| LineError::Field),
        }
    }

    /// Reads an optional field that lines of older boards lack.
    pub(super) fn take_late<T: FromStr>(&mut self) -> Result<Option<T>, LineError> {
        match self.0.next() {
            None | Some("") => Ok(None),
            Some(text) => text.parse().map(Some).map_err(|_| LineError::Field),
        }
    }

    pub(super) fn take_word<T: Word>(&mut self) -> Result<T, LineError> {
        from_word(T::WORDS, self.text()?).ok_or(LineError::Field)
    }

    pub(super) fn take_some_word<T: Word>(&mut self) -> Result<Option<T>, LineError> {
        match self.text()? {
            "" => Ok(None),
            text => from_word(T::WORDS, text).map(Some).ok_or(LineError::Field),
        }
    }

    /// Reads an optional word in a field that lines of older boards lack.
    pub(super) fn take_late_word<T: Word>(&mut self) -> Result<Option<T>, LineError> {
        match self.0.next() {
            None | Some("") => Ok(None),
            Some(text) => from_word(T::WORDS, text).map(Some).ok_or(LineError::Field),
        }
    }
}

/// A value with a fixed set of words.
pub(super) trait Word: Copy + PartialEq + 'static {
    const WORDS: &'static [(Self, &'static str)];
}

impl Word for bool {
    const WORDS: &'static [(Self, &'static str)] = &[(false, "0"), (true, "1")];
}

impl Word for SampleFlag {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Good, "good"),
        (Self::Saturated, "saturated"),
        (Self::Rejected, "rejected"),
        (Self::Spike, "spike"),
        (Self::Duplicate, "duplicate"),
    ];
}

impl Word for Phase {
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Unknown, "unknown"), (Self::Stick, "stick"), (Self::Slip, "slip")];
}

impl Word for Quality {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Good, "good"),
        (Self::Unresolved, "unresolved"),
        (Self::Slack, "slack"),
        (Self::Clipped, "clipped"),
    ];
}

impl Word for Reason {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Hidden, "hidden"),
        (Self::TooShort, "short"),
        (Self::TooLong, "long"),
        (Self::NoFit, "nofit"),
        (Self::Suspect, "suspect"),
        (Self::Aliased, "aliased"),
        (Self::NoRest, "norest"),
        (Self::Implausible, "implausible"),
        (Self::LetGo, "letgo"),
        (Self::WoundBack, "woundback"),
        (Self::Negative, "negative"),
        (Self::Scatters, "scatters"),
    ];
}

impl Word for Cause {
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Mass, "mass"), (Self::Friction, "friction"), (Self::Unknown, "unknown")];
}

impl Word for Hindrance {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Short, "short"),
        (Self::Drifts, "drifts"),
        (Self::Moves, "moves"),
        (Self::OutOfRange, "out-of-range"),
    ];
}

impl Word for Kind {
    const WORDS: &'static [(Self, &'static str)] = Self::ALL;
}

impl Word for Track {
    const WORDS: &'static [(Self, &'static str)] = Self::ALL;
}

impl Word for WeightFrom {
    const WORDS: &'static [(Self, &'static str)] = Self::ALL;
}

impl Word for Winch {
    const WORDS: &'static [(Self, &'static str)] = Self::ALL;
}

impl Word for Input {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Bridge, "bridge"),
        (Self::Shorted, "shorted"),
        (Self::Temperature, "temperature"),
        (Self::BurnOut, "burn-out"),
    ];
}
