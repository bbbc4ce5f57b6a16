//! The calendar: keeps the time of day through every reset, but not without power.
//!
//! The RTC counts from 1 January 2000, starting when the crystal first ran. A pair of backup
//! registers holds the offset of the true time, once the clock was set. Both are in the backup
//! domain, which has no battery on this board.

use embassy_stm32::pac::{PWR, RTC};

use super::clock;
use crate::wall_clock::Moment;

/// Value of the first backup register once the offset in the next two is valid.
const MARK: u32 = 0x464C_4F45;
/// Counts of the sub-second register in a second.
const COUNTS: u32 = 256;

/// Time of day, ms since 1970 (UTC), if the clock was set since power-up. Resolution 4 ms; requires
/// a running crystal.
#[must_use]
pub fn now() -> Option<u64> {
    let [mark, low, high] = [0, 1, 2].map(|n| RTC.bkpr(n).read().bkp());
    let ahead_ms = u64::from(high) << 32 | u64::from(low);
    (mark == MARK).then_some(())?;
    Some(counted_ms()?.wrapping_add(ahead_ms))
}

/// Stores that it is `unix_ms` now, ms since 1970 (UTC).
pub fn set(unix_ms: u64) {
    let Some(counted_ms) = counted_ms() else { return };
    let ahead_ms = unix_ms.wrapping_sub(counted_ms);
    let words = [(1, ahead_ms as u32), (2, (ahead_ms >> 32) as u32), (0, MARK)];
    for (n, word) in words {
        RTC.bkpr(n).write(|w| w.set_bkp(word));
    }
}

/// Time on the calendar, ms since 1970, if it runs.
fn counted_ms() -> Option<u64> {
    // Without the crystal the calendar stands still, and its registers are never updated.
    clock::calendar_runs().then_some(())?;
    unlock();
    // The shadow registers are updated every two periods of the calendar's clock; after a reset
    // they are not valid yet.
    RTC.isr().modify(|w| w.set_rsf(false));
    while !RTC.isr().read().rsf() {}
    // The order matters: reading the first register locks the others until the last is read.
    let left = u32::from(RTC.ssr().read().ss());
    let (time, date) = (RTC.tr().read().0, RTC.dr().read().0);
    let ms = (COUNTS - 1).saturating_sub(left) * 1000 / COUNTS;
    Some(Moment::of_calendar(date, time)?.0 + u64::from(ms))
}

/// Enables writing to the backup domain and to the calendar's registers.
fn unlock() {
    PWR.cr1().modify(|w| w.set_dbp(true));
    while !PWR.cr1().read().dbp() {}
    for key in [0xCA, 0x53] {
        RTC.wpr().write(|w| w.set_key(key));
    }
}
