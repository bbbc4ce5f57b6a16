//! The time of day, counted in sampling periods.
//!
//! It is unknown until it is set, because a board without power does not keep time.

use core::fmt;

use crate::long_division::divide;

use crate::text::{Out, Show, whole};

/// Duration of two sampling periods at 16 Hz, ms.
const MS_OF_TWO: u64 = 125;
const DAY_MS: u64 = 86_400_000;

/// The time of day, if it is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WallClock {
    /// Start of a sample, ms since 1970 (UTC), and the index of that sample.
    set: Option<(u64, u32)>,
}

impl WallClock {
    /// Sets the clock: sample `index` begins at `unix_ms`.
    pub fn set(&mut self, unix_ms: u64, index: u32) {
        self.set = Some((unix_ms, index));
    }

    /// Start of a sample, ms since 1970 (UTC); `None` if the clock is not set.
    #[must_use]
    pub fn at(&self, index: u32) -> Option<u64> {
        let (unix_ms, from) = self.set?;
        // Half of all indices count as later, the other half as earlier.
        let since = index.wrapping_sub(from) as i32;
        let ms = u64::from(since.unsigned_abs()) * MS_OF_TWO / 2;
        Some(if since < 0 { unix_ms.saturating_sub(ms) } else { unix_ms.saturating_add(ms) })
    }
}

/// Nearest number of sampling periods in a time; at most 2³² - 1.
#[must_use]
pub fn periods(ms: u64) -> u32 {
    // In 32 bits up to 49 days, because 64-bit divisions are long code.
    u32::try_from(ms)
        .map_or(u32::MAX, |ms| (ms / 125).saturating_mul(2) + (ms % 125 * 4 + 125) / 250)
}

/// A time, ms since 1970 (UTC), with the text form `2027-03-02T10:15:00.000Z`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment(pub u64);

impl Moment {
    /// Parses `2027-03-02T10:15:00Z`, with or without a fraction of a second; years 2000 to 2099.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        // First and end position of a field, and the characters allowed after it.
        const FIELDS: [(usize, usize, &[u8]); 6] = [
            (0, 4, b"-"),
            (5, 7, b"-"),
            (8, 10, b"T"),
            (11, 13, b":"),
            (14, 16, b":"),
            (17, 19, b".Z"),
        ];
        let bytes = text.as_bytes();
        let mut fields = [0; 6];
        for (field, &(from, to, marks)) in fields.iter_mut().zip(&FIELDS) {
            *field = number(bytes.get(from..to)?)?;
            bytes.get(to).filter(|&mark| marks.iter().any(|other| other == mark))?;
        }
        let [year, month, day, hour, minute, second] = fields;
        let ms = match bytes.get(19..)? {
            b"Z" => 0,
            [b'.', digits @ .., b'Z'] => thousandths(digits)?,
            _ => return None,
        };
        let moment = Self::of([year, month, day], [hour, minute, second])?;
        Some(Self(moment.0 + u64::from(ms)))
    }

    /// Time from the date and time registers of a microcontroller's calendar in BCD: year of the
    /// century, month, day; hour, minute, second.
    #[must_use]
    pub fn of_calendar(date: u32, time: u32) -> Option<Self> {
        let [_, year, month, day] = (date & 0x00FF_1F3F).to_be_bytes();
        let [_, hour, minute, second] = (time & 0x003F_7F7F).to_be_bytes();
        Self::of(
            [2000 + decimal(year), decimal(month), decimal(day)],
            [decimal(hour), decimal(minute), decimal(second)],
        )
    }

    /// Time from year, month and day; hour, minute and second.
    #[inline(never)]
    fn of([year, month, day]: [u32; 3], [hour, minute, second]: [u32; 3]) -> Option<Self> {
        let good =
            (2000..2100).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
        if !good || hour > 23 || minute > 59 || second > 59 {
            return None;
        }
        // Years begin in March, so the leap day is the last day of a year.
        let since_march = (month + 9) % 12;
        let years = year - MARCH_YEAR - u32::from(since_march >= 10);
        let days = 1461 * years / 4 + (153 * since_march + 2) / 5 + day - 1 - MARCH_TO_1970;
        if date(days) != [year, month, day] {
            return None;
        }
        let seconds = 3600 * hour + 60 * minute + second;
        Some(Self(u64::from(days) * DAY_MS + u64::from(seconds) * 1000))
    }
}

/// A leap year from whose first of March days are counted, and the days from there to 1970.
const MARCH_YEAR: u32 = 1968;
const MARCH_TO_1970: u32 = 671;

/// Year, month and day of a day since 1970. Valid to 2099, where every fourth year is a leap year;
/// later days return the last one. From March on, five months have 153 days.
#[inline(never)]
fn date(day: u32) -> [u32; 3] {
    const LAST: u32 = 47_481;
    let day = day.min(LAST) + MARCH_TO_1970;
    let years = (4 * day + 3) / 1461;
    let day = day - 1461 * years / 4;
    let since_march = (5 * day + 2) / 153;
    let day = day - (153 * since_march + 2) / 5 + 1;
    let is_next = since_march >= 10;
    let month = if is_next { since_march - 9 } else { since_march + 3 };
    [MARCH_YEAR + years + u32::from(is_next), month, day]
}

/// Two decimal digits of four bits each.
#[inline(never)]
fn decimal(digits: u8) -> u32 {
    u32::from(10 * (digits >> 4) + (digits & 0xF))
}

/// Decimal digits as a number.
#[inline(never)]
fn number(digits: &[u8]) -> Option<u32> {
    let add = |number: u32, digit: &u8| {
        digit.is_ascii_digit().then(|| number.wrapping_mul(10).wrapping_add((digit - b'0').into()))
    };
    digits.iter().try_fold(0, add)
}

/// Digits after the point as ms; finer digits are ignored.
fn thousandths(digits: &[u8]) -> Option<u32> {
    number(digits).filter(|_| !digits.is_empty())?;
    let digit = |place: usize| digits.get(place).map_or(0, |digit| u32::from(digit - b'0'));
    Some(100 * digit(0) + 10 * digit(1) + digit(2))
}

/// Days since 1970, second of the day, ms of the second.
#[inline(never)]
fn parts(unix_ms: u64) -> (u32, u32, u16) {
    let (seconds, ms) = divide(unix_ms, 1000);
    let (hours, second) = divide(seconds, 3600);
    let (days, hour) = divide(hours, 24);
    (days as u32, 3600 * u32::from(hour) + u32::from(second), ms)
}

impl Show for Moment {
    fn show(&self, out: &mut Out<'_>) {
        let (day, _, ms) = parts(self.0);
        let [year, month, day] = date(day);
        whole(out, year.into(), 4);
        for number in [month, day] {
            "-".show(out);
            whole(out, number.into(), 2);
        }
        ("T", TimeOfDay(self.0), ".").show(out);
        whole(out, ms.into(), 3);
        "Z".show(out);
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = heapless::String::<24>::new();
        self.show(&mut Out::new(&mut text));
        f.write_str(&text)
    }
}

/// Text form `10:15:00` of a time, ms since 1970 (UTC).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOfDay(pub u64);

impl Show for TimeOfDay {
    fn show(&self, out: &mut Out<'_>) {
        let (_, seconds, _) = parts(self.0);
        whole(out, (seconds / 3600).into(), 2);
        ":".show(out);
        whole(out, (seconds / 60 % 60).into(), 2);
        ":".show(out);
        whole(out, (seconds % 60).into(), 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    /// The expected Unix seconds are from `date -u -d TEXT +%s`.
    #[test]
    fn moments_are_those_of_the_calendar() {
        for (said, seconds) in [
            ("2000-01-01T00:00:00Z", 946_684_800),
            ("2000-02-29T23:59:59Z", 951_868_799),
            ("2000-03-01T00:00:00Z", 951_868_800),
            ("2024-12-31T12:00:00Z", 1_735_646_400),
            ("2027-03-02T10:15:00Z", 1_803_982_500),
            ("2099-12-31T23:59:59Z", 4_102_444_799),
        ] {
            let moment = Moment::parse(said).expect(said);
            assert_eq!(moment.0, seconds * 1000, "{said}");
            assert_eq!(moment.to_string(), said.replace('Z', ".000Z"));
        }
        let fine = Moment::parse("2027-03-02T10:15:00.12345Z").unwrap();
        assert_eq!(fine.to_string(), "2027-03-02T10:15:00.123Z");
        assert_eq!(Moment(0).to_string(), "1970-01-01T00:00:00.000Z");
    }

    #[test]
    fn every_day_there_and_back() {
        for day in (10_957..47_482).step_by(1) {
            let moment = Moment(day * DAY_MS + 45_296_789);
            assert_eq!(Moment::parse(&moment.to_string()), Some(moment));
        }
    }

    #[test]
    fn a_calendars_registers_are_a_moment() {
        // Day of the week and the 12-hour flag of the registers are ignored.
        let moment = Moment::of_calendar(0x27_B2_31, 0x40_0000 | 0x23_59_58);
        assert_eq!(moment, Moment::parse("2027-12-31T23:59:58Z"));
        // Registers of a calendar that was never set.
        assert_eq!(Moment::of_calendar(0x2101, 0), Moment::parse("2000-01-01T00:00:00Z"));
        assert_eq!(Moment::of_calendar(0x2100, 0), None);
        assert_eq!(Moment::of_calendar(0x2101, 0x0000_007A), None);
    }

    #[test]
    fn what_is_no_moment_is_refused() {
        for wrong in [
            "",
            "Z",
            "2027-03-02",
            "2027-03-02T10:15:00",
            "2027-03-02 10:15:00Z",
            "2027-02-29T10:15:00Z",
            "2027-00-02T10:15:00Z",
            "2027-13-02T10:15:00Z",
            "2027-03-32T10:15:00Z",
            "1999-03-02T10:15:00Z",
            "2027-03-02T24:15:00Z",
            "2027-03-02T10:60:00Z",
            "2027-03-02T10:15:60Z",
            "2027-03-02T10:15:00.Z",
            "2027-03-02T10:15:00.1xZ",
            "2027-03-02T10:15:00:00Z",
            "2027--3-02T10:15:00Z",
            "99999999999-03-02T10:15:00Z",
        ] {
            assert_eq!(Moment::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn periods_are_the_nearest_number() {
        for (ms, number) in [(0, 0), (31, 0), (32, 1), (62, 1), (63, 1), (94, 2), (125, 2)] {
            assert_eq!(periods(ms), number, "{ms} ms");
        }
        assert_eq!(periods(86_400_000), 16 * 86_400);
        assert_eq!(periods(u64::MAX), u32::MAX);
    }

    #[test]
    fn samples_have_times_once_it_is_set() {
        let mut clock = WallClock::default();
        assert_eq!(clock.at(5), None);
        clock.set(1_000_000, u32::MAX - 3);
        assert_eq!(clock.at(u32::MAX - 3), Some(1_000_000));
        assert_eq!(clock.at(12), Some(1_001_000));
        assert_eq!(clock.at(u32::MAX - 5), Some(1_000_000 - 125));
    }
}
