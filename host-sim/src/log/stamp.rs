//! Time stamps as seconds: numbers in a unit, dates, forms of loggers.
//!
//! Calendar stamps become seconds since 1970 without leap seconds; an `f64` resolves them to 0.3
//! µs. A stamp with a zone is converted to UTC, one without is used unchanged.

use time::{Date, Month};

use super::number::{Decimal, finite, number};

/// Seconds in a day.
pub const DAY_S: f64 = 86_400.0;
const JULIAN_DAY_1970: i32 = 2_440_588;
/// Day 0 of a spreadsheet's serial dates (1899-12-30), in days before 1970.
const EXCEL_DAYS_1970: f64 = 25_569.0;
/// The same day in MATLAB's serial dates (`datenum`), from which on days are MATLAB's: a spreadsheet's
/// would be in the year 3800.
const MATLAB_DAY_0: f64 = 693_960.0;

/// Unit or form of the time column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum TimeUnit {
    /// Seconds.
    #[value(name = "s")]
    Second,
    /// Milliseconds.
    #[value(name = "ms")]
    Millisecond,
    /// Microseconds.
    #[value(name = "us")]
    Microsecond,
    /// Nanoseconds.
    #[value(name = "ns")]
    Nanosecond,
    /// Minutes.
    #[value(name = "min")]
    Minute,
    /// Date and time of day as text: 2024-01-05T12:00:00.0625+01:00.
    Iso,
    /// Since 1970: seconds, milliseconds or finer, by its size.
    Epoch,
    /// A spreadsheet's serial date, in days; MATLAB's datenum too.
    Excel,
}

impl TimeUnit {
    /// The unit in a column's name or units row.
    #[must_use]
    pub fn from_label(label: &str) -> Option<Self> {
        match label.trim().trim_end_matches('.').to_lowercase().as_str() {
            "s" | "sec" | "secs" | "sek" | "с" | "сек" | "second" | "seconds" | "sekunde"
            | "sekunden" => Some(Self::Second),
            "ms" | "msec" | "мс" | "millis" | "millisecond" | "milliseconds" => {
                Some(Self::Millisecond)
            }
            "us" | "µs" | "μs" | "micros" | "microsecond" | "microseconds" => {
                Some(Self::Microsecond)
            }
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Some(Self::Nanosecond),
            "min" | "mins" | "minute" | "minutes" | "minuten" => Some(Self::Minute),
            _ => None,
        }
    }

    /// As in options.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Nanosecond => "ns",
            Self::Minute => "min",
            Self::Iso => "iso",
            Self::Epoch => "epoch",
            Self::Excel => "excel",
        }
    }

    /// Whether stamps of this form contain the date.
    #[must_use]
    pub fn is_calendar(self) -> bool {
        matches!(self, Self::Iso | Self::Epoch | Self::Excel)
    }

    /// A cell converted to seconds.
    #[must_use]
    pub fn seconds(self, cell: &[u8], decimal: Decimal) -> Option<f64> {
        let number = || number(cell, decimal).filter(|value| value.is_finite());
        Some(match self {
            Self::Second => number()?,
            Self::Millisecond => number()? * 1e-3,
            Self::Microsecond => number()? * 1e-6,
            Self::Nanosecond => number()? * 1e-9,
            Self::Minute => number()? * 60.0,
            Self::Iso => return date_time_seconds(cell),
            Self::Epoch => epoch_seconds(number()?),
            Self::Excel => serial_seconds(number()?),
        })
    }
}

/// Whether seconds counted from 1970 give a day from 1995 to 2052.
#[must_use]
pub fn is_since_1970(seconds: f64) -> bool {
    (8e8..2.6e9).contains(&seconds)
}

/// Seconds from a count since 1970 in a unit inferred from its magnitude.
fn epoch_seconds(value: f64) -> f64 {
    match value.abs() {
        0.0..1e11 => value,
        1e11..1e14 => value / 1e3,
        1e14..1e17 => value / 1e6,
        _ => value / 1e9,
    }
}

/// Seconds from a serial date, a spreadsheet's or MATLAB's.
fn serial_seconds(days: f64) -> f64 {
    let days = if days < MATLAB_DAY_0 { days } else { days - MATLAB_DAY_0 };
    (days - EXCEL_DAYS_1970) * DAY_S
}

/// Seconds from date and time of day: `2012-02-29 12:00:00.0625`, with `T` or a blank in between,
/// `-` or `/` in the date, or as `29.02.2012` or `29-Feb-2012`; seconds may be missing, a zone, AM
/// or PM may follow.
#[must_use]
pub fn date_time_seconds(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    let (date_s, clock) = date_and_clock(text)?;
    Some(date_s + clock_seconds(clock.trim())?)
}

/// Date of a stamp in seconds, and the text of the time of day after it. Not every `T` separates
/// them, since October may contain one.
#[must_use]
pub fn date_and_clock(text: &str) -> Option<(f64, &str)> {
    let mut marks = text.match_indices([' ', 'T']);
    marks.find_map(|(at, _)| Some((date_seconds(text.get(..at)?)?, text.get(at + 1..)?)))
}

/// Seconds from a date without a time of day.
#[must_use]
pub fn date_seconds(text: &str) -> Option<f64> {
    let mut parts = text.split(['-', '/', '.']);
    let [first, month, last] = [parts.next()?, parts.next()?, parts.next()?];
    let named = named_month(month);
    let last_is_year = text.contains('.') || named.is_some() && last.len() == 4;
    let (year, day) = if last_is_year { (last, first) } else { (first, last) };
    // A year of two digits, or one at the end after slashes, could be a day.
    if parts.next().is_some() || year.len() != 4 {
        return None;
    }
    let month = match named {
        Some(month) => month,
        None => Month::try_from(month.parse::<u8>().ok()?).ok()?,
    };
    let date = Date::from_calendar_date(year.parse().ok()?, month, day.parse().ok()?).ok()?;
    Some(midnight_seconds(date))
}

/// A month by its short name, ignoring case.
fn named_month(text: &str) -> Option<Month> {
    const NAMES: [&str; 12] =
        ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let number = (1..).zip(NAMES).find(|(_, name)| text.eq_ignore_ascii_case(name))?.0;
    Month::try_from(number as u8).ok()
}

/// Seconds from a time of day, with an offset from UTC subtracted.
#[must_use]
pub fn clock_seconds(text: &str) -> Option<f64> {
    let (clock, half) = half_of_day(text);
    let (clock, offset_s) = zone(clock)?;
    let mut parts = clock.trim().splitn(3, ':');
    let hour: u8 = parts.next()?.parse().ok()?;
    let hour = match half {
        Some(_) if !(1..=12).contains(&hour) => return None,
        Some(first_hour) => hour % 12 + first_hour,
        None => hour,
    };
    let minute: u8 = parts.next()?.parse().ok()?;
    let second = parts.next().map_or(Some(0.0), |text| finite(text.as_bytes()))?;
    let valid = hour <= 24 && minute < 60 && (0.0..60.0).contains(&second);
    let time_s = f64::from(u32::from(hour) * 60 + u32::from(minute)) * 60.0 + second;
    (valid && time_s <= DAY_S).then_some(time_s - offset_s)
}

/// A time of day without AM or PM, and the first hour of that half of the day.
fn half_of_day(text: &str) -> (&str, Option<u8>) {
    let ends = |half: &str| {
        let at = text.len().checked_sub(half.len())?;
        let (clock, end) = text.split_at_checked(at)?;
        end.eq_ignore_ascii_case(half).then_some(clock)
    };
    match (ends("AM"), ends("PM")) {
        (Some(clock), _) => (clock, Some(0)),
        (_, Some(clock)) => (clock, Some(12)),
        _ => (text, None),
    }
}

/// Whether a time of day is followed by a zone.
#[must_use]
pub fn has_zone(text: &str) -> bool {
    zone(text).is_some_and(|(clock, _)| clock.len() < text.len())
}

/// A time of day without its zone, and the zone's offset, s.
fn zone(text: &str) -> Option<(&str, f64)> {
    if let Some(clock) = text
        .strip_suffix(['Z', 'z'])
        .or_else(|| text.strip_suffix("UTC"))
        .or_else(|| text.strip_suffix("GMT"))
    {
        return Some((clock, 0.0));
    }
    let Some(at) = text.find(['+', '-']) else { return Some((text, 0.0)) };
    let (clock, offset) = text.split_at_checked(at)?;
    let (sign, digits) = offset.split_at_checked(1)?;
    let digits = digits.replace(':', "");
    if !matches!(digits.len(), 2 | 4) || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (hours, minutes) = digits.split_at_checked(2)?;
    let (hours, minutes): (u8, u8) = (hours.parse().ok()?, minutes.parse().unwrap_or(0));
    let seconds = f64::from(hours) * 3600.0 + f64::from(minutes) * 60.0;
    let valid = hours < 24 && minutes < 60;
    valid.then_some((clock, if sign == "-" { -seconds } else { seconds }))
}

/// Seconds from a mixed-array stamp: year (also with two digits, from 1970), day of the year, hours
/// and minutes as `hhmm` (2400 ends a day), and seconds.
#[must_use]
pub fn cr10_seconds(year: f64, day: f64, hhmm: f64, second: f64) -> Option<f64> {
    let hhmm = whole(hhmm, 2400.0)?;
    let date = Date::from_ordinal_date(full_year(year)?, whole(day, 366.0)? as u16).ok()?;
    let valid = hhmm % 100 < 60 && (0.0..60.0).contains(&second);
    let minutes = hhmm / 100 * 60 + hhmm % 100;
    valid.then(|| midnight_seconds(date) + f64::from(minutes) * 60.0 + second)
}

fn full_year(year: f64) -> Option<i32> {
    let year = whole(year, 9999.0)? as i32;
    Some(match year {
        0..70 => 2000 + year,
        70..100 => 1900 + year,
        _ => year,
    })
}

fn whole(value: f64, most: f64) -> Option<u32> {
    let valid = (0.0..=most).contains(&value) && value.fract().abs() < f64::EPSILON;
    valid.then_some(value as u32)
}

fn midnight_seconds(date: Date) -> f64 {
    f64::from(date.to_julian_day() - JULIAN_DAY_1970) * DAY_S
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn date_and_time_of_day() {
        let noon = Some(1_330_516_800.0);
        let table = [
            ("1970-01-01 00:00:00", Some(0.0)),
            ("1970-01-02 00:00:01.0625", Some(86_401.062_5)),
            ("2012-02-29 12:00:00", noon),
            ("2012-02-29T12:00:00Z", noon),
            ("2012-02-29T13:00:00+01:00", noon),
            ("2012-02-29T06:30:00-0530", noon),
            ("2012-02-29T14:00+02", noon),
            ("2012/02/29 12:00", noon),
            ("29.02.2012 12:00:00,0", noon),
            ("2012-02-29 12:00:00 PM", noon),
            ("2012-02-29 11:59:60.0 am", None),
            ("29-Feb-2012 12:00:00", noon),
            ("2012-FEB-29 12:00 pm", noon),
            ("2012-02-28 12:00:00 AM", Some(1_330_387_200.0)),
            ("29-OCT-2012 12:00:00", Some(1_351_512_000.0)),
            ("29-OCT-2012T12:00:00UTC", Some(1_351_512_000.0)),
            ("2012-02-29 12:00:00 GMT", noon),
            ("2012-02-28 24:00:00", Some(1_330_473_600.0)),
            ("2012-02-28 24:00:01", None),
            ("2012-02-28 24:30", None),
            ("2012-02-29 13:00:00 PM", None),
            ("2012-02-29 0:10:00 AM", None),
            ("29-Fev-2012 12:00:00", None),
            ("29-Feb-12 12:00:00", None),
            ("2011-02-29 12:00:00", None),
            ("2012-02-29", None),
            ("2012-02-29 25:00:00", None),
            ("2012-02-29 12:61:00", None),
            ("2012-02-29 12:00:60", None),
            ("29/02/2012 12:00:00", None),
            ("29.02.12 12:00:00", None),
            ("2012-02-29T12:00:00+1", None),
            ("2012-02-29T12:00:00+24:00", None),
            ("2012-02-29T12:00:00+0160", None),
            ("2012-02-29T12:00:00+é1", None),
            ("yesterday 12:00:00", None),
        ];
        for (text, expected) in table {
            assert_eq!(date_time_seconds(text.as_bytes()), expected, "{text}");
        }
    }

    #[test]
    fn numbers_in_every_unit() {
        let seconds = |unit: TimeUnit, cell: &str| unit.seconds(cell.as_bytes(), Decimal::Any);
        assert_eq!(seconds(TimeUnit::Millisecond, "62.5"), Some(0.0625));
        assert_eq!(seconds(TimeUnit::Minute, "0,5"), Some(30.0));
        assert_eq!(seconds(TimeUnit::Epoch, "1330516800.5"), Some(1_330_516_800.5));
        assert_eq!(seconds(TimeUnit::Epoch, "1330516800500"), Some(1_330_516_800.5));
        assert_eq!(seconds(TimeUnit::Excel, "40968.5"), Some(1_330_516_800.0));
        assert_eq!(seconds(TimeUnit::Excel, "734928.5"), Some(1_330_516_800.0), "MATLAB");
        assert_eq!(seconds(TimeUnit::Second, "nan"), None);
    }

    #[test]
    fn cr10_stamps_roll_over_midnight_and_year() {
        let at = |year, day, hhmm, second| cr10_seconds(year, day, hhmm, second).unwrap();
        assert_eq!(at(94.0, 365.0, 2359.0, 59.875) + 0.125, at(95.0, 1.0, 0.0, 0.0));
        assert_eq!(at(1994.0, 100.0, 2400.0, 0.0), at(94.0, 101.0, 0.0, 0.0));
        assert_eq!(at(99.0, 365.0, 2400.0, 0.0), at(0.0, 1.0, 0.0, 0.0));
        assert_eq!(at(96.0, 366.0, 2359.0, 59.875) + 0.125, at(97.0, 1.0, 0.0, 0.0));
        assert_eq!(cr10_seconds(94.0, 366.0, 0.0, 0.0), None);
        assert_eq!(cr10_seconds(94.0, 1.0, 1260.0, 0.0), None);
        assert_eq!(cr10_seconds(94.0, 1.5, 1200.0, 0.0), None);
    }
}
