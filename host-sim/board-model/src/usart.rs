//! USART2 with 8N1 frames and the duration of each character (RM0351, chapter 40).

use std::collections::VecDeque;

use crate::rules::At;

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const CR3: u32 = 0x08;
const BRR: u32 = 0x0C;
const RQR: u32 = 0x18;
const ISR: u32 = 0x1C;
const ICR: u32 = 0x20;
const RDR: u32 = 0x24;
const TDR: u32 = 0x28;

const UE: u32 = 1 << 0;
const RE: u32 = 1 << 2;
const TE: u32 = 1 << 3;
const RXNEIE: u32 = 1 << 5;
const ORE: u32 = 1 << 3;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;
const TEACK: u32 = 1 << 21;
const REACK: u32 = 1 << 22;

/// Baud rate of the PC, and the largest relative deviation that it can receive.
const BAUD: f64 = 115_200.0;
const TOLERANCE: f64 = 0.02;

/// The port and the wires to the PC.
#[derive(Debug, Default)]
pub struct Usart {
    control: [u32; 3],
    divider: u32,
    overrun: bool,
    received: Option<u8>,
    /// The waiting character, and the one on the wire with the end of its transfer, ns.
    waiting: Option<u8>,
    sending: Option<(u8, u64)>,
    /// Typed characters not sent yet, and the arrival of the one on the wire, ns.
    typed: VecDeque<u8>,
    arrives_ns: Option<u64>,
    /// Characters received by the PC.
    pub said: Vec<u8>,
    /// Time of each line feed, ns.
    pub line_ends_ns: Vec<u64>,
    /// Typed characters that the firmware did not fetch in time.
    pub lost: u32,
}

impl Usart {
    /// Resets the port; the transfer of typed characters continues.
    pub fn reset(&mut self) {
        let (typed, said) = (std::mem::take(&mut self.typed), std::mem::take(&mut self.said));
        let (line_ends_ns, lost) = (std::mem::take(&mut self.line_ends_ns), self.lost);
        let arrives_ns = self.arrives_ns;
        *self = Self { typed, said, line_ends_ns, lost, arrives_ns, ..Self::default() };
    }

    /// Appends text that the PC sends without pauses.
    pub fn type_in(&mut self, text: &[u8], at: &mut At<'_>) {
        self.typed.extend(text);
        if self.arrives_ns.is_none() && !self.typed.is_empty() {
            self.arrives_ns = Some(at.now_ns + Self::wire_ns());
        }
    }

    /// Duration of a character from the PC, ten bits, ns.
    fn wire_ns() -> u64 {
        (10.0 * 1e9 / BAUD) as u64
    }

    fn character_ns(&self, at: &At<'_>) -> u64 {
        at.clocks.pclk_ns(10 * self.divider.max(16))
    }

    /// Arrival of the next character, ns.
    #[must_use]
    pub fn deadline_ns(&self) -> Option<u64> {
        self.arrives_ns
    }

    /// End of the character on the wire, ns.
    #[must_use]
    pub fn next_change_ns(&self) -> Option<u64> {
        self.sending.map(|(_, end_ns)| end_ns)
    }

    /// Whether the interrupt line is active.
    #[must_use]
    pub fn interrupt(&self) -> bool {
        self.control[0] & RXNEIE != 0 && (self.received.is_some() || self.overrun)
    }

    /// Advances the port to the current time.
    pub fn advance(&mut self, at: &mut At<'_>) {
        while let Some((byte, end_ns)) = self.sending.filter(|&(_, end)| end <= at.now_ns) {
            self.said.push(byte);
            if byte == b'\n' {
                self.line_ends_ns.push(end_ns);
            }
            let next = self.waiting.take();
            self.sending = next.map(|byte| (byte, end_ns + self.character_ns(at)));
        }
        while let Some(end_ns) = self.arrives_ns.filter(|&end| end <= at.now_ns) {
            if let Some(byte) = self.typed.pop_front() {
                self.receive(byte);
            }
            let more = !self.typed.is_empty();
            self.arrives_ns = more.then_some(end_ns + Self::wire_ns());
        }
    }

    fn receive(&mut self, byte: u8) {
        if self.control[0] & (UE | RE) != UE | RE {
            self.lost += 1;
        } else if self.received.is_some() {
            self.overrun = true;
            self.lost += 1;
        } else {
            self.received = Some(byte);
        }
    }

    /// Reads a register.
    pub fn read(&mut self, offset: u32, at: &mut At<'_>) -> u32 {
        self.advance(at);
        match offset {
            CR1 | CR2 | CR3 => self.control[offset as usize / 4],
            BRR => self.divider,
            ISR => self.flags(),
            RDR => match self.received.take() {
                Some(byte) => byte.into(),
                None => {
                    at.breach("USART2: RDR read while it is empty");
                    0
                }
            },
            _ => 0,
        }
    }

    fn flags(&self) -> u32 {
        let on = self.control[0] & UE != 0;
        let flag = |set: bool, bit: u32| u32::from(set) * bit;
        flag(self.overrun, ORE)
            | flag(self.received.is_some(), RXNE)
            | flag(self.waiting.is_none(), TXE)
            | flag(self.waiting.is_none() && self.sending.is_none(), TC)
            | flag(on && self.control[0] & TE != 0, TEACK)
            | flag(on && self.control[0] & RE != 0, REACK)
    }

    /// Writes a register; `pins`: whether TX and RX are assigned to USART2.
    pub fn write(&mut self, offset: u32, value: u32, pins: bool, at: &mut At<'_>) {
        self.advance(at);
        let enabled = self.control[0] & UE != 0;
        match offset {
            BRR if enabled => at.breach("USART2: BRR written while it is enabled"),
            BRR => self.divider = value & 0xFFFF,
            CR2 | CR3 if enabled && value != self.control[offset as usize / 4] => {
                at.breach("USART2: CR2 or CR3 changed while it is enabled");
            }
            CR1 | CR2 | CR3 => self.control[offset as usize / 4] = value,
            ICR => self.overrun &= value & ORE == 0,
            RQR => {}
            TDR => self.send(value as u8, pins, at),
            _ => at.breach(format!("USART2: register 0x{offset:02x} is not modelled")),
        }
    }

    fn send(&mut self, byte: u8, pins: bool, at: &mut At<'_>) {
        if self.control[0] & (UE | TE) != UE | TE {
            return at.breach("USART2: TDR written while the transmitter is off");
        }
        if !pins {
            at.breach("USART2: its pins are not given to it");
        }
        let baud = at.clocks.pclk_hz / f64::from(self.divider.max(1));
        if (baud / BAUD - 1.0).abs() > TOLERANCE {
            at.breach(format!("USART2: {baud:.0} baud, the PC listens at {BAUD}"));
        }
        match (&self.sending, &self.waiting) {
            (None, _) => self.sending = Some((byte, at.now_ns + self.character_ns(at))),
            (Some(_), None) => self.waiting = Some(byte),
            (Some(_), Some(_)) => at.breach("USART2: TDR written without TXE"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    fn port() -> Usart {
        let mut port = Usart::default();
        let said = breaches(0, |at| {
            port.write(BRR, 139, true, at);
            port.write(CR1, UE | RE | TE | RXNEIE, true, at);
        });
        assert!(said.is_empty());
        port
    }

    #[test]
    fn characters_take_their_time() {
        let mut port = port();
        let said = breaches(0, |at| {
            port.write(TDR, 65, true, at);
            assert_ne!(port.read(ISR, at) & TXE, 0);
            port.write(TDR, 66, true, at);
            assert_eq!(port.read(ISR, at) & (TXE | TC), 0);
        });
        assert!(said.is_empty(), "{said:?}");
        breaches(86_875, |at| assert_eq!(port.read(ISR, at) & (TXE | TC), TXE));
        breaches(173_750, |at| assert_eq!(port.read(ISR, at) & TC, TC));
        assert_eq!(port.said, b"AB");
    }

    #[test]
    fn what_nobody_fetches_is_lost() {
        let mut port = port();
        breaches(0, |at| port.type_in(b"xyz", at));
        breaches(100_000, |at| {
            port.advance(at);
            assert!(port.interrupt());
            assert_eq!(port.read(RDR, at), u32::from(b'x'));
            assert!(!port.interrupt());
        });
        breaches(400_000, |at| port.advance(at));
        assert_eq!((port.lost, port.received, port.overrun), (1, Some(b'y'), true));
    }

    #[test]
    fn what_the_manual_forbids() {
        let mut port = port();
        let said = breaches(0, |at| {
            port.write(BRR, 16, true, at);
            port.read(RDR, at);
            (0..3).for_each(|_| port.write(TDR, 1, false, at));
        });
        assert_eq!(said.len(), 4, "{said:?}");
        let mut slow = Usart::default();
        let said = breaches(0, |at| {
            slow.write(TDR, 1, true, at);
            slow.write(BRR, 100, true, at);
            slow.write(CR1, UE | TE, true, at);
            slow.write(TDR, 1, true, at);
        });
        assert_eq!(said.len(), 2, "{said:?}");
    }
}
