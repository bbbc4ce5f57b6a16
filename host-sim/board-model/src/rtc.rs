//! The calendar (RM0351, chapter 38): time and date in BCD, in the backup domain.
//! Alarms, wake-up timer, time stamps and smooth calibration are not modelled.

use crate::rules::At;

const TR: u32 = 0x00;
const DR: u32 = 0x04;
const CR: u32 = 0x08;
const ISR: u32 = 0x0C;
const PRER: u32 = 0x10;
const WPR: u32 = 0x24;
const SSR: u32 = 0x28;
const BACKUP: u32 = 0x50;
const LAST_BACKUP: u32 = 0xCC;

const BYPSHAD: u32 = 1 << 5;
const INITS: u32 = 1 << 4;
const RSF: u32 = 1 << 5;
const INITF: u32 = 1 << 6;
const INIT: u32 = 1 << 7;
/// Clock periods until the initialisation mode is active, or the shadow registers are valid.
const SYNC_PERIODS: f64 = 2.0;
const DAY_S: u64 = 86_400;

/// The calendar.
#[derive(Debug)]
pub struct Rtc {
    /// Day since 2000-01-01 and second of the day at `since_ns`, where counting started last;
    /// without a clock the time at which it stopped.
    day: u32,
    second: f64,
    since_ns: Option<u64>,
    prescaler: u32,
    control: u32,
    /// Time of the request for initialisation mode, ns.
    setting_since_ns: Option<u64>,
    /// Time and date to be set at the end of the initialisation mode.
    shadow: (u32, u32),
    synchronised_ns: u64,
    unlocked: u8,
    backup: [u32; 32],
    /// Date locked until it is read.
    frozen: Option<u32>,
}

impl Default for Rtc {
    fn default() -> Self {
        Self {
            day: 0,
            second: 0.0,
            since_ns: None,
            prescaler: 0x007F_00FF,
            control: 0,
            setting_since_ns: None,
            shadow: (0, 0x2101),
            synchronised_ns: 0,
            unlocked: 0,
            backup: [0; 32],
            frozen: None,
        }
    }
}

fn bcd(value: u32) -> u32 {
    ((value / 10) << 4) | (value % 10)
}

fn binary(bcd: u32) -> u32 {
    (bcd >> 4) * 10 + (bcd & 0xF)
}

fn days_in(year: u32, month: u32) -> u32 {
    match month {
        2 if year.is_multiple_of(4) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Day since 2000-01-01 from a date register.
fn day_of(date: u32) -> u32 {
    let (year, month) = (binary(date >> 16 & 0xFF), binary(date >> 8 & 0x1F).clamp(1, 12));
    let years: u32 = (0..year).map(|y| 365 + u32::from(y.is_multiple_of(4))).sum();
    let months: u32 = (1..month).map(|m| days_in(year, m)).sum();
    years + months + binary(date & 0x3F).max(1) - 1
}

/// Date register from a day since 2000-01-01, which was a Saturday.
fn date_of(mut day: u32) -> u32 {
    let week_day = (day + 5) % 7 + 1;
    let (mut year, mut month) = (0, 1);
    while day >= 365 + u32::from(u32::is_multiple_of(year, 4)) {
        day -= 365 + u32::from(u32::is_multiple_of(year, 4));
        year += 1;
    }
    while day >= days_in(year, month) {
        day -= days_in(year, month);
        month += 1;
    }
    bcd(year) << 16 | week_day << 13 | bcd(month) << 8 | bcd(day + 1)
}

impl Rtc {
    /// Handles a reset of the chip: locks the registers; the time continues.
    pub fn reset(&mut self) {
        (self.unlocked, self.frozen, self.synchronised_ns) = (0, None, 0);
    }

    /// Handles a start, stop or change of the clock.
    pub fn rebase(&mut self, at: &mut At<'_>) {
        (self.day, self.second) = self.now(at);
        self.since_ns = at.clocks.rtc_hz.map(|_| at.now_ns);
    }

    fn tick_hz(&self, at: &At<'_>) -> f64 {
        let (a, s) = (self.prescaler >> 16 & 0x7F, self.prescaler & 0x7FFF);
        at.clocks.rtc_hz.unwrap_or(0.0) / (f64::from(a + 1) * f64::from(s + 1))
    }

    /// Current day and second of the day.
    fn now(&self, at: &At<'_>) -> (u32, f64) {
        let elapsed = self.since_ns.map_or(0.0, |since| (at.now_ns - since) as f64 * 1e-9);
        let second = self.second + elapsed * self.tick_hz(at);
        let days = (second / DAY_S as f64).floor();
        (self.day + days as u32, second - days * DAY_S as f64)
    }

    fn time(&self, at: &At<'_>) -> u32 {
        let second = self.now(at).1 as u32;
        bcd(second / 3600) << 16 | bcd(second / 60 % 60) << 8 | bcd(second % 60)
    }

    fn is_setting(&self, at: &At<'_>) -> bool {
        let sync_ns = at.clocks.rtc_hz.map(|hz| (SYNC_PERIODS * 1e9 / hz) as u64);
        match (self.setting_since_ns, sync_ns) {
            (Some(since), Some(sync)) => at.now_ns >= since + sync,
            _ => false,
        }
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32, at: &mut At<'_>) -> u32 {
        let setting = self.is_setting(at);
        match offset {
            TR | SSR | DR => {
                let ready = self.synchronised_ns != 0 && at.now_ns >= self.synchronised_ns;
                if !setting && self.control & BYPSHAD == 0 && !ready {
                    at.breach("RTC: calendar read before RSF");
                }
                self.read_calendar(offset, setting, at)
            }
            CR => self.control,
            ISR => {
                let flag = |set: bool, bit: u32| u32::from(set) * bit;
                let synchronised = self.synchronised_ns != 0
                    && at.now_ns >= self.synchronised_ns
                    && at.clocks.rtc_hz.is_some();
                0b111
                    | flag(date_of(self.now(at).0) >> 16 != 0, INITS)
                    | flag(synchronised, RSF)
                    | flag(setting, INITF)
                    | flag(self.setting_since_ns.is_some(), INIT)
            }
            PRER => self.prescaler,
            BACKUP..=LAST_BACKUP => self.backup[(offset - BACKUP) as usize / 4],
            _ => 0,
        }
    }

    /// Reads time or date. A read of sub-seconds or time locks the others until the date is read.
    fn read_calendar(&mut self, offset: u32, setting: bool, at: &At<'_>) -> u32 {
        if setting {
            return match offset {
                TR => self.shadow.0,
                DR => self.shadow.1,
                _ => 0,
            };
        }
        let (day, second) = self.now(at);
        match offset {
            DR => {
                let held = self.frozen.take().filter(|_| self.control & BYPSHAD == 0);
                date_of(held.unwrap_or(day))
            }
            _ => {
                self.frozen.get_or_insert(day);
                let counts = f64::from((self.prescaler & 0x7FFF) + 1);
                let left = ((1.0 - second.fract()) * counts).ceil() as u32;
                if offset == TR { self.time(at) } else { left.saturating_sub(1) }
            }
        }
    }

    /// Writes a register; `backup`: the backup domain is unlocked.
    pub fn write(&mut self, offset: u32, value: u32, backup: bool, at: &mut At<'_>) {
        if !backup {
            return at.breach("RTC: written while the backup domain is locked (PWR_CR1.DBP)");
        }
        match offset {
            WPR => {
                self.unlocked = match (self.unlocked, value & 0xFF) {
                    (_, 0xCA) => 1,
                    (1, 0x53) => 2,
                    _ => 0,
                }
            }
            BACKUP..=LAST_BACKUP => self.backup[(offset - BACKUP) as usize / 4] = value,
            _ if self.unlocked != 2 => at.breach("RTC: written while protected (WPR)"),
            ISR => self.write_isr(value, at),
            CR => self.control = value,
            TR | DR | PRER if !self.is_setting(at) => {
                at.breach("RTC: TR, DR or PRER written outside of the initialisation mode");
            }
            TR => self.shadow.0 = value & 0x7F_7F7F,
            DR => self.shadow.1 = value & 0xFF_FF3F,
            PRER => self.prescaler = value & 0x7F_7FFF,
            _ => at.breach(format!("RTC: register 0x{offset:02x} is not modelled")),
        }
    }

    fn write_isr(&mut self, value: u32, at: &mut At<'_>) {
        if value & RSF == 0 {
            let wait_ns = at.clocks.rtc_hz.map_or(0, |hz| (SYNC_PERIODS * 1e9 / hz) as u64);
            self.synchronised_ns = at.now_ns + wait_ns;
        }
        match (value & INIT != 0, self.setting_since_ns) {
            (true, None) => {
                let (day, _) = self.now(at);
                self.shadow = (self.time(at), date_of(day));
                self.setting_since_ns = Some(at.now_ns);
            }
            (false, Some(_)) if self.is_setting(at) => {
                let (time, date) = self.shadow;
                let hours = binary(time >> 16 & 0x3F);
                let minutes = 60 * hours + binary(time >> 8 & 0x7F);
                self.day = day_of(date);
                self.second = f64::from(60 * minutes + binary(time & 0x7F));
                self.since_ns = at.clocks.rtc_hz.map(|_| at.now_ns);
                self.setting_since_ns = None;
            }
            (false, _) => self.setting_since_ns = None,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    const S: u64 = 1_000_000_000;

    /// 2027-12-31, a Friday, 23:59:58.
    const DATE: u32 = 0x27_B2_31;
    const TIME: u32 = 0x23_59_58;

    fn set() -> Rtc {
        let mut rtc = Rtc::default();
        let said = breaches(0, |at| {
            rtc.rebase(at);
            [0xCA, 0x53].iter().for_each(|&key| rtc.write(WPR, key, true, at));
            rtc.write(ISR, INIT, true, at);
        });
        assert!(said.is_empty(), "{said:?}");
        let said = breaches(S, |at| {
            assert_ne!(rtc.read(ISR, at) & INITF, 0);
            rtc.write(TR, TIME, true, at);
            rtc.write(DR, DATE, true, at);
            rtc.write(ISR, 0, true, at);
        });
        assert!(said.is_empty(), "{said:?}");
        rtc
    }

    #[test]
    fn a_year_ends() {
        let mut rtc = set();
        let said = breaches(2 * S, |at| {
            assert_eq!((rtc.read(TR, at), rtc.read(DR, at)), (0x23_59_59, DATE));
            assert_ne!(rtc.read(ISR, at) & INITS, 0);
        });
        assert!(said.is_empty(), "{said:?}");
        breaches(3 * S + S / 2, |at| {
            assert_eq!(rtc.read(SSR, at), 127);
            assert_eq!((rtc.read(TR, at), rtc.read(DR, at)), (0, 0x28_C1_01));
        });
    }

    #[test]
    fn every_day_of_the_century_is_itself() {
        for day in 0..36_525 {
            assert_eq!(day_of(date_of(day)), day);
        }
        assert_eq!(date_of(59) & 0x1FFF, 0x229, "2000 was a leap year");
    }

    #[test]
    fn a_reset_does_not_stop_it_and_locks_it() {
        let mut rtc = set();
        breaches(2 * S, |at| rtc.write(BACKUP + 4, 77, true, at));
        rtc.reset();
        let said = breaches(4 * S, |at| {
            rtc.write(CR, BYPSHAD, true, at);
            assert_eq!(rtc.read(BACKUP + 4, at), 77);
            assert_eq!(rtc.time(at), 0x1);
            rtc.read(TR, at);
            rtc.write(WPR, 0xCA, false, at);
        });
        assert_eq!(said.len(), 3, "protected, RSF, locked: {said:?}");
    }
}
