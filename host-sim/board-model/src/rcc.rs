//! Reset and clock control (RM0351, chapter 6), the parts that a board without an
//! external oscillator uses: MSI, HSI16, LSE, the enables, the reset causes.

use crate::rules::{At, Clocks};

/// Causes of a reset: bits of `CSR`.
pub mod cause {
    /// The reset pin, which every reset pulls.
    pub const PIN: u32 = 1 << 26;
    /// Power-up or brown-out.
    pub const POWER: u32 = 1 << 27;
    /// A request of the program.
    pub const SOFTWARE: u32 = 1 << 28;
    /// The independent watchdog.
    pub const WATCHDOG: u32 = 1 << 29;
}

const CR: u32 = 0x00;
const CFGR: u32 = 0x08;
const FIRST_RESET: u32 = 0x28;
const LAST_RESET: u32 = 0x40;
/// `AHB1ENR`.
pub const AHB1: u32 = 0x48;
/// `AHB2ENR`.
pub const AHB2: u32 = 0x4C;
/// `APB1ENR1`.
pub const APB1: u32 = 0x58;
const LAST_ENABLE: u32 = 0x60;
const CCIPR: u32 = 0x88;
const BDCR: u32 = 0x90;
const CSR: u32 = 0x94;

const MSIPLLEN: u32 = 1 << 2;
const HSION: u32 = 1 << 8;
const HSIRDY: u32 = 1 << 10;
const LSEON: u32 = 1 << 0;
const LSERDY: u32 = 1 << 1;
const RTCSEL: u32 = 0b11 << 8;
const RTCEN: u32 = 1 << 15;
const BDRST: u32 = 1 << 16;
const CAUSES: u32 = 0xFF << 24;
const LSION: u32 = 1 << 0;
const RMVF: u32 = 1 << 23;

/// Start-up time of HSI16, ns (data sheet: at most 4.5 us to stable).
const HSI_START_NS: u64 = 4_500;
const CRYSTAL_HZ: f64 = 32_768.0;

/// Properties of the oscillators.
#[derive(Clone, Copy, Debug)]
pub struct Oscillators {
    /// Time that the crystal takes to start, ns; `None`: it never starts.
    pub crystal_start_ns: Option<u64>,
    /// Relative error of the MSI while it is not locked to the crystal.
    pub msi_error: f64,
    /// Relative error of HSI16.
    pub hsi_error: f64,
}

/// The RCC peripheral.
#[derive(Debug)]
pub struct Rcc {
    oscillators: Oscillators,
    registers: [u32; 0x28],
    hsi_since_ns: Option<u64>,
    lse_since_ns: Option<u64>,
    /// Enable register, bits and time of the last enable, until read back. The peripheral's clock
    /// may not run for two periods after it, unless the register is read.
    fresh: Option<(u32, u32, u64)>,
    /// Peripherals whose reset bit was just set: register and bits.
    asserted: Option<(u32, u32)>,
}

impl Rcc {
    /// The state after power-up.
    #[must_use]
    pub fn new(oscillators: Oscillators) -> Self {
        let mut rcc = Self {
            oscillators,
            registers: [0; 0x28],
            hsi_since_ns: None,
            lse_since_ns: None,
            fresh: None,
            asserted: None,
        };
        rcc.reset(cause::POWER | cause::PIN);
        rcc
    }

    /// Resets everything except the backup domain; the cause is added to those not cleared yet.
    pub fn reset(&mut self, cause: u32) {
        let (backup, causes) = (self.register(BDCR), self.register(CSR) & CAUSES);
        self.registers = [0; 0x28];
        *self.slot(CR) = 0x63;
        *self.slot(AHB1) = 0x100;
        *self.slot(BDCR) = backup;
        *self.slot(CSR) = causes | cause | 6 << 8;
        (self.hsi_since_ns, self.fresh) = (None, None);
    }

    /// Clears the backup domain after a loss of its supply.
    pub fn lose_backup(&mut self) {
        *self.slot(BDCR) = 0;
        *self.slot(CSR) = 0;
        self.lse_since_ns = None;
    }

    fn slot(&mut self, offset: u32) -> &mut u32 {
        &mut self.registers[(offset as usize / 4).min(0x27)]
    }

    fn register(&self, offset: u32) -> u32 {
        self.registers.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32, at: &mut At<'_>) -> u32 {
        if self.fresh.is_some_and(|(register, ..)| register == offset) {
            self.fresh = None;
        }
        let value = self.register(offset);
        match offset {
            CR => value | (u32::from(self.hsi_runs(at.now_ns)) * HSIRDY),
            CFGR => value & !0b1100 | (value & 0b11) << 2,
            BDCR => value | (u32::from(self.lse_runs(at.now_ns)) * LSERDY),
            // The watchdog's oscillator runs while the watchdog does.
            CSR => value | (value & LSION) << 1,
            _ => value,
        }
    }

    /// Writes a register; `unlocked`: `PWR_CR1.DBP`; `latency`: wait states of the flash.
    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        unlocked: bool,
        latency: u32,
        at: &mut At<'_>,
    ) {
        let before = self.register(offset);
        match offset {
            CR => self.write_cr(before, value, at),
            BDCR if !unlocked => at.breach("RCC: BDCR written while the backup domain is locked"),
            BDCR => self.write_bdcr(before, value, at),
            CSR => {
                let kept = if value & RMVF != 0 { 0 } else { before & CAUSES };
                *self.slot(CSR) = kept | value & 0xF01;
            }
            AHB1..=LAST_ENABLE => {
                *self.slot(offset) = value;
                if value & !before != 0 {
                    self.fresh = Some((offset, value & !before, at.now_ns));
                }
            }
            FIRST_RESET..=LAST_RESET => {
                *self.slot(offset) = value;
                self.asserted = Some((offset + (AHB1 - FIRST_RESET), value & !before));
            }
            _ => *self.slot(offset) = value,
        }
        let clocks = self.clocks(at.now_ns);
        if offset == CFGR || offset == CR {
            self.check_speed(&clocks, latency, at);
        }
    }

    fn write_cr(&mut self, before: u32, value: u32, at: &mut At<'_>) {
        if value & MSIPLLEN & !before != 0 && !self.lse_runs(at.now_ns) {
            at.breach("RCC: MSIPLLEN set before the crystal is ready");
        }
        if value & HSION == 0 {
            self.hsi_since_ns = None;
        } else if self.hsi_since_ns.is_none() {
            self.hsi_since_ns = Some(at.now_ns);
        }
        if value & 1 == 0 && self.register(CFGR) & 0b11 == 0 {
            at.breach("RCC: MSI switched off while it is the system clock");
        }
        *self.slot(CR) = value & !HSIRDY | 2;
    }

    fn write_bdcr(&mut self, before: u32, value: u32, at: &mut At<'_>) {
        if value & BDRST != 0 {
            *self.slot(BDCR) = BDRST;
            self.lse_since_ns = None;
            return;
        }
        if before & RTCSEL != 0 && before & BDRST == 0 && (value ^ before) & RTCSEL != 0 {
            at.breach("RCC: RTCSEL changed without a reset of the backup domain");
        }
        if value & LSEON == 0 {
            self.lse_since_ns = None;
        } else if self.lse_since_ns.is_none() {
            self.lse_since_ns = Some(at.now_ns);
        }
        *self.slot(BDCR) = value & !LSERDY;
    }

    fn check_speed(&mut self, clocks: &Clocks, latency: u32, at: &mut At<'_>) {
        if self.register(CFGR) & 0b11 > 1 || self.register(CFGR) & 0x3FF0 != 0 {
            at.breach("RCC: a clock that this model does not have (PLL, HSE or a divider)");
        }
        // Table 9, range 1: one wait state per 16 MHz.
        if clocks.pclk_hz > 16.8e6 * f64::from(latency + 1) {
            at.breach("FLASH: too few wait states for this clock");
        }
    }

    /// Returns and clears the peripherals that were just put into reset: enable register and bits.
    pub fn take_asserted(&mut self) -> Option<(u32, u32)> {
        self.asserted.take()
    }

    /// Whether a peripheral's clock is on: register and bit.
    #[must_use]
    pub fn enabled(&self, register: u32, bit: u32) -> bool {
        self.register(register) >> bit & 1 != 0
    }

    /// Whether a peripheral's clock was enabled less than two periods ago and not read back.
    #[must_use]
    pub fn too_fresh(&self, register: u32, bit: u32, at: &At<'_>) -> bool {
        self.fresh.is_some_and(|(fresh, bits, since_ns)| {
            fresh == register && bits >> bit & 1 != 0 && at.now_ns < since_ns + at.clocks.pclk_ns(2)
        })
    }

    fn hsi_runs(&self, now_ns: u64) -> bool {
        self.hsi_since_ns.is_some_and(|since| now_ns >= since + HSI_START_NS)
    }

    fn lse_runs(&self, now_ns: u64) -> bool {
        match (self.lse_since_ns, self.oscillators.crystal_start_ns) {
            (Some(since), Some(start)) => now_ns >= since + start,
            _ => false,
        }
    }

    /// The current clocks.
    #[must_use]
    pub fn clocks(&self, now_ns: u64) -> Clocks {
        let lse_hz = self.lse_runs(now_ns).then_some(CRYSTAL_HZ);
        let hsi_hz = self.hsi_runs(now_ns).then_some(16e6 * (1.0 + self.oscillators.hsi_error));
        let pclk_hz = match self.register(CFGR) & 0b11 {
            1 => hsi_hz.unwrap_or(16e6),
            _ => self.msi_hz(lse_hz.is_some()),
        };
        let lptim_hz = match self.register(CCIPR) >> 18 & 0b11 {
            0 => Some(pclk_hz),
            2 => hsi_hz,
            3 => lse_hz,
            _ => None,
        };
        let backup = self.register(BDCR);
        let rtc_hz = if backup & RTCEN != 0 && backup & RTCSEL == 1 << 8 { lse_hz } else { None };
        Clocks { pclk_hz, hsi_hz, lse_hz, lptim_hz, rtc_hz }
    }

    /// Frequency of the MSI by the data sheet's table: nominal, or locked to the crystal.
    fn msi_hz(&self, crystal: bool) -> f64 {
        const NOMINAL: [f64; 12] =
            [0.1e6, 0.2e6, 0.4e6, 0.8e6, 1e6, 2e6, 4e6, 8e6, 16e6, 24e6, 32e6, 48e6];
        const PERIODS: [f64; 12] =
            [3.0, 6.0, 12.0, 24.0, 31.0, 61.0, 122.0, 244.0, 488.0, 732.0, 977.0, 1465.0];
        let cr = self.register(CR);
        // MSIRGSEL: the range in CR, else the one after standby.
        let range = if cr & 1 << 3 != 0 { cr >> 4 & 0xF } else { 6 };
        let range = range.min(11) as usize;
        if cr & MSIPLLEN != 0 && crystal {
            return PERIODS[range] * CRYSTAL_HZ;
        }
        NOMINAL[range] * (1.0 + self.oscillators.msi_error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::Rules;
    use crate::rules::tests::RUNNING;

    const MS: u64 = 1_000_000;

    fn rcc(start_ns: Option<u64>) -> (Rcc, Rules) {
        let oscillators =
            Oscillators { crystal_start_ns: start_ns, msi_error: 0.01, hsi_error: 0.0 };
        (Rcc::new(oscillators), Rules::default())
    }

    fn write(rcc: &mut Rcc, rules: &mut Rules, now_ns: u64, offset: u32, value: u32) {
        rcc.write(offset, value, true, 0, &mut At { now_ns, clocks: RUNNING, rules });
    }

    #[test]
    fn the_crystal_takes_its_time_and_keeps_the_msi_in_step() {
        let (mut rcc, mut rules) = rcc(Some(2000 * MS));
        write(&mut rcc, &mut rules, 0, CR, 0x80 | 0b1011);
        assert_eq!(rcc.clocks(0).pclk_hz.round() as u32, 16_160_000);
        write(&mut rcc, &mut rules, 5, BDCR, LSEON);
        assert_eq!(rcc.clocks(1999 * MS).lse_hz, None);
        write(&mut rcc, &mut rules, 2001 * MS, CR, 0x80 | 0b1111);
        assert_eq!(rcc.clocks(2001 * MS).pclk_hz.round() as u32, 15_990_784);
        assert_eq!(rules.said(), [""; 0]);
    }

    #[test]
    fn what_the_manual_forbids() {
        let (mut rcc, mut rules) = rcc(None);
        write(&mut rcc, &mut rules, 0, CR, 0x6F);
        rcc.write(BDCR, 1, false, 0, &mut At { now_ns: 0, clocks: RUNNING, rules: &mut rules });
        write(&mut rcc, &mut rules, 0, CR, 0xA0 | 0b1011);
        let said = rules.said().join(";");
        for word in ["MSIPLLEN", "locked", "wait states"] {
            assert!(said.contains(word), "{word}: {said}");
        }
    }

    #[test]
    fn a_clock_needs_two_periods_or_a_read_back() {
        let (mut rcc, mut rules) = rcc(None);
        write(&mut rcc, &mut rules, 0, APB1, 1);
        let mut at = At { now_ns: 60, clocks: RUNNING, rules: &mut rules };
        assert!(rcc.enabled(APB1, 0) && rcc.too_fresh(APB1, 0, &at));
        assert_eq!(rcc.read(APB1, &mut at), 1);
        assert!(!rcc.too_fresh(APB1, 0, &at));
        write(&mut rcc, &mut rules, 1000, APB1, 3);
        let at = At { now_ns: 1125, clocks: RUNNING, rules: &mut rules };
        assert!(!rcc.too_fresh(APB1, 1, &at));
    }

    #[test]
    fn causes_stay_until_they_are_cleared_and_the_backup_domain_stays_anyway() {
        let (mut rcc, mut rules) = rcc(Some(0));
        write(&mut rcc, &mut rules, 0, BDCR, LSEON | 1 << 8 | RTCEN);
        rcc.reset(cause::WATCHDOG | cause::PIN);
        let mut at = At { now_ns: 9, clocks: RUNNING, rules: &mut rules };
        assert_eq!(rcc.read(CSR, &mut at) & CAUSES, cause::POWER | cause::PIN | cause::WATCHDOG);
        assert_eq!(rcc.clocks(9).rtc_hz, Some(32_768.0));
        write(&mut rcc, &mut rules, 9, CSR, RMVF);
        let mut at = At { now_ns: 9, clocks: RUNNING, rules: &mut rules };
        assert_eq!(rcc.read(CSR, &mut at) & CAUSES, 0);
        rcc.lose_backup();
        assert_eq!(rcc.clocks(9).rtc_hz, None);
    }
}
