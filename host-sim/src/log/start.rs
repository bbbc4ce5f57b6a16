//! Start time of a log.

use time::OffsetDateTime;

/// Time at which the log's own time begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Seconds since 1970, without leap seconds.
    pub unix_s: f64,
    /// Whether the time is UTC; otherwise it is in an unknown zone of the recording clock.
    pub is_utc: bool,
}

impl Start {
    /// The time `seconds` later as ISO 8601 with milliseconds, with a `Z` if it is UTC; `None`
    /// beyond year 9999.
    #[must_use]
    pub fn after(&self, seconds: f64) -> Option<String> {
        let milliseconds = ((self.unix_s + seconds) * 1e3).round() as i128;
        let nanoseconds = milliseconds.checked_mul(1_000_000)?;
        let at = OffsetDateTime::from_unix_timestamp_nanos(nanoseconds).ok()?;
        let (date, (h, m, s, ms)) = (at.date(), at.to_hms_milli());
        let (year, month, day) = date.to_calendar_date();
        let (month, zone) = (u8::from(month), if self.is_utc { "Z" } else { "" });
        Some(format!("{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}.{ms:03}{zone}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_written_to_the_millisecond() {
        let mut start = Start { unix_s: 1_330_516_800.0, is_utc: false };
        assert_eq!(start.after(0.0625).unwrap(), "2012-02-29T12:00:00.063");
        start.is_utc = true;
        assert_eq!(start.after(86_400.0).unwrap(), "2012-03-01T12:00:00.000Z");
        assert_eq!(start.after(1e12), None);
        assert_eq!(start.after(1e297), None);
    }
}
