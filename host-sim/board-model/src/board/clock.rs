//! A clock for tests, in place of the emulator.

use super::Emulator;
use crate::rtt::Memory;

/// Current time, ns, and the requests of the board.
#[derive(Default)]
pub(super) struct Clock {
    pub(super) now_ns: u64,
    /// Time of the next due event, ns; skipping stops there.
    pub(super) due_ns: u64,
    /// Time at which the board asked to be woken, ns.
    pub(super) wanted_ns: u64,
}

impl Memory for Clock {
    fn read(&mut self, _: u32, _: &mut [u8]) {}
    fn write(&mut self, _: u32, _: &[u8]) {}
}

impl Emulator for Clock {
    fn now_ns(&self) -> u64 {
        self.now_ns
    }
    fn set_interrupt(&mut self, _: u32, _: bool) {}
    fn skip_to(&mut self, when_ns: u64) {
        self.now_ns = when_ns.min(self.due_ns).max(self.now_ns);
    }
    fn wake_at(&mut self, when_ns: u64) {
        self.wanted_ns = when_ns;
    }
    fn move_stack(&mut self, _: u32) {}
    fn restart(&mut self) {}
    fn finish(&mut self) {}
}
