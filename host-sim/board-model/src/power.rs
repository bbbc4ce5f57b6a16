//! Power control (RM0351, chapter 5) and the flash's interface (chapter 3).

use crate::rules::At;

const PWR_CR1: u32 = 0x00;
const DBP: u32 = 1 << 8;
const FLASH_ACR: u32 = 0x00;
const FLASH_OPTR: u32 = 0x20;

/// The power control peripheral PWR.
#[derive(Debug)]
pub struct Pwr {
    registers: [u32; 0x18],
}

impl Default for Pwr {
    fn default() -> Self {
        let mut registers = [0; 0x18];
        // CR1: voltage range 1; CR3.
        (registers[0], registers[2]) = (0x200, 0x8000);
        Self { registers }
    }
}

impl Pwr {
    /// Reads a register; the regulator has always reached the requested voltage.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        self.registers.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32, at: &mut At<'_>) {
        // Range 2 allows 26 MHz, but with fewer wait states than are modelled.
        if offset == PWR_CR1 && value >> 9 & 0b11 != 0b01 {
            at.breach("PWR: a voltage range that this model does not have");
        }
        if let Some(slot) = self.registers.get_mut(offset as usize / 4) {
            *slot = value;
        }
    }

    /// Whether the backup domain may be written.
    #[must_use]
    pub fn backup_unlocked(&self) -> bool {
        self.registers[0] & DBP != 0
    }
}

/// The flash interface FLASH.
#[derive(Debug)]
pub struct Flash {
    access: u32,
}

impl Default for Flash {
    fn default() -> Self {
        Self { access: 0x600 }
    }
}

impl Flash {
    /// Reads a register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        match offset {
            FLASH_ACR => self.access,
            // Factory value: watchdogs started by software, running in stop modes.
            FLASH_OPTR => 0xFFEF_F8AA,
            _ => 0,
        }
    }

    /// Writes a register. Programming is not modelled, because the firmware must not program.
    pub fn write(&mut self, offset: u32, value: u32, at: &mut At<'_>) {
        match offset {
            FLASH_ACR => self.access = value,
            _ => at.breach(format!("FLASH: register 0x{offset:02x} written")),
        }
    }

    /// Number of wait states.
    #[must_use]
    pub fn latency(&self) -> u32 {
        self.access & 0b111
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    #[test]
    fn the_backup_domain_opens() {
        let mut pwr = Pwr::default();
        assert!(!pwr.backup_unlocked());
        assert!(breaches(0, |at| pwr.write(PWR_CR1, 0x300, at)).is_empty());
        assert!(pwr.backup_unlocked());
        assert_eq!(breaches(0, |at| pwr.write(PWR_CR1, 0x400, at)).len(), 1);
    }

    #[test]
    fn nobody_programs_the_flash() {
        let mut flash = Flash::default();
        assert!(breaches(0, |at| flash.write(FLASH_ACR, 0x602, at)).is_empty());
        assert_eq!(flash.latency(), 2);
        assert_eq!(breaches(0, |at| flash.write(0x08, 0x4567_0123, at)).len(), 1);
    }
}
