//! Formatting in little code: `core::fmt` would take 5 kB more.

use core::fmt;

use crate::long_division::divide;
use heapless::string::StringView;

use crate::line::Text;

/// A text that is appended to. The first part that does not fit, and all after it, is left out.
#[derive(Debug)]
pub struct Out<'t> {
    text: &'t mut StringView,
    is_cut: bool,
}

impl<'t> Out<'t> {
    /// Appends to an existing text.
    pub fn new(text: &'t mut StringView) -> Self {
        Self { text, is_cut: false }
    }

    /// The text so far.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.text
    }

    /// Checks that nothing was left out.
    ///
    /// # Errors
    /// A part did not fit.
    pub fn end(self) -> fmt::Result {
        if self.is_cut { Err(fmt::Error) } else { Ok(()) }
    }

    #[inline(never)]
    fn push(&mut self, part: &str) {
        self.is_cut = self.is_cut || self.text.push_str(part).is_err();
    }
}

/// A value with a text form.
pub trait Show {
    /// Appends the text form.
    fn show(&self, out: &mut Out<'_>);
}

impl Show for &str {
    fn show(&self, out: &mut Out<'_>) {
        out.push(self);
    }
}

impl Show for u64 {
    fn show(&self, out: &mut Out<'_>) {
        whole(out, *self, 1);
    }
}

impl Show for u32 {
    fn show(&self, out: &mut Out<'_>) {
        u64::from(*self).show(out);
    }
}

impl Show for i32 {
    fn show(&self, out: &mut Out<'_>) {
        if *self < 0 {
            "-".show(out);
        }
        self.unsigned_abs().show(out);
    }
}

// One call per part, passed in registers, takes less code than a pair in memory.
impl<A: Show, B: Show> Show for (A, B) {
    #[inline(always)]
    fn show(&self, out: &mut Out<'_>) {
        self.0.show(out);
        self.1.show(out);
    }
}

impl<A: Show, B: Show, C: Show> Show for (A, B, C) {
    #[inline(always)]
    fn show(&self, out: &mut Out<'_>) {
        self.0.show(out);
        self.1.show(out);
        self.2.show(out);
    }
}

/// Appends an integer with at least `least` digits.
#[inline(never)]
pub(crate) fn whole(out: &mut Out<'_>, number: u64, least: usize) {
    let mut digits = [0; 20];
    let (mut rest, mut count) = (number, 0);
    for place in digits.iter_mut().rev() {
        if count >= least && rest == 0 {
            break;
        }
        let (quotient, digit) = divide(rest, 10);
        (rest, count) = (quotient, count + 1);
        *place = digit as u8;
    }
    digits.iter().skip(20 - count).for_each(|digit| put(out, b'0' + digit));
}

/// Text of a value, cut at the length of a line.
pub(crate) fn text(content: impl Show) -> Text {
    let mut text = Text::new();
    content.show(&mut Out::new(&mut text));
    text
}

/// Text of many parts, cut at the length of a line, with less code than nested pairs.
#[inline(never)]
pub(crate) fn join(parts: &[&dyn Show]) -> Text {
    let mut text = Text::new();
    let mut out = Out::new(&mut text);
    parts.iter().for_each(|part| part.show(&mut out));
    text
}

/// A number (first field) with 1 to 4 decimals (second field).
#[derive(Clone, Copy, Debug)]
pub struct Fixed(pub f32, pub u32);

impl Show for Fixed {
    #[inline(always)]
    fn show(&self, out: &mut Out<'_>) {
        fixed(out, self.0, self.1);
    }
}

#[inline(never)]
fn fixed(out: &mut Out<'_>, value: f32, decimals: u32) {
    let scale = 10_u32.pow(decimals);
    let rounded = (value.abs() * scale as f32 + 0.5) as u32;
    let sign = if value < 0.0 && rounded > 0 { "-" } else { "" };
    (sign, rounded / scale, ".").show(out);
    whole(out, (rounded % scale).into(), decimals as usize);
}

/// The last hexadecimal digits of a number; the second field is how many.
#[derive(Clone, Copy, Debug)]
pub struct Hex(pub u32, pub u8);

impl Show for Hex {
    fn show(&self, out: &mut Out<'_>) {
        for place in (0..self.1).rev() {
            let digit = (self.0 >> (4 * place)) as u8 & 0xF;
            put(out, if digit < 10 { b'0' + digit } else { b'A' - 10 + digit });
        }
    }
}

fn put(out: &mut Out<'_>, letter: u8) {
    out.is_cut = out.is_cut || out.text.push(char::from(letter)).is_err();
}
