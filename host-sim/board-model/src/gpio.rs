//! A port of general-purpose pins (RM0351, chapter 8).

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const PUPDR: u32 = 0x0C;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;
const BRR: u32 = 0x28;

/// Name of a port; the ports differ in their debug pins after a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// PA13 to PA15 are debug pins.
    A,
    /// PB3, PB4 are debug pins.
    B,
}

/// The registers of a port.
#[derive(Debug)]
pub struct Gpio {
    registers: [u32; 12],
}

impl Gpio {
    /// The state after a reset.
    #[must_use]
    pub fn new(name: Name) -> Self {
        let mut registers = [0; 12];
        let (moder, pupdr) = match name {
            Name::A => (0xABFF_FFFF, 0x6400_0000),
            Name::B => (0xFFFF_FEBF, 0x0000_0100),
        };
        (registers[0], registers[3]) = (moder, pupdr);
        Self { registers }
    }

    /// Reads a register; `outside`: levels of the wires if the port drives none.
    #[must_use]
    pub fn read(&self, offset: u32, outside: u32) -> u32 {
        if offset == IDR { self.levels(outside) } else { self.register(offset) }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) {
        let out = &mut self.registers[ODR as usize / 4];
        match offset {
            BSRR => *out = *out & !(value >> 16) | value & 0xFFFF,
            BRR => *out &= !value,
            IDR => {}
            _ => {
                if let Some(slot) = self.registers.get_mut(offset as usize / 4) {
                    *slot = value;
                }
            }
        }
    }

    fn register(&self, offset: u32) -> u32 {
        self.registers.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// 0 input, 1 output, 2 alternate function, 3 analogue.
    #[must_use]
    pub fn mode(&self, pin: u32) -> u32 {
        self.register(MODER) >> (2 * pin) & 0b11
    }

    /// Whether a pin is assigned to this alternate function.
    #[must_use]
    pub fn has_function(&self, pin: u32, function: u32) -> bool {
        let register = if pin < 8 { AFRL } else { AFRH };
        self.mode(pin) == 2 && self.register(register) >> (4 * (pin % 8)) & 0xF == function
    }

    /// Whether a pin is open drain.
    #[must_use]
    pub fn is_open_drain(&self, pin: u32) -> bool {
        self.register(OTYPER) >> pin & 1 != 0
    }

    /// Whether a pin has its pull-up on.
    #[must_use]
    pub fn is_pulled_up(&self, pin: u32) -> bool {
        self.register(PUPDR) >> (2 * pin) & 0b11 == 1
    }

    /// Whether the port itself drives a pin low.
    #[must_use]
    pub fn drives_low(&self, pin: u32) -> bool {
        self.mode(pin) == 1 && self.register(ODR) >> pin & 1 == 0
    }

    fn levels(&self, outside: u32) -> u32 {
        let level = |pin: u32| {
            let high = outside >> pin & 1 != 0;
            match self.mode(pin) {
                1 if self.drives_low(pin) => false,
                1 if !self.is_open_drain(pin) => true,
                3 => false,
                _ => high,
            }
        };
        (0..16).map(|pin| u32::from(level(pin)) << pin).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_drain_pin_pulls_down_or_lets_go() {
        let mut port = Gpio::new(Name::B);
        assert_eq!((port.mode(12), port.mode(3)), (3, 2));
        port.write(MODER, 0b01 << 16);
        port.write(OTYPER, 1 << 8);
        port.write(BSRR, 1 << 8);
        assert_eq!(port.read(IDR, 0) >> 8 & 1, 0);
        assert_eq!(port.read(IDR, 1 << 8) >> 8 & 1, 1);
        port.write(BRR, 1 << 8);
        assert!(port.drives_low(8));
        assert_eq!(port.read(IDR, 1 << 8) >> 8 & 1, 0);
        port.write(BSRR, 1 << 24 | 1 << 9);
        assert_eq!(port.read(ODR, 0), 1 << 9);
    }

    #[test]
    fn functions_are_four_bits_a_pin() {
        let mut port = Gpio::new(Name::A);
        port.write(MODER, 0b10 << 28 | 0b10 << 4);
        port.write(AFRH, 5 << 24);
        port.write(AFRL, 7 << 8);
        assert!(port.has_function(14, 5) && port.has_function(2, 7));
        assert!(!port.has_function(14, 4) && !port.has_function(3, 7));
        port.write(PUPDR, 0b01 << 28);
        assert!(port.is_pulled_up(14) && !port.is_pulled_up(13));
    }
}
