//! Commands that a user types on the console.

use floe_core::{Effect, Effects};
use heapless::String;

use crate::measuring::Task;
use crate::notebook::{Kind, Track, WeightFrom, Winch, from_word};
use crate::settings::{NAME_LEN, fits_name};
use crate::wall_clock::Moment;
pub(crate) use number::NEGATIVE;
use number::{code, number, size};

mod number;

/// A value that can be set.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// `set WHAT X`: one number.
    Number(Quantity, f32),
    /// `set tare C`: converter code at zero force.
    Tare(i32),
    /// `set name WORDS`: name of the test.
    Name(String<NAME_LEN>),
    /// `set kind WORD`: how the block is pulled.
    Kind(Kind),
    /// `set track WORD`: the ice under the block.
    Track(Track),
    /// `set size L W H`: length, width and height of the block, m.
    Size([f32; 3]),
    /// `set cable L [AE]`: length of the cable, m, and stiffness times length, N.
    Cable(f32, Option<f32>),
    /// `set weight-from same_cell|other`: what weighed the block.
    WeightFrom(WeightFrom),
    /// `set effects auto|none|NAME,NAME`: effects beyond the linear model that the core looks for.
    Effects(Effects),
}

/// A setting with one number as its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Weight of the block, N.
    Weight,
    /// Slope of the ice, uphill positive; typed in degrees, stored in rad.
    Slope,
    /// Speed of the winch, m/s, or 0 if unknown.
    Winch,
    /// Largest force of the load cell, N, or 0 if unknown.
    Range,
    /// Codes per newton.
    Span,
    /// Depth of the snow, mm.
    Snow,
    /// Standard deviation of the weight, N; 0: known exactly.
    WeightStd,
    /// Standard deviation of the slope; typed in degrees, stored in rad.
    SlopeStd,
    /// Standard deviation of the load cell's zero, N.
    ZeroStd,
    /// Relative standard deviation of the load cell's span; typed in percent, stored as a fraction.
    SpanStd,
    /// Standard deviation of the swing's damping ratio.
    DampingStd,
    /// Standard deviation of the winch's speed, m/s.
    WinchStd,
}

impl Quantity {
    const ALL: &[(Self, &str)] = &[
        (Self::Weight, "weight"),
        (Self::Slope, "slope"),
        (Self::Winch, "winch"),
        (Self::Range, "range"),
        (Self::Span, "span"),
        (Self::Snow, "snow"),
        (Self::WeightStd, "weight-std"),
        (Self::SlopeStd, "slope-std"),
        (Self::ZeroStd, "zero-std"),
        (Self::SpanStd, "span-std"),
        (Self::DampingStd, "damping-std"),
        (Self::WinchStd, "winch-std"),
    ];

    /// Converts a typed value to the unit of the computation.
    fn of(self, typed: f32) -> Result<f32, &'static str> {
        match self {
            Self::Slope | Self::SlopeStd => Ok(typed.to_radians()),
            Self::SpanStd => Ok(0.01 * typed),
            Self::Snow if typed < 0.0 => Err(NEGATIVE),
            Self::Weight | Self::Winch | Self::Range | Self::Span | Self::Snow => Ok(typed),
            Self::WeightStd | Self::ZeroStd | Self::DampingStd | Self::WinchStd => Ok(typed),
        }
    }
}

/// A line from the console.
#[derive(Clone, Debug, PartialEq)]
pub enum Command<'a> {
    /// `set WHAT VALUE`.
    Set(Setting),
    /// `start`.
    Start,
    /// `stop`.
    Stop,
    /// `status`: settings, health and the result so far.
    Status,
    /// `live on` and `live off`: whether samples are sent as they come.
    Live(bool),
    /// `tare`, `calibrate N` and `weigh`: measures the load on the hook.
    Measure(Task),
    /// `accept`: stores the result of the measurement.
    Accept,
    /// `abort`: discards the measurement in progress.
    Abort,
    /// `note WORDS`: a note stored with the test.
    Note(&'a str),
    /// `winch moving` and `winch held`: state of the winch from now on.
    Winch(Winch),
    /// `clock`: shows the time; `clock 2027-03-02T10:15:00Z`: sets it.
    Clock(Option<Moment>),
    /// `self-test`.
    SelfTest,
    /// `help`.
    Help,
}

/// One line of help.
pub const HELP: &str = "clock [TIME]; self-test; tare; calibrate N; weigh; accept; abort; \
set weight|slope|winch|range|span|tare|name|snow|kind|size|track|cable X; \
set weight|slope|zero|span|damping|winch-std X; set weight-from same_cell|other; set effects auto|none|NAMES; note TEXT; winch moving|held; \
start; stop; status; live on|off";

impl<'a> Command<'a> {
    /// Parses a line of words separated by spaces.
    ///
    /// # Errors
    /// Advice on the correct form, as a phrase.
    pub fn parse(line: &'a str) -> Result<Self, &'static str> {
        let (verb, rest) = first_word(line);
        let rest_is = |command: Self| match rest {
            // `start test` is as good as `start`.
            "" | "test" => Ok(command),
            _ => Err("too many words"),
        };
        match verb {
            "set" => Setting::parse(rest).map(Self::Set),
            "start" => rest_is(Self::Start),
            "stop" => rest_is(Self::Stop),
            "status" => rest_is(Self::Status),
            "live" => match rest {
                "on" => Ok(Self::Live(true)),
                "off" => Ok(Self::Live(false)),
                _ => Err("live on, or live off"),
            },
            "tare" => rest_is(Self::Measure(Task::Tare)),
            "calibrate" => match number(rest)? {
                force_n if force_n > 0.0 => Ok(Self::Measure(Task::Calibrate(force_n))),
                _ => Err("a known force, N, above 0"),
            },
            "weigh" => rest_is(Self::Measure(Task::Weigh)),
            "accept" => rest_is(Self::Accept),
            "abort" => rest_is(Self::Abort),
            "self-test" => rest_is(Self::SelfTest),
            "note" if rest.is_empty() => Err("note, and what is to be written down"),
            "note" => Ok(Self::Note(rest)),
            "winch" => from_word(Winch::ALL, rest)
                .map(Self::Winch)
                .ok_or("unknown command; help lists them"),
            "clock" if rest.is_empty() => Ok(Self::Clock(None)),
            "clock" => match Moment::parse(rest) {
                Some(moment) => Ok(Self::Clock(Some(moment))),
                None => Err("clock 2027-03-02T10:15:00Z (UTC, 2000 to 2099)"),
            },
            "" | "help" | "?" => rest_is(Self::Help),
            _ => Err("unknown command; help lists them"),
        }
    }
}

/// The first word, and the text after it.
fn first_word(text: &str) -> (&str, &str) {
    let (word, rest) = cut(text.trim_ascii(), b' ');
    (word, rest.unwrap_or("").trim_ascii())
}

/// The text before the first mark, and the text after it if there is a mark. The standard library's
/// search is faster but larger.
fn cut(text: &str, mark: u8) -> (&str, Option<&str>) {
    let end = text.bytes().position(|byte| byte == mark).unwrap_or(text.len());
    let (before, rest) = text.split_at_checked(end).unwrap_or((text, ""));
    (before, rest.get(1..))
}

impl Setting {
    fn parse(text: &str) -> Result<Self, &'static str> {
        let (what, value) = first_word(text);
        if let Some(quantity) = from_word(Quantity::ALL, what) {
            return number(value)
                .and_then(|typed| quantity.of(typed))
                .map(|x| Self::Number(quantity, x));
        }
        Ok(match what {
            "tare" => Self::Tare(code(value)?),
            "name" => Self::Name(name(value)?),
            "kind" => {
                Self::Kind(from_word(Kind::ALL, value).ok_or("sliding, rafting or over-riding")?)
            }
            "track" => Self::Track(from_word(Track::ALL, value).ok_or("fresh or repeated")?),
            "size" => Self::Size(sizes(value)?),
            "cable" => match first_word(value) {
                (length, "") => Self::Cable(size(length)?, None),
                (length, stiffness) => Self::Cable(size(length)?, Some(size(stiffness)?)),
            },
            "weight-from" => Self::WeightFrom(
                from_word(WeightFrom::ALL, value).ok_or("weight-from same_cell, or other")?,
            ),
            "effects" => Self::Effects(effects(value)?),
            _ => return Err("set what? help lists it"),
        })
    }
}

/// Effects by name, or all compiled in (`auto`), or none.
fn effects(text: &str) -> Result<Effects, &'static str> {
    match text {
        "auto" => Ok(Effects::COMPILED),
        "none" => Ok(Effects::NONE),
        names => named(names).ok_or("auto, none, or names like sag,flop"),
    }
}

fn named(names: &str) -> Option<Effects> {
    let (mut set, mut rest) = (Effects::NONE, Some(names));
    while let Some(names) = rest {
        let (name, others) = cut(names, b',');
        let effect = Effect::named(name).filter(|effect| Effects::COMPILED.has(*effect))?;
        (set, rest) = (set.with(effect, true), others);
    }
    Some(set)
}

/// Length, width and height of the block.
fn sizes(text: &str) -> Result<[f32; 3], &'static str> {
    let (length, rest) = first_word(text);
    let (width, height) = first_word(rest);
    Ok([size(length)?, size(width)?, size(height)?])
}

/// A name of letters that the field of a line can hold.
fn name(text: &str) -> Result<String<NAME_LEN>, &'static str> {
    match String::try_from(text) {
        Ok(name) if text.bytes().all(fits_name) => Ok(name),
        _ => Err("a name has at most 16 letters, digits, spaces, - _ ."),
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn words() {
        assert_eq!(Command::parse("start"), Ok(Command::Start));
        assert_eq!(Command::parse("  start  test "), Ok(Command::Start));
        assert_eq!(Command::parse("stop test"), Ok(Command::Stop));
        assert_eq!(Command::parse("live on"), Ok(Command::Live(true)));
        let number = |what, x| Ok(Command::Set(Setting::Number(what, x)));
        assert_eq!(Command::parse("set weight 630"), number(Quantity::Weight, 630.0));
        assert_eq!(Command::parse("set slope -90"), number(Quantity::Slope, -FRAC_PI_2));
        assert_eq!(Command::parse("set slope-std 180"), number(Quantity::SlopeStd, PI));
        assert_eq!(Command::parse("set span-std 50"), number(Quantity::SpanStd, 0.5));
        assert_eq!(Command::parse("set snow 20"), number(Quantity::Snow, 20.0));
        assert_eq!(Command::parse("set winch-std 0.0002"), number(Quantity::WinchStd, 0.0002));
        assert_eq!(Command::parse("set tare -12345"), Ok(Command::Set(Setting::Tare(-12345))));
        let measure = |task| Ok(Command::Measure(task));
        assert_eq!(Command::parse("calibrate 49.05"), measure(Task::Calibrate(49.05)));
        assert_eq!(Command::parse("tare"), measure(Task::Tare));
        assert_eq!(Command::parse("weigh"), measure(Task::Weigh));
        let named = Command::parse("set  name  my test ");
        assert_eq!(named, Ok(Command::Set(Setting::Name(String::try_from("my test").unwrap()))));
        let note = Command::parse("note wind, 3 *  m/s");
        assert_eq!(note, Ok(Command::Note("wind, 3 *  m/s")));
        let set = |setting| Ok(Command::Set(setting));
        assert_eq!(Command::parse("set size 1.2 1 .3"), set(Setting::Size([1.2, 1.0, 0.3])));
        assert_eq!(Command::parse("set cable 15"), set(Setting::Cable(15.0, None)));
        let cable = Setting::Cable(15.0, Some(345_000.0));
        assert_eq!(Command::parse("set cable 15 345000"), set(cable));
        assert_eq!(Command::parse("set kind over-riding"), set(Setting::Kind(Kind::OverRiding)));
        assert_eq!(Command::parse("set track fresh"), set(Setting::Track(Track::Fresh)));
        let two = Effects::NONE.with(Effect::Sag, true).with(Effect::Flop, true);
        for (text, effects) in
            [("auto", Effects::COMPILED), ("none", Effects::NONE), ("sag,flop", two)]
        {
            let line = format!("set effects {text}");
            assert_eq!(Command::parse(&line), set(Setting::Effects(effects)));
        }
        assert!(Command::parse("set effects gravity").unwrap_err().contains("auto, none"));
        for wrong in ["", " sag,", " ,sag", " sag flop"] {
            assert!(Command::parse(&format!("set effects{wrong}")).is_err(), "{wrong}");
        }
        assert_eq!(Command::parse("clock"), Ok(Command::Clock(None)));
        let moment = Moment::parse("2027-03-02T10:15:00Z");
        assert_eq!(Command::parse("clock 2027-03-02T10:15:00Z"), Ok(Command::Clock(moment)));
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
            "set size 1 2",
            "set size 1 2 3 4",
            "set cable",
            "set cable 1 2 3",
            "set kind pushing",
            "set track old",
            "set snow -1",
            "calibrate 0",
            "calibrate -5",
            "calibrate",
            "weigh 5",
            "note",
            "clock now",
        ] {
            assert!(Command::parse(wrong).is_err(), "{wrong}");
        }
    }
}
