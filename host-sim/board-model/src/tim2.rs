//! TIM2 as a free-running 32-bit counter (RM0351, chapter 31).

use crate::rules::At;

const CR1: u32 = 0x00;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;

/// The timer.
#[derive(Clone, Debug, Default)]
pub struct Tim2 {
    cr1: u32,
    flags: u32,
    /// The written prescaler, and the one in effect since the last update event.
    prescaler: (u32, u32),
    reload: u32,
    /// Count at a time, ns, from which the count continues.
    base: (f64, u64),
    /// Whether the counter is stopped, a fault that makes a waiting program hang.
    pub dead: bool,
}

impl Tim2 {
    /// The state after a reset.
    #[must_use]
    pub fn new() -> Self {
        Self { reload: u32::MAX, ..Self::default() }
    }

    /// Resets the timer; a stopped counter stays stopped.
    pub fn reset(&mut self) {
        *self = Self { dead: self.dead, ..Self::new() };
    }

    /// Stores the current count before a change of the clock.
    pub fn rebase(&mut self, at: &mut At<'_>) {
        self.base = (self.count(at), at.now_ns);
    }

    fn count(&self, at: &At<'_>) -> f64 {
        let (count, since_ns) = self.base;
        if self.cr1 & 1 == 0 || self.dead {
            return count;
        }
        let hz = at.clocks.pclk_hz / f64::from(self.prescaler.1 + 1);
        count + (at.now_ns - since_ns) as f64 * 1e-9 * hz
    }

    /// Reads a register.
    #[must_use]
    pub fn read(&self, offset: u32, at: &mut At<'_>) -> u32 {
        match offset {
            CR1 => self.cr1,
            SR => self.flags,
            CNT => (self.count(at) as u64 % (u64::from(self.reload) + 1)) as u32,
            PSC => self.prescaler.0,
            ARR => self.reload,
            _ => 0,
        }
    }

    /// Writes a register. A written prescaler takes effect at the next update event.
    pub fn write(&mut self, offset: u32, value: u32, at: &mut At<'_>) {
        self.rebase(at);
        match offset {
            CR1 => self.cr1 = value,
            SR => self.flags &= value,
            EGR if value & 1 != 0 => {
                self.prescaler.1 = self.prescaler.0;
                self.base.0 = 0.0;
                self.flags |= 1;
            }
            CNT => self.base.0 = f64::from(value),
            PSC => self.prescaler.0 = value & 0xFFFF,
            ARR => self.reload = value,
            _ if value == 0 => {}
            _ => at.breach(format!("TIM2: register 0x{offset:02x} is not modelled")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    #[test]
    fn the_prescaler_counts_from_the_update_event_on() {
        let mut timer = Tim2::new();
        let said = breaches(0, |at| {
            timer.write(PSC, 15, at);
            timer.write(CR1, 1, at);
        });
        assert!(said.is_empty());
        breaches(1_000_000, |at| {
            assert_eq!(timer.read(CNT, at), 16_000);
            timer.write(EGR, 1, at);
        });
        breaches(2_000_000, |at| assert_eq!(timer.read(CNT, at), 1000));
    }

    #[test]
    fn it_wraps_and_goes_on() {
        let mut timer = Tim2::new();
        breaches(0, |at| {
            timer.write(CNT, u32::MAX - 1, at);
            timer.write(CR1, 1, at);
        });
        breaches(250, |at| assert_eq!(timer.read(CNT, at), 2));
        timer.dead = true;
        breaches(2_500, |at| assert_eq!(timer.read(CNT, at), u32::MAX - 1));
    }
}
