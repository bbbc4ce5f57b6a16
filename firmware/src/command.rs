//! What a user can say.

use heapless::String;

use crate::notebook::{WeightFrom, from_word};
use crate::settings::{NAME_LEN, fits_name};

/// A value that can be set.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// `set weight N`: weight of the block, N.
    Weight(f32),
    /// `set slope DEG`: slope of the ice, uphill positive; here in rad.
    Slope(f32),
    /// `set winch M/S`, or 0 if unknown.
    Winch(f32),
    /// `set range N`: largest force of the load cell, or 0 if unknown.
    Range(f32),
    /// `set span C`: codes per newton.
    Span(f32),
    /// `set tare C`: code at zero force.
    Tare(i32),
    /// `set name WORD`: name of the test.
    Name(String<NAME_LEN>),
    /// `set weight-std N`: one standard deviation of the weight, N; 0: exactly known.
    WeightStd(f32),
    /// `set slope-std DEG`: of the slope; here in rad.
    SlopeStd(f32),
    /// `set zero-std N`: of the load cell's zero, N.
    ZeroStd(f32),
    /// `set span-std PERCENT`: of its span; here as a part of it.
    SpanStd(f32),
    /// `set damping-std D`: of the cable's damping, a part of the critical one.
    DampingStd(f32),
    /// `set weight-from same_cell|other`: what weighed the block.
    WeightFrom(WeightFrom),
}

/// A line from the console.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// `set WHAT VALUE`.
    Set(Setting),
    /// `start`.
    Start,
    /// `stop`.
    Stop,
    /// `status`: settings, health and the result so far.
    Status,
    /// `live on` and `live off`: samples as they come.
    Live(bool),
    /// `tare`: what hangs there now is zero.
    MeasureTare,
    /// `calibrate N`: this force hangs there now.
    Calibrate(f32),
    /// `accept`: use the calibration that was measured.
    Accept,
    /// `abort`: forget it, or whatever is being measured.
    Abort,
    /// `self-test`.
    SelfTest,
    /// `help`.
    Help,
}

/// One line of help.
pub const HELP: &str = "set weight|slope|winch|range|span|tare|name X; \
set weight|slope|zero|span|damping-std X; set weight-from same_cell|other; start; stop; status; \
live on|off; tare; calibrate N; accept; abort; self-test";

const SET: &str =
    "set weight|slope|winch|range|span|tare|name, or weight|slope|zero|span|damping-std";

impl Command {
    /// Reads a line; words are separated by spaces.
    ///
    /// # Errors
    /// What to do instead, in words.
    pub fn parse(line: &str) -> Result<Self, &'static str> {
        let mut words = line.split_ascii_whitespace();
        let verb = words.next().unwrap_or("help");
        let mut argument = || words.next().unwrap_or("");
        let command = match verb {
            "set" => Self::Set(Setting::parse(argument(), argument())?),
            "start" => Self::Start,
            "stop" => Self::Stop,
            "status" => Self::Status,
            "live" => match argument() {
                "on" => Self::Live(true),
                "off" => Self::Live(false),
                _ => return Err("live on, or live off"),
            },
            "tare" => Self::MeasureTare,
            "calibrate" => Self::Calibrate(number(argument())?),
            "accept" => Self::Accept,
            "abort" => Self::Abort,
            "self-test" => Self::SelfTest,
            "help" | "?" => Self::Help,
            _ => return Err("unknown command; help lists them"),
        };
        // `start test` is as good as `start`.
        match words.next() {
            None | Some("test") => Ok(command),
            Some(_) => Err("too many words"),
        }
    }
}

impl Setting {
    fn parse(what: &str, value: &str) -> Result<Self, &'static str> {
        Ok(match what {
            "weight" => Self::Weight(number(value)?),
            "slope" => Self::Slope(number(value)?.to_radians()),
            "winch" => Self::Winch(number(value)?),
            "range" => Self::Range(number(value)?),
            "span" => Self::Span(number(value)?),
            "tare" => Self::Tare(value.parse().map_err(|_| "a whole number of codes")?),
            "name" => Self::Name(name(value)?),
            "weight-std" => Self::WeightStd(number(value)?),
            "slope-std" => Self::SlopeStd(number(value)?.to_radians()),
            "zero-std" => Self::ZeroStd(number(value)?),
            "span-std" => Self::SpanStd(0.01 * number(value)?),
            "damping-std" => Self::DampingStd(number(value)?),
            "weight-from" => Self::WeightFrom(
                from_word(WeightFrom::ALL, value).ok_or("weight-from same_cell, or other")?,
            ),
            _ => return Err(SET),
        })
    }
}

/// A decimal number without an exponent, of at most 15 digits: the standard
/// library's parser would be a tenth of the program.
fn number(text: &str) -> Result<f32, &'static str> {
    const MISSING: &str = "a number like 12.5 is missing";
    const MOST_DIGITS: usize = 15;
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, text),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let count = whole.len() + fraction.len();
    let all = whole.bytes().chain(fraction.bytes());
    if count == 0 || count > MOST_DIGITS || !all.clone().all(|c| c.is_ascii_digit()) {
        return Err(MISSING);
    }
    let number = all.fold(0, |number, digit| number * 10 + u64::from(digit - b'0'));
    let scale = fraction.bytes().fold(1, |scale, _| scale * 10);
    Ok(sign * ratio(number, scale))
}

/// The `f32` nearest to a ratio of two numbers below 2⁵³, the second above zero; the even
/// one of two.
fn ratio(mut number: u64, mut scale: u64) -> f32 {
    if number == 0 {
        return 0.0;
    }
    let mut exponent = 0;
    while number < scale {
        (number, exponent) = (2 * number, exponent - 1);
    }
    while number >= 2 * scale {
        (scale, exponent) = (2 * scale, exponent + 1);
    }
    // 24 binary digits, the first of them 1.
    let mut digits = 0;
    for _ in 0..24 {
        let digit = u32::from(number >= scale);
        digits = 2 * digits + digit;
        number = 2 * (number - u64::from(digit) * scale);
    }
    let up = number > scale || (number == scale && digits % 2 == 1);
    (digits + u32::from(up)) as f32 * power_of_two(exponent - 23)
}

fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << 23)
}

/// Only what can stand in a line's field.
fn name(text: &str) -> Result<String<NAME_LEN>, &'static str> {
    match String::try_from(text) {
        Ok(name) if text.bytes().all(fits_name) => Ok(name),
        _ => Err("a name has at most 16 letters, digits, - _ ."),
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn words() {
        assert_eq!(Command::parse("start"), Ok(Command::Start));
        assert_eq!(Command::parse("  start  test "), Ok(Command::Start));
        assert_eq!(Command::parse("stop test"), Ok(Command::Stop));
        assert_eq!(Command::parse("live on"), Ok(Command::Live(true)));
        assert_eq!(Command::parse("set weight 630"), Ok(Command::Set(Setting::Weight(630.0))));
        assert_eq!(Command::parse("set tare -12345"), Ok(Command::Set(Setting::Tare(-12345))));
        assert_eq!(Command::parse("calibrate 49.05"), Ok(Command::Calibrate(49.05)));
        for wrong in [
            "begin",
            "live",
            "live maybe",
            "set",
            "set weight",
            "set weight x",
            "set weight nan",
            "set weight 1e3",
            "set weight inf",
            "set weight -",
            "set weight .",
            "set name a,b",
            "set name 12345678901234567",
            "set tare 1.5",
            "start now",
            "set weight 1 2",
        ] {
            assert!(Command::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_are_the_standard_librarys() {
        for text in [
            "0",
            "1",
            "-1",
            "630",
            "0.1",
            "429.5",
            "0.01565217391304",
            "16777217",
            ".5",
            "5.",
            "3.4028235",
            "123456789012345",
            "0.00000000000001",
            "-2.86",
            "1.24",
        ] {
            assert_eq!(number(text), Ok(text.parse().unwrap()), "{text}");
        }
    }
}
