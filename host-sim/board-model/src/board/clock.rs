//! For tests: a clock instead of an emulator.

use super::Emulator;
use crate::rtt::Memory;

/// What time it is, ns, and what the board has asked for.
#[derive(Default)]
pub(super) struct Clock {
    pub(super) now_ns: u64,
    /// Nothing is due before this: nobody may skip beyond it.
    pub(super) due_ns: u64,
    /// When the board wants to be woken.
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
