//! Console on USART2; an interrupt collects the typed characters.

use core::cell::RefCell;

use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::{self, Interrupt, interrupt};
use embassy_stm32::usart::{Error, Uart, UartTx};
use embedded_io::{ErrorType, Read, ReadReady, Write};
use heapless::Deque;

use crate::console::LOST;

static TYPED: Mutex<RefCell<Deque<u8, 128>>> = Mutex::new(RefCell::new(Deque::new()));

/// The serial port.
#[expect(missing_debug_implementations, reason = "the peripheral has none")]
pub struct Console {
    tx: UartTx<'static, Blocking>,
}

impl Console {
    pub(super) fn new(uart: Uart<'static, Blocking>) -> Self {
        let (tx, rx) = uart.split();
        // The receiver stays on for ever; the driver is not needed beyond its registers.
        core::mem::forget(rx);
        pac::USART2.cr1().modify(|w| w.set_rxneie(true));
        // SAFETY: the handler below is in the vector table.
        unsafe { NVIC::unmask(Interrupt::USART2) };
        Self { tx }
    }
}

#[interrupt]
fn USART2() {
    let flags = pac::USART2.isr().read();
    if flags.rxne() {
        let byte = pac::USART2.rdr().read().dr() as u8;
        // Characters that are not fetched in time are lost (128 characters are a long line). The
        // newest stored one is replaced by a mark.
        critical_section::with(|cs| {
            let mut typed = TYPED.borrow_ref_mut(cs);
            if typed.push_back(byte).is_err()
                && let Some(newest) = typed.back_mut()
            {
                *newest = LOST;
            }
        });
    }
    pac::USART2.icr().write(|w| {
        w.set_ore(true);
        w.set_fe(true);
        w.set_ne(true);
        w.set_pe(true);
    });
}

impl ErrorType for Console {
    type Error = Error;
}

impl ReadReady for Console {
    fn read_ready(&mut self) -> Result<bool, Error> {
        Ok(critical_section::with(|cs| !TYPED.borrow_ref(cs).is_empty()))
    }
}

impl Read for Console {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Error> {
        let Some(slot) = buffer.first_mut() else { return Ok(0) };
        let byte = critical_section::with(|cs| TYPED.borrow_ref_mut(cs).pop_front());
        *slot = byte.unwrap_or(0);
        Ok(usize::from(byte.is_some()))
    }
}

impl Write for Console {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Error> {
        self.tx.blocking_write(bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.tx.blocking_flush()
    }
}
