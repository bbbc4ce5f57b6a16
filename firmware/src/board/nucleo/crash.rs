//! Why the board started: the last words of a panic outlive the reset.

use core::mem::MaybeUninit;

use cortex_m_rt::ExceptionFrame;
use embassy_stm32::pac;
use heapless::String;

use super::stack;
use crate::text::{Hex, Out, Show};

/// The first of a panic's words.
pub type Words = String<96>;

const VALID: u32 = 0x464C_4F45;

#[repr(C)]
struct Crash {
    valid: u32,
    words: Words,
}

/// Not touched by the start-up code.
#[unsafe(link_section = ".uninit.crash")]
static mut CRASH: MaybeUninit<Crash> = MaybeUninit::uninit();

/// Leaves last words and starts the board again.
pub fn die(reason: &dyn Show) -> ! {
    cortex_m::interrupt::disable();
    let mut words = Words::new();
    reason.show(&mut Out::new(&mut words));
    // SAFETY: interrupts are off and nobody else runs: this is the only access.
    unsafe { (&raw mut CRASH).write(MaybeUninit::new(Crash { valid: VALID, words })) };
    cortex_m::peripheral::SCB::sys_reset()
}

/// Leaves word of a fault: of its place, or that the stack has run over.
///
/// # Safety
/// `frame` is where the stack ended when the fault came: what the processor has put there, or
/// would have if there had been room.
pub unsafe extern "C" fn fault(frame: *const ExceptionFrame) -> ! {
    if !stack::has_room_below(frame.cast()) {
        die(&"the stack ran over");
    }
    // SAFETY: it is in the stack.
    die(&("a fault at 0x", Hex(unsafe { (*frame).pc() }, 8)))
}

/// Why the board started, if not by power; asked once.
#[must_use]
pub fn last_words() -> Option<Words> {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    let crash = (&raw mut CRASH).cast::<Crash>();
    // SAFETY: before the tick starts nobody else runs. The words are only read
    // if the mark says that they were written, by this very program.
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
