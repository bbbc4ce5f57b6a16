//! I2C1 as a master (RM0351, chapter 39), with the timing of every bit.

use crate::rules::At;

mod transfer;

use transfer::State;
pub use transfer::{Target, Wires};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const OAR1: u32 = 0x08;
const OAR2: u32 = 0x0C;
const TIMINGR: u32 = 0x10;
const TIMEOUTR: u32 = 0x14;
const ISR: u32 = 0x18;
const ICR: u32 = 0x1C;
const RXDR: u32 = 0x24;
const TXDR: u32 = 0x28;

const PE: u32 = 1 << 0;
const READ: u32 = 1 << 10;
const START: u32 = 1 << 13;
const STOP: u32 = 1 << 14;
const RELOAD: u32 = 1 << 24;
const AUTOEND: u32 = 1 << 25;

const TXE: u32 = 1 << 0;
const TXIS: u32 = 1 << 1;
const RXNE: u32 = 1 << 2;
const NACKF: u32 = 1 << 4;
const STOPF: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TCR: u32 = 1 << 7;
const ARLO: u32 = 1 << 9;
const BUSY: u32 = 1 << 15;
/// The flags that ICR clears.
const CLEARABLE: u32 = NACKF | STOPF | 1 << 8 | ARLO | 1 << 10;

/// Frequency limit of fast mode with a margin for rounding, Hz.
const FASTEST_HZ: f64 = 400_500.0;

/// The I2C peripheral.
#[derive(Debug)]
pub struct I2c {
    cr1: u32,
    cr2: u32,
    timing: u32,
    flags: u32,
    state: State,
    /// Bytes of the transfer that are still to come.
    left: u32,
    waiting: Option<u8>,
    received: Option<u8>,
    /// Time at which PE was cleared, until it is read back.
    off_since_ns: Option<u64>,
}

impl Default for I2c {
    fn default() -> Self {
        Self {
            cr1: 0,
            cr2: 0,
            timing: 0,
            flags: 0,
            state: State::Idle,
            left: 0,
            waiting: None,
            received: None,
            off_since_ns: None,
        }
    }
}

impl I2c {
    #[allow(clippy::wildcard_enum_match_arm)] // only these two ask for a byte
    fn status(&self, wires: Wires) -> u32 {
        let flag = |set: bool, bit: u32| u32::from(set) * bit;
        let on = self.cr1 & PE != 0;
        let wants = match self.state {
            State::WaitsForByte => true,
            // A new byte may be requested while one is on the wire.
            State::Writing(..) => self.left > 0,
            _ => false,
        };
        let busy = self.state != State::Idle || wires.data_held || wires.clock_held;
        self.flags
            | flag(self.waiting.is_none(), TXE)
            | flag(wants && self.waiting.is_none(), TXIS)
            | flag(self.received.is_some(), RXNE)
            | flag(on && busy, BUSY)
    }

    /// Reads a register.
    pub fn read(
        &mut self,
        offset: u32,
        wires: Wires,
        target: &mut dyn Target,
        at: &mut At<'_>,
    ) -> u32 {
        self.advance(wires, target, at);
        match offset {
            CR1 => {
                self.off_since_ns = None;
                self.cr1
            }
            CR2 => self.cr2,
            TIMINGR => self.timing,
            ISR => self.status(wires),
            RXDR => match self.received.take() {
                Some(byte) => {
                    self.advance(wires, target, at);
                    byte.into()
                }
                None => {
                    at.breach("I2C1: RXDR read while it is empty");
                    0
                }
            },
            _ => 0,
        }
    }

    /// Writes a register.
    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        wires: Wires,
        target: &mut dyn Target,
        at: &mut At<'_>,
    ) {
        self.advance(wires, target, at);
        match offset {
            CR1 => self.write_cr1(value, target, at),
            CR2 => self.write_cr2(value, wires, at),
            TIMINGR if self.cr1 & PE != 0 => at.breach("I2C1: TIMINGR written while PE is set"),
            TIMINGR => {
                self.timing = value;
                let hz = 1e9 / self.bit_ns(at) as f64;
                if hz > FASTEST_HZ {
                    at.breach(format!("I2C1: {hz:.0} Hz is faster than fast mode"));
                }
            }
            // Only TXE and TXIS can be written: they empty TXDR.
            ISR => {
                if value & TXE != 0 {
                    self.waiting = None;
                }
            }
            ICR => self.flags &= !(value & CLEARABLE),
            TXDR if self.status(wires) & TXIS == 0 => at.breach("I2C1: TXDR written without TXIS"),
            TXDR => {
                self.waiting = Some(value as u8);
                self.advance(wires, target, at);
            }
            OAR1 | OAR2 | TIMEOUTR if value == 0 => {}
            _ => at.breach(format!("I2C1: register 0x{offset:02x} is not modelled")),
        }
    }

    fn write_cr1(&mut self, value: u32, target: &mut dyn Target, at: &mut At<'_>) {
        if value & PE == 0 && self.cr1 & PE != 0 {
            target.stop(at.now_ns);
            let timing = self.timing;
            let off_since_ns = Some(at.now_ns);
            *self = Self { timing, off_since_ns, ..Self::default() };
        }
        let low_ns = self.off_since_ns.map(|since| at.now_ns - since);
        if value & PE != 0 && low_ns.is_some_and(|low| low < at.clocks.pclk_ns(3)) {
            at.breach("I2C1: PE has to stay low for three clocks, or to be read back");
        }
        self.cr1 = value;
    }

    fn write_cr2(&mut self, value: u32, wires: Wires, at: &mut At<'_>) {
        if self.cr1 & PE == 0 {
            return at.breach("I2C1: CR2 written while PE is clear");
        }
        if self.cr2 & START != 0 && (value ^ self.cr2) & 0xFF_07FF != 0 {
            at.breach("I2C1: address or NBYTES changed while START is set");
        }
        let transfer = self.state;
        self.cr2 = value;
        if value & START != 0 && matches!(transfer, State::Idle | State::Complete) {
            self.begin(wires, at);
        } else if transfer == State::Complete && value & STOP != 0 {
            self.flags &= !(TC | TCR);
            self.state = State::Stopping(at.now_ns + 2 * self.bit_ns(at));
        } else if transfer == State::Complete && self.flags & TCR != 0 {
            self.flags &= !TCR;
            self.left = value >> 16 & 0xFF;
            self.state = if value & READ != 0 {
                State::Reading(at.now_ns + 9 * self.bit_ns(at))
            } else {
                State::WaitsForByte
            };
        } else if transfer == State::Idle && value & STOP != 0 {
            // There is no transfer to stop.
            self.cr2 &= !STOP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    const FREE: Wires = Wires { connected: true, data_held: false, clock_held: false };
    const HELD: Wires = Wires { data_held: true, ..FREE };
    /// The manual's example for 400 kHz from 16 MHz.
    const FAST: u32 = 0x1032_0309;

    #[derive(Default)]
    struct Memory(Vec<u8>);

    impl Target for Memory {
        fn start(&mut self, _: u64, address: u8, _: bool) -> bool {
            address == 0x40
        }
        fn write(&mut self, _: u64, byte: u8) -> bool {
            self.0.push(byte);
            true
        }
        fn read(&mut self, _: u64) -> u8 {
            self.0.pop().unwrap_or(0xFF)
        }
        fn stop(&mut self, _: u64) {}
    }

    struct Bench(I2c, Memory, u64);

    impl Bench {
        fn new() -> Self {
            let mut bench = Self(I2c::default(), Memory::default(), 0);
            assert!(bench.write(TIMINGR, FAST).is_empty());
            assert!(bench.write(CR1, PE).is_empty());
            bench
        }
        fn write(&mut self, offset: u32, value: u32) -> Vec<String> {
            breaches(self.2, |at| self.0.write(offset, value, FREE, &mut self.1, at))
        }
        fn flags(&mut self, wires: Wires) -> u32 {
            let mut flags = 0;
            breaches(self.2, |at| flags = self.0.read(ISR, wires, &mut self.1, at));
            flags
        }
    }

    fn request(address: u32, bytes: u32, more: u32) -> u32 {
        address << 1 | bytes << 16 | START | more
    }

    #[test]
    fn a_write_and_a_read_take_their_bits() {
        let mut bench = Bench::new();
        assert!(bench.write(CR2, request(0x40, 1, 0)).is_empty());
        bench.2 = 24_999;
        assert_eq!(bench.flags(FREE) & TXIS, 0);
        bench.2 = 25_000;
        assert_ne!(bench.flags(FREE) & TXIS, 0);
        assert!(bench.write(TXDR, 7).is_empty());
        assert_eq!(bench.flags(FREE) & TXIS, 0);
        bench.2 += 22_500;
        assert_ne!(bench.flags(FREE) & TC, 0);
        assert!(bench.write(CR2, request(0x40, 1, READ | AUTOEND)).is_empty());
        bench.2 += 25_000 + 22_500;
        assert_ne!(bench.flags(FREE) & RXNE, 0);
        let mut byte = 0;
        let said = breaches(bench.2, |at| byte = bench.0.read(RXDR, FREE, &mut bench.1, at));
        assert_eq!((byte, said.len()), (7, 0));
        bench.2 += 5_000;
        assert_eq!(bench.flags(FREE), TXE | STOPF);
    }

    #[test]
    fn nobody_there_is_a_nack_and_a_stop() {
        let mut bench = Bench::new();
        bench.write(CR2, request(0x3C, 1, 0));
        bench.2 = 25_000;
        assert_eq!(bench.flags(FREE), TXE | NACKF | BUSY);
        bench.2 = 30_000;
        assert_eq!(bench.flags(FREE), TXE | NACKF | STOPF);
    }

    #[test]
    fn a_held_data_line_is_lost_arbitration_and_a_stop_that_never_comes() {
        let mut bench = Bench::new();
        bench.write(CR2, request(0x40, 1, 0));
        bench.2 = 25_000;
        assert_eq!(bench.flags(HELD) & (ARLO | BUSY), ARLO | BUSY);
        let mut bench = Bench::new();
        bench.write(CR2, request(0x3C, 1, 0));
        bench.2 = 25_000;
        bench.flags(FREE);
        bench.2 = 9_000_000;
        assert_eq!(bench.flags(HELD) & (STOPF | BUSY), BUSY);
        bench.write(CR1, 0);
        assert_eq!(bench.flags(FREE), TXE);
    }

    #[test]
    fn what_the_manual_forbids() {
        let mut bench = Bench::new();
        assert_eq!(bench.write(TXDR, 1), ["I2C1: TXDR written without TXIS"]);
        assert_eq!(bench.write(TIMINGR, 0).len(), 1);
        bench.write(CR2, request(0x40, 1, 0));
        assert_eq!(bench.write(CR2, request(0x40, 2, 0)).len(), 1);
        assert_eq!(bench.write(CR1, 0).len(), 0);
        assert_eq!(bench.write(CR1, PE).len(), 1, "PE low for too short");
        bench.write(CR1, 0);
        assert_eq!(bench.write(TIMINGR, 0x0010_0309).len(), 1, "too fast");
        assert_eq!(bench.write(CR2, 0).len(), 1, "PE is off");
    }
}
