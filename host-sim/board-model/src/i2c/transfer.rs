//! Transfers on the two wires: start, address and bytes, with the duration of their bits.

use super::{ARLO, AUTOEND, I2c, NACKF, READ, RELOAD, START, STOP, STOPF, TC, TCR};
use crate::rules::At;

/// Time added to every clock period on the wire (slopes, filters, synchronisation), ns, as in the
/// manual's examples for fast mode.
const SYNC_NS: f64 = 750.0;

/// The chips on the bus.
pub trait Target {
    /// Receives a start and an address; whether a chip acknowledges.
    fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool;
    /// Receives a byte from the master; whether it is acknowledged.
    fn write(&mut self, now_ns: u64, byte: u8) -> bool;
    /// Sends a byte to the master.
    fn read(&mut self, now_ns: u64) -> u8;
    /// Receives the stop.
    fn stop(&mut self, now_ns: u64);
}

/// Current state of the two wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wires {
    /// Both pins are assigned to the peripheral, as open drain.
    pub connected: bool,
    /// The data line is held low by a chip or a fault.
    pub data_held: bool,
    /// The clock line is held low.
    pub clock_held: bool,
}

/// State of the transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Idle,
    /// Start and address are on the wire, until this time, ns.
    Addressing(u64),
    /// The clock is held low until TXDR is written.
    WaitsForByte,
    Writing(u8, u64),
    Reading(u64),
    /// A byte has arrived before the previous one was read: the clock is held low.
    WaitsForRoom,
    /// The clock is held low until NBYTES, START or STOP is written.
    Complete,
    Stopping(u64),
}

impl I2c {
    /// A clock period on the wire, ns.
    pub(super) fn bit_ns(&self, at: &At<'_>) -> u64 {
        let prescaler = f64::from((self.timing >> 28) + 1);
        let counts = f64::from((self.timing & 0xFF) + 1 + (self.timing >> 8 & 0xFF) + 1);
        (counts * prescaler * 1e9 / at.clocks.pclk_hz + SYNC_NS) as u64
    }

    /// End of the current element on the wire, ns.
    #[must_use]
    pub fn next_change_ns(&self) -> Option<u64> {
        match self.state {
            State::Addressing(end_ns)
            | State::Writing(_, end_ns)
            | State::Reading(end_ns)
            | State::Stopping(end_ns) => Some(end_ns),
            State::Idle | State::WaitsForByte | State::WaitsForRoom | State::Complete => None,
        }
    }

    /// Advances the transfer to the current time.
    pub fn advance(&mut self, wires: Wires, target: &mut dyn Target, at: &At<'_>) {
        if wires.clock_held {
            return;
        }
        loop {
            let before = self.state;
            self.step(wires, target, at);
            if self.state == before {
                return;
            }
        }
    }

    // The other states wait for an access.
    #[allow(clippy::wildcard_enum_match_arm)]
    fn step(&mut self, wires: Wires, target: &mut dyn Target, at: &At<'_>) {
        let now_ns = at.now_ns;
        match self.state {
            State::Addressing(end) if end <= now_ns => {
                if wires.data_held {
                    return self.lose();
                }
                let read = self.cr2 & READ != 0;
                self.cr2 &= !START;
                let heard = target.start(end, (self.cr2 >> 1 & 0x7F) as u8, read);
                self.left = self.cr2 >> 16 & 0xFF;
                match (heard, read, self.left) {
                    (false, ..) => self.refused(end, at),
                    (.., 0) => self.part_done(end, at),
                    (_, true, _) => self.state = State::Reading(end + 9 * self.bit_ns(at)),
                    (_, false, _) => self.state = State::WaitsForByte,
                }
            }
            State::WaitsForByte => {
                if let Some(byte) = self.waiting.take() {
                    self.left -= 1;
                    self.state = State::Writing(byte, now_ns + 9 * self.bit_ns(at));
                }
            }
            State::Writing(_, end) if end <= now_ns && wires.data_held => self.lose(),
            State::Writing(byte, end) if end <= now_ns => {
                if !target.write(end, byte) {
                    return self.refused(end, at);
                }
                match self.waiting.take() {
                    _ if self.left == 0 => self.part_done(end, at),
                    Some(byte) => {
                        self.left -= 1;
                        self.state = State::Writing(byte, end + 9 * self.bit_ns(at));
                    }
                    None => self.state = State::WaitsForByte,
                }
            }
            State::Reading(end) if end <= now_ns => {
                if self.received.is_some() {
                    self.state = State::WaitsForRoom;
                    return;
                }
                self.take_byte(end, wires, target, at);
            }
            State::WaitsForRoom if self.received.is_none() => {
                self.take_byte(now_ns, wires, target, at);
            }
            State::Stopping(end) if end <= now_ns && !wires.data_held => {
                target.stop(end);
                self.flags |= STOPF;
                self.cr2 &= !STOP;
                self.state = State::Idle;
            }
            _ => {}
        }
    }

    fn take_byte(&mut self, now_ns: u64, wires: Wires, target: &mut dyn Target, at: &At<'_>) {
        let byte = target.read(now_ns);
        self.received = Some(if wires.data_held { 0 } else { byte });
        self.left -= 1;
        match self.left {
            0 => self.part_done(now_ns, at),
            _ => self.state = State::Reading(now_ns + 9 * self.bit_ns(at)),
        }
    }

    /// Handles the end of all bytes of NBYTES.
    fn part_done(&mut self, now_ns: u64, at: &At<'_>) {
        if self.cr2 & (RELOAD | AUTOEND) == AUTOEND || self.cr2 & STOP != 0 {
            self.state = State::Stopping(now_ns + 2 * self.bit_ns(at));
        } else {
            self.flags |= if self.cr2 & RELOAD != 0 { TCR } else { TC };
            self.state = State::Complete;
        }
    }

    /// Handles a missing acknowledge, after which the peripheral sends a stop.
    fn refused(&mut self, now_ns: u64, at: &At<'_>) {
        self.flags |= NACKF;
        self.waiting = None;
        self.state = State::Stopping(now_ns + 2 * self.bit_ns(at));
    }

    /// Handles a level on the wire other than the one sent (arbitration lost).
    fn lose(&mut self) {
        self.flags |= ARLO;
        self.cr2 &= !(START | STOP);
        self.waiting = None;
        self.state = State::Idle;
    }

    /// Starts a transfer.
    pub(super) fn begin(&mut self, wires: Wires, at: &mut At<'_>) {
        if !wires.connected {
            at.breach("I2C1: its pins are not given to it as open drain");
        }
        if self.timing == 0 {
            at.breach("I2C1: started without TIMINGR");
        }
        self.flags &= !(TC | TCR);
        self.state = State::Addressing(at.now_ns + 10 * self.bit_ns(at));
    }
}
