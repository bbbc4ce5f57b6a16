//! What a user can say.

use heapless::String;

use crate::settings::NAME_LEN;

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
pub const HELP: &str = "set weight|slope|winch|range|span|tare|name X; start; stop; status; \
live on|off; tare; calibrate N; accept; abort; self-test";

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
            _ => return Err("set weight|slope|winch|range|span|tare|name"),
        })
    }
}

fn number(text: &str) -> Result<f32, &'static str> {
    let number: f32 = text.parse().map_err(|_| "a number is missing")?;
    if number.is_finite() { Ok(number) } else { Err("a finite number is needed") }
}

/// Only what can stand in a line's field.
fn name(text: &str) -> Result<String<NAME_LEN>, &'static str> {
    let fits = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    match String::try_from(text) {
        Ok(name) if text.chars().all(fits) => Ok(name),
        _ => Err("a name has at most 16 letters, digits, - _ ."),
    }
}
