//! NUCLEO-L476RG: the board that a user programs.
//!
//! | function | peripheral | pins (Arduino name) |
//! |---|---|---|
//! | sampling tick | LPTIM1 on the 32 768 Hz crystal | - |
//! | clock, 1 MHz | TIM2 | - |
//! | time of day, kept through resets | RTC, on the same crystal | - |
//! | converter, display | I2C1, 400 kHz | PB8 SCL (D15), PB9 SDA (D14) |
//! | SD card | SPI2 | PB13 SCK, PB14 MISO, PB15 MOSI, PB12 CS |
//! | console | USART2, 115 200 baud, the ST-LINK's USB | PA2, PA3 |
//! | watchdog | IWDG, 10 s | - |

pub mod bus;
pub mod calendar;
pub mod card;
pub mod clock;
pub mod console;
pub mod crash;
mod watchdog;

use embassy_stm32::gpio::{Level, Output, Pull, Speed};
use embassy_stm32::i2c::{self, I2c};
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::usart::{self, Uart};
use embassy_stm32::{Peripherals, rcc};
use embassy_time::Duration;

use super::stack;
use bus::Bus;
use card::CardSlot;
use console::Console;
pub use watchdog::Watchdog;

/// Time limit of a transfer: the longest, 65 bytes for the display, takes 1.5 ms.
const I2C_LIMIT: Duration = Duration::from_millis(4);

/// The board's peripherals, handed to `main`.
#[expect(missing_debug_implementations, reason = "the peripherals have none")]
pub struct Board {
    /// The I²C bus of converter and display.
    pub bus: Bus,
    /// The SD card.
    pub card: CardSlot,
    /// The serial console.
    pub console: Console,
    /// The watchdog.
    pub watchdog: Watchdog,
}

impl Board {
    /// Starts clocks and peripherals, except the tick ([`clock::start_tick`]).
    #[must_use]
    pub fn init() -> Self {
        // Embassy does not use the core's own peripherals.
        let Some(mut core) = cortex_m::Peripherals::take() else {
            // First call since the reset.
            unreachable!()
        };
        stack::guard(&core.MPU);
        let p = embassy_stm32::init(clocks());
        clock::start();
        clock::start_crystal(&mut core.SYST);
        Self::with(p)
    }

    fn with(p: Peripherals) -> Self {
        let mut config = i2c::Config::default();
        config.timeout = I2C_LIMIT;
        let i2c = I2c::new_blocking(p.I2C1, p.PB8, p.PB9, config);

        let mut config = spi::Config::default();
        // The pull-up makes an empty slot read as no answer.
        config.miso_pull = Pull::Up;
        let spi = Spi::new_blocking(p.SPI2, p.PB13, p.PB15, p.PB14, config);
        let select = Output::new(p.PB12, Level::High, Speed::Medium);

        let uart = match Uart::new_blocking(p.USART2, p.PA3, p.PA2, usart::Config::default()) {
            Ok(uart) => uart,
            // 115 200 baud from 16 MHz is a valid configuration.
            Err(_) => unreachable!(),
        };
        Self {
            bus: Bus::new(i2c),
            card: CardSlot::new(spi, select),
            console: Console::new(uart),
            watchdog: Watchdog::new(),
        }
    }
}

/// 16 MHz from the internal oscillator, which is locked to the crystal as soon as the crystal runs;
/// this function does not wait for it. If crystal and calendar run since before a reset, they are
/// left untouched.
fn clocks() -> embassy_stm32::Config {
    let mut config = embassy_stm32::Config::default();
    config.rcc.msi = Some(rcc::MSIRange::RANGE16M);
    config.rcc.sys = rcc::Sysclk::MSI;
    config.rcc.ls = rcc::LsConfig::off();
    if clock::calendar_runs() {
        config.rcc.ls = rcc::LsConfig::default_lse();
        config.rcc.mux.rtcsel = rcc::mux::Rtcsel::LSE;
    }
    config.rcc.mux.lptim1sel = rcc::mux::Lptim1sel::LSE;
    config
}
