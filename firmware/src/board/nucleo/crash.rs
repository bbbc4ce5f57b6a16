//! The cause of a reset: the message of a panic or a fault is kept through it.

use core::mem::MaybeUninit;

use cortex_m_rt::ExceptionFrame;
use embassy_stm32::pac;
use heapless::String;

use super::stack;
use crate::text::{Hex, Out, Show};

/// A message, cut to the first 96 bytes.
pub type Words = String<96>;

const VALID: u32 = 0x464C_4F45;

#[repr(C)]
struct Crash {
    valid: u32,
    words: Words,
}

/// Message that the start-up code leaves untouched.
#[unsafe(link_section = ".uninit.crash")]
static mut CRASH: MaybeUninit<Crash> = MaybeUninit::uninit();

/// Stores a message and resets the board.
pub fn die(reason: &dyn Show) -> ! {
    cortex_m::interrupt::disable();
    let mut words = Words::new();
    reason.show(&mut Out::new(&mut words));
    // SAFETY: interrupts are off and nobody else runs: this is the only access.
    unsafe { (&raw mut CRASH).write(MaybeUninit::new(Crash { valid: VALID, words })) };
    cortex_m::peripheral::SCB::sys_reset()
}

/// Stores a message about a fault, its address or a stack overflow, and resets the board.
///
/// # Safety
/// `frame` is the stack pointer after the fault: it points to the frame that the processor pushed,
/// or would have pushed with enough room.
pub unsafe extern "C" fn fault(frame: *const ExceptionFrame) -> ! {
    if !stack::has_room_below(frame.cast()) {
        die(&"the stack ran over");
    }
    // SAFETY: there is room for the frame, so it lies within the stack.
    die(&("a fault at 0x", Hex(unsafe { (*frame).pc() }, 8)))
}

/// Cause of the reset, `None` after power-up. The message is cleared by the first call.
#[must_use]
pub fn last_words() -> Option<Words> {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    let crash = (&raw mut CRASH).cast::<Crash>();
    // SAFETY: nothing else runs before the tick starts. The message is read only if the mark shows
    // that this very program has written it.
    let words = unsafe {
        let valid = (&raw const (*crash).valid).read_volatile() == VALID;
        let powered = flags.borrstf();
        (&raw mut (*crash).valid).write_volatile(0);
        (valid && !powered).then(|| (&raw const (*crash).words).read())
    };
    words.or_else(|| {
        flags.iwdgrstf().then(|| Words::try_from("the watchdog: loop or tick hung"))?.ok()
    })
}
