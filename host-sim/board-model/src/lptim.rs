//! LPTIM1 as a periodic tick (RM0351, chapter 34).

use crate::rules::At;

const ISR: u32 = 0x00;
const ICR: u32 = 0x04;
const IER: u32 = 0x08;
const CFGR: u32 = 0x0C;
const CR: u32 = 0x10;
const CMP: u32 = 0x14;
const ARR: u32 = 0x18;
const CNT: u32 = 0x1C;

/// Autoreload match.
const ARRM: u32 = 1 << 1;
/// A written autoreload value is in effect.
const ARROK: u32 = 1 << 4;
const ENABLE: u32 = 1 << 0;
const SNGSTRT: u32 = 1 << 1;
const CNTSTRT: u32 = 1 << 2;

/// Periods of the timer's clock until a written register or a start takes effect.
const SYNC_PERIODS: f64 = 3.0;

/// The timer.
#[derive(Debug, Default)]
pub struct Lptim {
    flags: u32,
    interrupts: u32,
    config: u32,
    control: u32,
    compare: u32,
    reload: u32,
    reload_arrives_ns: Option<u64>,
    /// Time of the start, ns, and number of matches since.
    running: Option<(u64, u64)>,
}

impl Lptim {
    /// Period of the timer's clock after the prescaler, ns.
    fn period_ns(&self, at: &At<'_>) -> Option<f64> {
        let divider = f64::from(1 << (self.config >> 9 & 0b111));
        at.clocks.lptim_hz.map(|hz| divider * 1e9 / hz)
    }

    /// Time of the next match, ns.
    #[must_use]
    pub fn deadline_ns(&self, at: &At<'_>) -> Option<u64> {
        let (start_ns, matches) = self.running?;
        let periods = (matches + 1) as f64 * (f64::from(self.reload) + 1.0);
        Some(start_ns + (periods * self.period_ns(at)?).round() as u64)
    }

    /// Advances the timer to the current time.
    pub fn advance(&mut self, at: &mut At<'_>) {
        if self.reload_arrives_ns.is_some_and(|t| t <= at.now_ns) {
            self.reload_arrives_ns = None;
            self.flags |= ARROK;
        }
        while self.deadline_ns(at).is_some_and(|t| t <= at.now_ns) {
            if self.flags & self.interrupts & ARRM != 0 {
                at.breach("LPTIM1: a tick was missed: the one before is not cleared yet");
            }
            self.flags |= ARRM;
            if let Some((_, matches)) = &mut self.running {
                *matches += 1;
            }
        }
    }

    /// Whether the interrupt line is active.
    #[must_use]
    pub fn interrupt(&self) -> bool {
        self.flags & self.interrupts != 0
    }

    /// Reads a register.
    #[must_use]
    pub fn read(&self, offset: u32, at: &mut At<'_>) -> u32 {
        match offset {
            ISR => self.flags,
            IER => self.interrupts,
            CFGR => self.config,
            CR => self.control,
            CMP => self.compare,
            ARR => self.reload,
            CNT => match (self.running, self.period_ns(at)) {
                (Some((start, _)), Some(period)) => {
                    let count = at.now_ns.saturating_sub(start) as f64 / period;
                    (count as u64 % (u64::from(self.reload) + 1)) as u32
                }
                _ => 0,
            },
            _ => 0,
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, at: &mut At<'_>) {
        let enabled = self.control & ENABLE != 0;
        match offset {
            ICR => self.flags &= !value,
            IER | CFGR if enabled => at.breach("LPTIM1: IER or CFGR written while it is enabled"),
            IER => self.interrupts = value,
            CFGR => self.config = value,
            CR => self.write_control(value, at),
            CMP | ARR if !enabled => at.breach("LPTIM1: ARR or CMP written while it is off"),
            ARR if self.reload_arrives_ns.is_some() => {
                at.breach("LPTIM1: ARR written before the last value has arrived (ARROK)");
            }
            ARR => {
                if value <= self.compare {
                    at.breach("LPTIM1: ARR is not above CMP");
                }
                self.reload = value & 0xFFFF;
                let period_ns = self.period_ns(at);
                self.reload_arrives_ns =
                    period_ns.map(|period| at.now_ns + (SYNC_PERIODS * period) as u64);
            }
            CMP => self.compare = value & 0xFFFF,
            _ => at.breach(format!("LPTIM1: register 0x{offset:02x} is not modelled")),
        }
    }

    fn write_control(&mut self, value: u32, at: &mut At<'_>) {
        if value & ENABLE == 0 {
            // Disabling resets everything except configuration and interrupts.
            let (interrupts, config) = (self.interrupts, self.config);
            *self = Self { interrupts, config, ..Self::default() };
            return;
        }
        if value & (SNGSTRT | CNTSTRT) != 0 && self.control & ENABLE == 0 {
            at.breach("LPTIM1: started before it is enabled");
        }
        if value & CNTSTRT != 0 && self.running.is_none() {
            if self.reload_arrives_ns.is_some() {
                at.breach("LPTIM1: started before ARR has arrived (ARROK)");
            }
            if self.period_ns(at).is_none() {
                at.breach("LPTIM1: started without a clock");
            }
            self.running = Some((at.now_ns, 0));
        }
        self.control = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    fn started() -> Lptim {
        let mut timer = Lptim::default();
        let said = breaches(0, |at| {
            timer.write(IER, ARRM, at);
            timer.write(CR, ENABLE, at);
            timer.write(ARR, 2047, at);
        });
        assert!(said.is_empty(), "{said:?}");
        let said = breaches(1_000_000, |at| {
            timer.advance(at);
            assert_eq!(timer.read(ISR, at), ARROK);
            timer.write(CR, ENABLE | CNTSTRT, at);
        });
        assert!(said.is_empty(), "{said:?}");
        timer
    }

    #[test]
    fn sixteen_ticks_a_second_to_the_nanosecond() {
        let mut timer = started();
        for tick in 1..=1000 {
            let due = 1_000_000 + tick * 62_500_000;
            let said = breaches(due, |at| {
                assert_eq!(timer.deadline_ns(at), Some(due));
                timer.advance(at);
                assert!(timer.interrupt());
                timer.write(ICR, ARRM, at);
            });
            assert!(said.is_empty() && !timer.interrupt());
        }
    }

    #[test]
    fn what_the_manual_forbids() {
        let mut timer = started();
        let said = breaches(2_000_000, |at| {
            timer.write(IER, 0, at);
            timer.write(ARR, 9, at);
            timer.write(ARR, 10, at);
        });
        assert_eq!(said.len(), 2, "{said:?}");
        let said = breaches(500_000_000, |at| timer.advance(at));
        assert!(said.iter().any(|s| s.contains("missed")));
        let mut off = Lptim::default();
        let said = breaches(0, |at| {
            off.write(ARR, 9, at);
            off.write(CR, ENABLE | CNTSTRT, at);
        });
        assert_eq!(said.len(), 2, "{said:?}");
    }
}
