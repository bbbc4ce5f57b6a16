//! Calendar time stamps of data loggers as seconds.
//!
//! Seconds since 1970 without time zone or leap seconds, which loggers do not
//! know; an `f64` holds them to 0.3 µs.

use time::{Date, Month};

use super::number::finite;

const DAY_S: f64 = 86_400.0;
const JULIAN_DAY_1970: i32 = 2_440_588;

/// A TOA5 stamp, `YYYY-MM-DD HH:MM:SS` with or without a fraction.
#[must_use]
pub fn toa5_seconds(cell: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let (date, clock) = text.split_once([' ', 'T'])?;
    let mut date = date.splitn(3, '-');
    let year = date.next()?.parse().ok()?;
    let month: u8 = date.next()?.parse().ok()?;
    let day = date.next()?.parse().ok()?;
    let date = Date::from_calendar_date(year, Month::try_from(month).ok()?, day).ok()?;
    let mut clock = clock.splitn(3, ':');
    let hour: u8 = clock.next()?.parse().ok()?;
    let minute: u8 = clock.next()?.parse().ok()?;
    let second = finite(clock.next()?.as_bytes())?;
    let valid = hour <= 24 && minute < 60 && (0.0..60.0).contains(&second);
    valid.then(|| seconds(date, u32::from(hour) * 60 + u32::from(minute), second))
}

/// A mixed-array stamp: year (also of two digits, from 1970), day of the year,
/// hours and minutes as `hhmm` (2400 ends a day) and seconds.
#[must_use]
pub fn cr10_seconds(year: f64, day: f64, hhmm: f64, second: f64) -> Option<f64> {
    let hhmm = whole(hhmm, 2400.0)?;
    let date = Date::from_ordinal_date(full_year(year)?, whole(day, 366.0)? as u16).ok()?;
    let valid = hhmm % 100 < 60 && (0.0..60.0).contains(&second);
    valid.then(|| seconds(date, hhmm / 100 * 60 + hhmm % 100, second))
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

fn seconds(date: Date, minutes: u32, second: f64) -> f64 {
    f64::from(date.to_julian_day() - JULIAN_DAY_1970) * DAY_S + f64::from(minutes) * 60.0 + second
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn toa5_stamps() {
        let table = [
            ("1970-01-01 00:00:00", Some(0.0)),
            ("1970-01-02 00:00:01.0625", Some(86_401.062_5)),
            ("2012-02-29 12:00:00", Some(1_330_516_800.0)),
            ("2011-02-29 12:00:00", None),
            ("2012-02-29", None),
            ("2012-02-29 25:00:00", None),
            ("2012-02-29 12:61:00", None),
            ("2012-02-29 12:00:60", None),
            ("yesterday 12:00:00", None),
        ];
        for (text, expected) in table {
            assert_eq!(toa5_seconds(text.as_bytes()), expected, "{text}");
        }
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
