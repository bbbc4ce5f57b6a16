//! UART 0: a console for people, next to the console in files.
//!
//! A user may be connected or not. A reader that is too slow loses bytes, as on a real serial line,
//! and never delays the board.

use core::cell::RefCell;

use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use heapless::Deque;

use super::{Line, clock, read, write};

/// The CMSDK's UART: data, state, control, interrupt, baud rate divider.
const UART0: usize = 0x4000_4000;
const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CTRL: usize = 0x8;
const INT_CLEAR: usize = 0xC;
const BAUD_DIVIDER: usize = 0x10;
const TX_FULL: u32 = 1 << 0;
const RX_FULL: u32 = 1 << 1;
const ENABLE_TX_RX_AND_RX_INTERRUPT: u32 = 0b1011;
const RX_INTERRUPT: u32 = 1 << 1;

/// Divider for 115 200 baud; the emulator requires a value and ignores the speed.
const DIVIDER: u32 = super::CLOCK_HZ / 115_200;
/// Longest time that a byte waits for a slow reader, clock ticks: 1 ms.
const PATIENCE: u32 = super::CLOCK_HZ / 1000;

static TYPED: Mutex<RefCell<Deque<u8, 256>>> = Mutex::new(RefCell::new(Deque::new()));

/// The port.
#[derive(Debug)]
pub struct Uart;

impl Uart {
    /// Enables the UART.
    #[must_use]
    pub fn start() -> Self {
        write(UART0 + BAUD_DIVIDER, DIVIDER);
        write(UART0 + CTRL, ENABLE_TX_RX_AND_RX_INTERRUPT);
        // SAFETY: the handler below is in the vector table.
        unsafe { NVIC::unmask(Line::UART0_RX) };
        Self
    }

    /// The next typed byte.
    pub fn typed(&mut self) -> Option<u8> {
        critical_section::with(|cs| TYPED.borrow_ref_mut(cs).pop_front())
    }

    /// Sends bytes; those that the reader does not take in time are lost.
    pub fn show(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let start = clock();
            while read(UART0 + STATE) & TX_FULL != 0 {
                if clock().wrapping_sub(start) > PATIENCE {
                    return;
                }
            }
            write(UART0 + DATA, u32::from(byte));
        }
    }
}

/// Stores received bytes; those without room are lost.
pub(super) unsafe extern "C" fn on_receive() {
    write(UART0 + INT_CLEAR, RX_INTERRUPT);
    critical_section::with(|cs| {
        let mut typed = TYPED.borrow_ref_mut(cs);
        while read(UART0 + STATE) & RX_FULL != 0 {
            let _ = typed.push_back(read(UART0 + DATA) as u8);
        }
    });
}
