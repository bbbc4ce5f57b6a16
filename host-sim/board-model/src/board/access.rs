//! Reads and writes of the peripherals, by address.

use super::{Board, Emulator};
use crate::i2c::Wires as Lines;
use crate::patience::Patience;
use crate::rcc::{AHB1, AHB2, APB1};
use crate::rules::At;

const TIM2: u32 = 0x4000_0000;
const RTC: u32 = 0x4000_2800;
const IWDG: u32 = 0x4000_3000;
const SPI2: u32 = 0x4000_3800;
const USART2: u32 = 0x4000_4400;
const I2C1: u32 = 0x4000_5400;
const PWR: u32 = 0x4000_7000;
const LPTIM1: u32 = 0x4000_7C00;
const RCC: u32 = 0x4002_1000;
const FLASH: u32 = 0x4002_2000;
const GPIOA: u32 = 0x4800_0000;
const GPIOB: u32 = 0x4800_0400;

/// Base addresses of the peripherals, 1 KiB each (RM0351, table 1).
pub const BASES: [u32; 12] =
    [TIM2, RTC, IWDG, SPI2, USART2, I2C1, PWR, LPTIM1, RCC, FLASH, GPIOA, GPIOB];

/// Enable register and bit of a peripheral's clock; `None` if the clock is always on.
fn gate(base: u32) -> Option<(u32, u32)> {
    Some(match base {
        TIM2 => (APB1, 0),
        SPI2 => (APB1, 14),
        USART2 => (APB1, 17),
        I2C1 => (APB1, 21),
        PWR => (APB1, 28),
        LPTIM1 => (APB1, 31),
        FLASH => (AHB1, 8),
        GPIOA => (AHB2, 0),
        GPIOB => (AHB2, 1),
        _ => return None,
    })
}

/// Pins of the board: converter and display, card, console.
const SCL: u32 = 8;
const SDA: u32 = 9;
const CARD_SELECT: u32 = 12;
const CARD_DATA: u32 = 14;

/// The context of an access, built while the peripheral is borrowed as well.
macro_rules! at {
    ($board:ident, $now_ns:ident) => {
        &mut At { now_ns: $now_ns, clocks: $board.clocks, rules: &mut $board.rules }
    };
}
pub(super) use at;

impl Board {
    /// Reads a register; `None`: bus error. A program that polls a flag gets the next change at
    /// once, and the time skips to it, without thousands of equal answers.
    pub fn read(
        &mut self,
        emulator: &mut dyn Emulator,
        base: u32,
        offset: u32,
        size: u32,
    ) -> Option<u32> {
        let value = self.read_now(emulator, base, offset, size)?;
        if base == TIM2 || !self.patience.asks_again(base + offset, value) {
            return Some(value);
        }
        let Some(change_ns) = self.next_change_ns(base) else { return Some(value) };
        emulator.skip_to(change_ns);
        self.read_now(emulator, base, offset, size)
    }

    /// Time of the next change that a polling program may wait for, ns. The card's bus is left out:
    /// its bytes are shorter than two polls.
    fn next_change_ns(&self, base: u32) -> Option<u64> {
        match base {
            USART2 => self.usart.next_change_ns(),
            I2C1 => self.i2c.next_change_ns(),
            _ => None,
        }
    }

    fn read_now(
        &mut self,
        emulator: &mut dyn Emulator,
        base: u32,
        offset: u32,
        size: u32,
    ) -> Option<u32> {
        let now_ns = emulator.now_ns();
        if self.failing == Some(base) {
            return None;
        }
        self.follow_clocks(now_ns);
        if !self.clocked(base, now_ns) {
            return Some(0);
        }
        let lines = self.lines(now_ns);
        let value = match base {
            TIM2 => self.tim2.read(offset, at!(self, now_ns)),
            RTC => self.rtc.read(offset, at!(self, now_ns)),
            IWDG => self.iwdg.read(offset, at!(self, now_ns)),
            SPI2 => self.spi.read(offset, size, &mut self.slot, at!(self, now_ns)),
            USART2 => self.usart.read(offset, at!(self, now_ns)),
            I2C1 => self.i2c.read(offset, lines, &mut self.wires, at!(self, now_ns)),
            PWR => self.pwr.read(offset),
            LPTIM1 => {
                self.lptim.advance(at!(self, now_ns));
                self.lptim.read(offset, at!(self, now_ns))
            }
            RCC => self.rcc.read(offset, at!(self, now_ns)),
            FLASH => self.flash.read(offset),
            GPIOA => self.port_a.read(offset, 0xFFFF),
            _ => self.port_b.read(offset, 0xFFFF & !(u32::from(lines.data_held) << SDA)),
        };
        if matches!(base, USART2 | LPTIM1) {
            self.settle(emulator, now_ns);
        }
        Some(value)
    }

    /// Writes a register; `false`: bus error.
    pub fn write(
        &mut self,
        emulator: &mut dyn Emulator,
        base: u32,
        offset: u32,
        (size, value): (u32, u32),
    ) -> bool {
        let now_ns = emulator.now_ns();
        self.patience = Patience::default();
        if self.failing == Some(base) {
            return false;
        }
        self.follow_clocks(now_ns);
        if !self.clocked(base, now_ns) {
            return true;
        }
        let lines = self.lines(now_ns);
        let unlocked = self.pwr.backup_unlocked();
        match base {
            TIM2 => self.tim2.write(offset, value, at!(self, now_ns)),
            RTC => self.rtc.write(offset, value, unlocked, at!(self, now_ns)),
            IWDG => self.iwdg.write(offset, value, at!(self, now_ns)),
            SPI2 => {
                let pins = (13..=15).all(|pin| self.port_b.has_function(pin, 5));
                let slot = &mut self.slot;
                self.spi.write(offset, (size, value), pins, slot, at!(self, now_ns));
            }
            USART2 => {
                let pins = (2..=3).all(|pin| self.port_a.has_function(pin, 7));
                self.usart.write(offset, value, pins, at!(self, now_ns));
            }
            I2C1 => self.i2c.write(offset, value, lines, &mut self.wires, at!(self, now_ns)),
            PWR => self.pwr.write(offset, value, at!(self, now_ns)),
            LPTIM1 => {
                self.lptim.advance(at!(self, now_ns));
                self.lptim.write(offset, value, at!(self, now_ns));
            }
            RCC => self.write_rcc(offset, value, now_ns),
            FLASH => self.flash.write(offset, value, at!(self, now_ns)),
            GPIOA => self.port_a.write(offset, value),
            _ => self.write_port_b(offset, value, now_ns),
        }
        // The script may count from the converter's first sample, which a write on I2C1 starts.
        if matches!(base, USART2 | LPTIM1 | RCC | IWDG | I2C1) {
            self.settle(emulator, now_ns);
        }
        true
    }

    fn clocked(&mut self, base: u32, now_ns: u64) -> bool {
        let Some((register, bit)) = gate(base) else { return true };
        let at = At { now_ns, clocks: self.clocks, rules: &mut self.rules };
        let (enabled, fresh) =
            (self.rcc.enabled(register, bit), self.rcc.too_fresh(register, bit, &at));
        if !enabled {
            at.rules.breach(now_ns, format!("0x{base:08x}: touched without its clock"));
        } else if fresh {
            let what = "touched within two clocks of its enable, which was not read back";
            at.rules.breach(now_ns, format!("0x{base:08x}: {what}"));
        }
        enabled && !fresh
    }

    fn lines(&mut self, now_ns: u64) -> Lines {
        let is_given = |pin| self.port_b.has_function(pin, 4) && self.port_b.is_open_drain(pin);
        let connected = is_given(SCL) && is_given(SDA);
        Lines { connected, data_held: self.wires.is_held(now_ns), clock_held: false }
    }

    fn write_rcc(&mut self, offset: u32, value: u32, now_ns: u64) {
        let (unlocked, latency) = (self.pwr.backup_unlocked(), self.flash.latency());
        self.rcc.write(offset, value, unlocked, latency, at!(self, now_ns));
        if let Some((register, bits)) = self.rcc.take_asserted() {
            let asserted =
                |base| gate(base).is_some_and(|(r, bit)| r == register && bits >> bit & 1 != 0);
            BASES.into_iter().filter(|&base| asserted(base)).for_each(|base| self.reset_one(base));
        }
        self.follow_clocks(now_ns);
    }

    /// Resets a peripheral to its initial state.
    pub(super) fn reset_one(&mut self, base: u32) {
        match base {
            TIM2 => self.tim2.reset(),
            SPI2 => self.spi = Default::default(),
            USART2 => self.usart.reset(),
            I2C1 => self.i2c = Default::default(),
            PWR => self.pwr = Default::default(),
            LPTIM1 => self.lptim = Default::default(),
            FLASH => self.flash = Default::default(),
            GPIOA => self.port_a = crate::gpio::Gpio::new(crate::gpio::Name::A),
            GPIOB => {
                self.port_b = crate::gpio::Gpio::new(crate::gpio::Name::B);
                self.slot.reset();
            }
            RTC => self.rtc.reset(),
            IWDG => self.iwdg = Default::default(),
            _ => {}
        }
    }

    fn write_port_b(&mut self, offset: u32, value: u32, now_ns: u64) {
        let clock_was_low = self.port_b.drives_low(SCL);
        self.port_b.write(offset, value);
        if clock_was_low && !self.port_b.drives_low(SCL) {
            self.wires.clock();
        }
        self.slot.pulled_up = self.port_b.is_pulled_up(CARD_DATA);
        let selected = self.port_b.drives_low(CARD_SELECT);
        if selected != self.slot.selected {
            self.slot.select(selected, at!(self, now_ns));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::clock::Clock;
    use crate::run::Setup;

    /// Time before which no event is due, ns.
    const DUE_NS: u64 = 50_000_000;

    const ISR: u32 = 0x1C;
    const TC: u32 = 1 << 6;
    const TXE: u32 = 1 << 7;

    /// A board with a character on the wire.
    fn sending() -> (Board, Clock) {
        let mut board = Board::new(Setup::quiet()).unwrap();
        let mut clock = Clock { now_ns: 1000, due_ns: DUE_NS, ..Clock::default() };
        let writes = [(RCC, 0x58, 1 << 17), (USART2, 0x0C, 35), (USART2, 0, 9), (USART2, 0x28, 65)];
        for (base, offset, value) in writes {
            assert!(board.write(&mut clock, base, offset, (4, value)));
            // The enable takes some time.
            clock.now_ns += 10_000;
        }
        (board, clock)
    }

    #[test]
    fn who_asks_again_gets_the_answer_when_it_changes() {
        let (mut board, mut clock) = sending();
        let before_ns = clock.now_ns;
        let first = board.read(&mut clock, USART2, ISR, 4).unwrap();
        assert_eq!((first & (TXE | TC), clock.now_ns), (TXE, before_ns));
        // A read of the clock does not interrupt the polling.
        board.read(&mut clock, TIM2, 0x24, 4);
        let second = board.read(&mut clock, USART2, ISR, 4).unwrap();
        assert_eq!(second & TC, TC);
        let waited_ns = clock.now_ns - before_ns;
        assert!((60_000..90_000).contains(&waited_ns), "{waited_ns}");
    }

    #[test]
    fn what_is_due_before_comes_first() {
        let (mut board, mut clock) = sending();
        clock.now_ns = DUE_NS;
        board.write(&mut clock, USART2, 0x28, (4, 66));
        let ask = |board: &mut Board, clock: &mut Clock| board.read(clock, USART2, ISR, 4).unwrap();
        assert_eq!(ask(&mut board, &mut clock) & TC, 0);
        assert_eq!(ask(&mut board, &mut clock) & TC, 0);
        assert_eq!(clock.now_ns, DUE_NS);
    }
}
