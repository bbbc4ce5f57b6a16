//! SPI2 as a master of eight bits, without DMA (RM0351, chapter 42).

use std::collections::VecDeque;

use crate::rules::At;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SR: u32 = 0x08;
const DR: u32 = 0x0C;

const CPHA_CPOL: u32 = 0b11;
const MSTR: u32 = 1 << 2;
const BR: u32 = 0b111 << 3;
const SPE: u32 = 1 << 6;
const LSBFIRST: u32 = 1 << 7;
const DS: u32 = 0xF << 8;
const EIGHT_BITS: u32 = 7 << 8;
const FRXTH: u32 = 1 << 12;

const RXNE: u32 = 1 << 0;
const TXE: u32 = 1 << 1;
const OVR: u32 = 1 << 6;
const BSY: u32 = 1 << 7;

/// Bytes in each of the two FIFOs.
const ROOM: usize = 4;

/// The device on the bus.
pub trait Slave {
    /// Exchanges a byte in eight clocks of this frequency; returns the device's byte.
    fn exchange(&mut self, byte: u8, clock_hz: f64, at: &mut At<'_>) -> u8;
}

/// The SPI peripheral.
#[derive(Debug, Default)]
pub struct Spi {
    cr1: u32,
    cr2: u32,
    to_send: VecDeque<u8>,
    /// The byte on the wire and the end of its transfer, ns.
    sending: Option<(u8, u64)>,
    received: VecDeque<u8>,
    overrun: bool,
}

impl Spi {
    /// Clock frequency on the wire, Hz.
    fn clock_hz(&self, at: &At<'_>) -> f64 {
        at.clocks.pclk_hz / f64::from(2 << ((self.cr1 & BR) >> 3))
    }

    fn byte_ns(&self, at: &At<'_>) -> u64 {
        (8e9 / self.clock_hz(at)) as u64
    }

    fn advance(&mut self, slave: &mut dyn Slave, at: &mut At<'_>) {
        while let Some((byte, end_ns)) = self.sending.filter(|&(_, end)| end <= at.now_ns) {
            let answer = slave.exchange(byte, self.clock_hz(at), at);
            if self.received.len() < ROOM {
                self.received.push_back(answer);
            } else {
                self.overrun = true;
            }
            let next = self.to_send.pop_front();
            self.sending = next.map(|byte| (byte, end_ns + self.byte_ns(at)));
        }
    }

    /// Reads a register; `size`: bytes.
    pub fn read(&mut self, offset: u32, size: u32, slave: &mut dyn Slave, at: &mut At<'_>) -> u32 {
        self.advance(slave, at);
        match offset {
            CR1 => self.cr1,
            CR2 => self.cr2,
            SR => self.status(),
            DR => {
                self.overrun = false;
                if self.received.is_empty() {
                    at.breach("SPI2: DR read while nothing has come");
                }
                // A 16-bit read takes two bytes.
                let mut take = || u32::from(self.received.pop_front().unwrap_or(0));
                if size == 1 { take() } else { take() | take() << 8 }
            }
            _ => 0,
        }
    }

    fn status(&self) -> u32 {
        let flag = |set: bool, bit: u32| u32::from(set) * bit;
        let threshold = if self.cr2 & FRXTH != 0 { 1 } else { 2 };
        let level = |queue: &VecDeque<u8>| (queue.len() as u32).min(3);
        flag(self.received.len() >= threshold, RXNE)
            | flag(self.to_send.len() <= ROOM / 2, TXE)
            | flag(self.overrun, OVR)
            | flag(self.sending.is_some(), BSY)
            | level(&self.received) << 9
            | level(&self.to_send) << 11
    }

    /// Writes a register; `size`: bytes; `pins`: whether all three pins are assigned to SPI2.
    pub fn write(
        &mut self,
        offset: u32,
        (size, value): (u32, u32),
        pins: bool,
        slave: &mut dyn Slave,
        at: &mut At<'_>,
    ) {
        self.advance(slave, at);
        let on = self.cr1 & SPE != 0;
        match offset {
            CR1 => {
                if on && (value ^ self.cr1) & (CPHA_CPOL | MSTR | BR | LSBFIRST) != 0 {
                    at.breach("SPI2: clock or mode changed while SPE is set");
                }
                if on && value & SPE == 0 && self.sending.is_some() {
                    at.breach("SPI2: switched off in the middle of a byte");
                }
                self.cr1 = value;
            }
            CR2 if on && (value ^ self.cr2) & (DS | FRXTH) != 0 => {
                at.breach("SPI2: data size changed while SPE is set");
            }
            CR2 => self.cr2 = value,
            DR => self.send(size, value, pins, at),
            SR => {}
            _ if value == 0 => {}
            _ => at.breach(format!("SPI2: register 0x{offset:02x} is not modelled")),
        }
    }

    fn send(&mut self, size: u32, value: u32, pins: bool, at: &mut At<'_>) {
        if self.cr1 & (SPE | MSTR) != SPE | MSTR || self.cr2 & DS != EIGHT_BITS {
            at.breach("SPI2: DR written while it is no master of eight bits, switched on");
        }
        if self.cr1 & (CPHA_CPOL | LSBFIRST) != 0 {
            at.breach("SPI2: a card wants mode 0, most significant bit first");
        }
        if size != 1 {
            at.breach("SPI2: DR written wider than a byte sends two");
        }
        if self.cr2 & FRXTH == 0 {
            at.breach("SPI2: FRXTH has to be set for bytes");
        }
        if !pins {
            at.breach("SPI2: its pins are not given to it");
        }
        let byte = value as u8;
        match self.sending {
            None => self.sending = Some((byte, at.now_ns + self.byte_ns(at))),
            Some(_) if self.to_send.len() < ROOM => self.to_send.push_back(byte),
            Some(_) => at.breach("SPI2: DR written while there is no room (TXE)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    struct Inverter;

    impl Slave for Inverter {
        fn exchange(&mut self, byte: u8, _: f64, _: &mut At<'_>) -> u8 {
            !byte
        }
    }

    fn started(divider: u32) -> Spi {
        let mut spi = Spi::default();
        let said = breaches(0, |at| {
            spi.write(CR2, (4, EIGHT_BITS | FRXTH), true, &mut Inverter, at);
            spi.write(CR1, (4, MSTR | divider << 3 | SPE), true, &mut Inverter, at);
        });
        assert!(said.is_empty());
        spi
    }

    fn read(spi: &mut Spi, now_ns: u64, offset: u32) -> (u32, Vec<String>) {
        let mut value = 0;
        let said = breaches(now_ns, |at| value = spi.read(offset, 1, &mut Inverter, at));
        (value, said)
    }

    #[test]
    fn a_byte_goes_and_another_comes() {
        let mut spi = started(0);
        let said = breaches(0, |at| spi.write(DR, (1, 0x0F), true, &mut Inverter, at));
        assert!(said.is_empty(), "{said:?}");
        assert_eq!(read(&mut spi, 999, SR).0 & (RXNE | BSY), BSY);
        assert_eq!(read(&mut spi, 1000, SR).0 & (RXNE | BSY), RXNE);
        assert_eq!(read(&mut spi, 1000, DR), (0xF0, vec![]));
        assert_eq!(read(&mut spi, 1000, DR).1.len(), 1);
    }

    #[test]
    fn what_nobody_fetches_overruns() {
        let mut spi = started(0);
        for n in 0..5 {
            breaches(n * 2000, |at| spi.write(DR, (1, 9), true, &mut Inverter, at));
        }
        assert_ne!(read(&mut spi, 20_000, SR).0 & OVR, 0);
    }

    #[test]
    fn what_the_manual_forbids() {
        let mut spi = started(5);
        let said = breaches(0, |at| {
            spi.write(CR1, (4, MSTR | SPE), true, &mut Inverter, at);
            (0..6).for_each(|_| spi.write(DR, (1, 9), true, &mut Inverter, at));
            spi.write(DR, (4, 9), false, &mut Inverter, at);
            spi.write(CR2, (4, 0), true, &mut Inverter, at);
            spi.write(CR1, (4, MSTR), true, &mut Inverter, at);
        });
        assert_eq!(said.len(), 6, "{said:?}");
        let mut off = Spi::default();
        let said = breaches(0, |at| off.write(DR, (1, 9), true, &mut Inverter, at));
        assert_eq!(said.len(), 2, "{said:?}");
    }
}
