//! The calendar: what time it is outlives every reset, but not the power.
//!
//! It counts from the first of January 2000, when the crystal first ran; a backup register
//! pair keeps what the time is ahead of that, once somebody has said it. Both are in the
//! backup domain, which on this board has no battery of its own.

use embassy_stm32::pac::{PWR, RTC};

use super::clock;
use crate::wall_clock::Moment;

/// In the first backup register, when the two behind it have been written.
const MARK: u32 = 0x464C_4F45;
/// Counts of the sub-second register in a second.
const COUNTS: u32 = 256;

/// What time it is, ms since 1970 (UTC), if the clock was set since the power came. To 4 ms;
/// the crystal has to run.
#[must_use]
pub fn now() -> Option<u64> {
    let [mark, low, high] = [0, 1, 2].map(|n| RTC.bkpr(n).read().bkp());
    let ahead_ms = u64::from(high) << 32 | u64::from(low);
    (mark == MARK).then_some(())?;
    Some(counted_ms()?.wrapping_add(ahead_ms))
}

/// The clock is set: it is `unix_ms` now.
pub fn set(unix_ms: u64) {
    let Some(counted_ms) = counted_ms() else { return };
    let ahead_ms = unix_ms.wrapping_sub(counted_ms);
    let words = [(1, ahead_ms as u32), (2, (ahead_ms >> 32) as u32), (0, MARK)];
    for (n, word) in words {
        RTC.bkpr(n).write(|w| w.set_bkp(word));
    }
}

/// What the calendar has counted, ms since 1970, if it runs.
fn counted_ms() -> Option<u64> {
    // Without the crystal it stands still, and its registers are never brought up to date.
    clock::calendar_runs().then_some(())?;
    unlock();
    // The registers that are read are copies, brought up to date every two periods of its
    // clock; after a reset they are not yet.
    RTC.isr().modify(|w| w.set_rsf(false));
    while !RTC.isr().read().rsf() {}
    // In this order: the first holds the others until the last is read.
    let left = u32::from(RTC.ssr().read().ss());
    let (time, date) = (RTC.tr().read().0, RTC.dr().read().0);
    let ms = (COUNTS - 1).saturating_sub(left) * 1000 / COUNTS;
    Some(Moment::of_calendar(date, time)?.0 + u64::from(ms))
}

/// The backup domain can be written to, and the calendar's registers too.
fn unlock() {
    PWR.cr1().modify(|w| w.set_dbp(true));
    while !PWR.cr1().read().dbp() {}
    for key in [0xCA, 0x53] {
        RTC.wpr().write(|w| w.set_key(key));
    }
}
