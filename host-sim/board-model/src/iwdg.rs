//! The independent watchdog (RM0351, chapter 36).

use crate::rules::At;

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0C;

const RELOAD: u32 = 0xAAAA;
const UNLOCK: u32 = 0x5555;
const START: u32 = 0xCCCC;

/// Frequency of the low-speed oscillator, Hz.
const LSI_HZ: f64 = 32_000.0;
/// Clock periods until a written register takes effect.
const SYNC_PERIODS: f64 = 5.0;

/// The watchdog. Only a reset stops it.
#[derive(Debug)]
pub struct Iwdg {
    prescaler: u32,
    reload: u32,
    unlocked: bool,
    /// Time at which the last written register takes effect, ns.
    arrives_ns: u64,
    due_ns: Option<u64>,
}

impl Default for Iwdg {
    fn default() -> Self {
        Self { prescaler: 0, reload: 0xFFF, unlocked: false, arrives_ns: 0, due_ns: None }
    }
}

impl Iwdg {
    /// Time of the reset if the watchdog is not reloaded, ns.
    #[must_use]
    pub fn deadline_ns(&self) -> Option<u64> {
        self.due_ns
    }

    /// Reads a register.
    #[must_use]
    pub fn read(&self, offset: u32, at: &mut At<'_>) -> u32 {
        match offset {
            PR => self.prescaler,
            RLR => self.reload,
            // The flags of both registers are set together.
            SR => u32::from(at.now_ns < self.arrives_ns) * 0b11,
            _ => 0,
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, at: &mut At<'_>) {
        match (offset, value) {
            (KR, UNLOCK) => self.unlocked = true,
            (KR, START) => self.pet(at),
            (KR, RELOAD) => {
                self.unlocked = false;
                if self.due_ns.is_some() {
                    self.pet(at);
                }
            }
            (KR, _) => at.breach("IWDG: an unknown key"),
            (PR | RLR, _) if !self.unlocked => at.breach("IWDG: PR or RLR written while locked"),
            (PR, _) => (self.prescaler, self.arrives_ns) = (value & 0b111, Self::arrival(at)),
            (RLR, _) => (self.reload, self.arrives_ns) = (value & 0xFFF, Self::arrival(at)),
            _ => at.breach(format!("IWDG: register 0x{offset:02x} is not modelled")),
        }
    }

    fn arrival(at: &At<'_>) -> u64 {
        at.now_ns + (SYNC_PERIODS * 1e9 / LSI_HZ) as u64
    }

    fn pet(&mut self, at: &At<'_>) {
        let counts = f64::from(self.reload + 1) * f64::from(4 << self.prescaler.min(6));
        self.due_ns = Some(at.now_ns + (counts * 1e9 / LSI_HZ) as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    #[test]
    fn it_bites_when_nobody_pets_it() {
        let mut dog = Iwdg::default();
        let said = breaches(0, |at| {
            dog.write(KR, UNLOCK, at);
            dog.write(PR, 6, at);
            dog.write(RLR, 1249, at);
            dog.write(KR, RELOAD, at);
        });
        assert!(said.is_empty() && dog.deadline_ns().is_none());
        breaches(1000, |at| dog.write(KR, START, at));
        assert_eq!(dog.deadline_ns(), Some(10_000_001_000));
        breaches(5_000_000_000, |at| dog.write(KR, RELOAD, at));
        assert_eq!(dog.deadline_ns(), Some(15_000_000_000));
    }

    #[test]
    fn its_registers_are_locked() {
        let mut dog = Iwdg::default();
        assert_eq!(breaches(0, |at| dog.write(PR, 6, at)).len(), 1);
        assert_eq!(breaches(0, |at| dog.write(KR, 0x1234, at)).len(), 1);
    }
}
