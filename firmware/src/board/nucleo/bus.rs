//! The I²C bus shared by converter and display, with recovery from a chip that blocks it.

use core::cell::RefCell;

use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use embassy_stm32::i2c::{Error, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::pac::{self, Interrupt};
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{ErrorType, Operation};
use static_cell::StaticCell;

use super::clock::Delay;

/// The I²C peripheral.
pub(super) type Port = I2c<'static, Blocking, Master>;

/// Timing for 380 kHz from 16 MHz (RM0351, I2C master initialisation): SCLL 1.375 us, SCLH 0.5 us,
/// and 0.75 us of slopes and filters. Fast mode allows 400 kHz: the oscillator may run 5 % fast
/// until it is locked to the crystal.
const FAST_MODE: u32 = 0x1032_030A;

const SCL: usize = 8;
const SDA: usize = 9;
/// Number of clocks after which any chip releases the data line.
const CLOCKS: u32 = 9;
/// Half a period of 100 kHz, slow enough for every chip.
const HALF_US: u32 = 5;

type Place = Mutex<RefCell<Port>>;

/// Handle of the bus with exclusive transactions. A transaction delays the sampling interrupt only,
/// not the console.
#[derive(Clone, Copy)]
#[expect(missing_debug_implementations, reason = "the peripheral has none")]
pub struct Bus(&'static Place);

impl Bus {
    pub(super) fn new(port: Port) -> Self {
        static PLACE: StaticCell<Place> = StaticCell::new();
        pac::I2C1.cr1().modify(|w| w.set_pe(false));
        while pac::I2C1.cr1().read().pe() {}
        pac::I2C1.timingr().write(|w| w.0 = FAST_MODE);
        pac::I2C1.cr1().modify(|w| w.set_pe(true));
        Self(PLACE.init(Mutex::new(RefCell::new(port))))
    }
}

impl ErrorType for Bus {
    type Error = Error;
}

impl Bus {
    /// Runs one operation with exclusive access to the bus.
    fn alone(&self, deed: impl FnOnce(&mut Port) -> Result<(), Error>) -> Result<(), Error> {
        without_tick(|| {
            // SAFETY: only the main loop and the tick's interrupt use the bus. The interrupt runs
            // to its end before the main loop continues, and is masked while the main loop is in
            // here: this is the only borrow.
            let cs = unsafe { critical_section::CriticalSection::new() };
            let done = deed(&mut self.0.borrow_ref_mut(cs));
            if !matches!(done, Ok(()) | Err(Error::Nack)) {
                free();
            }
            done
        })
    }
}

/// Write and write-read, the operations of converter and display, use the port's own functions: a
/// tenth of the code for arbitrary sequences of operations.
impl embedded_hal::i2c::I2c for Bus {
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), Error> {
        self.alone(|port| port.blocking_write(address, bytes))
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], into: &mut [u8]) -> Result<(), Error> {
        self.alone(|port| port.blocking_write_read(address, bytes, into))
    }

    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        self.alone(|port| port.blocking_transaction(address, operations))
    }
}

/// Masks the sampling interrupt during `deed`; the caller may be that interrupt.
fn without_tick<R>(deed: impl FnOnce() -> R) -> R {
    let was_on = NVIC::is_enabled(Interrupt::LPTIM1);
    NVIC::mask(Interrupt::LPTIM1);
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    let result = deed();
    if was_on {
        // SAFETY: the interrupt was unmasked before.
        unsafe { NVIC::unmask(Interrupt::LPTIM1) };
    }
    result
}

/// Restarts the port and sends the clocks that a chip needs to finish an interrupted transfer.
#[cold]
fn free() {
    pac::I2C1.cr1().modify(|w| w.set_pe(false));
    while pac::I2C1.cr1().read().pe() {}
    let port = pac::GPIOB;
    let half = || Delay.delay_us(HALF_US);
    let set = |pin: usize, high: bool| {
        port.bsrr().write(|w| if high { w.set_bs(pin, true) } else { w.set_br(pin, true) });
    };
    [SCL, SDA].into_iter().for_each(|pin| set(pin, true));
    give_pins(Moder::OUTPUT);
    half();
    for _ in 0..CLOCKS {
        if is_high(SDA) {
            break;
        }
        set(SCL, false);
        half();
        set(SCL, true);
        half();
    }
    // Stop condition: data rises while the clock is high.
    for (pin, high) in [(SCL, false), (SDA, false), (SCL, true), (SDA, true)] {
        set(pin, high);
        half();
    }
    give_pins(Moder::ALTERNATE);
    pac::I2C1.cr1().modify(|w| w.set_pe(true));
}

fn is_high(pin: usize) -> bool {
    pac::GPIOB.idr().read().idr(pin) == pac::gpio::vals::Idr::HIGH
}

fn give_pins(mode: Moder) {
    pac::GPIOB.moder().modify(|w| {
        w.set_moder(SCL, mode);
        w.set_moder(SDA, mode);
    });
}
