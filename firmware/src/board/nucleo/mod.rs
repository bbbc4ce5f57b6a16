//! NUCLEO-L476RG: the board that a user flashes.
//!
//! | job | peripheral | pins (Arduino name) |
//! |---|---|---|
//! | sampling tick | LPTIM1 on the 32 768 Hz crystal | - |
//! | clock, 1 MHz | TIM2 | - |
//! | converter, display | I2C1, 400 kHz | PB8 SCL (D15), PB9 SDA (D14) |
//! | SD card | SPI2 | PB13 SCK, PB14 MISO, PB15 MOSI, PB12 CS |
//! | console | USART2, 115 200 baud, the ST-LINK's USB | PA2, PA3 |
//! | watchdog | IWDG, 10 s | - |

pub mod clock;
pub mod console;
pub mod crash;

use core::cell::RefCell;

use critical_section::Mutex;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::i2c::{self, I2c, Master};
use embassy_stm32::mode::Blocking;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, Uart};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peripherals, rcc};
use embassy_time::Duration;
use embedded_hal_bus::spi::ExclusiveDevice;
use embedded_sdmmc::SdCard;
use static_cell::StaticCell;

use super::stack;
use clock::Delay;
use console::Console;

/// The bus that converter and display share; each transaction has it alone.
pub type SharedI2c = Mutex<RefCell<I2c1>>;
/// That bus.
pub type I2c1 = I2c<'static, Blocking, Master>;
/// The card in its slot.
pub type Card = SdCard<
    ExclusiveDevice<Spi<'static, Blocking, spi::mode::Master>, Output<'static>, Delay>,
    Delay,
>;

/// The watchdog.
pub type Watchdog = IndependentWatchdog<'static, IWDG>;

/// Longest time on the bus that is not a fault: the display's 65 bytes take 1.5 ms.
const I2C_LIMIT: Duration = Duration::from_millis(4);
/// Longer than the longest pause of a card, shorter than a user's patience.
const WATCHDOG_US: u32 = 10_000_000;

/// What `main` gets.
#[expect(missing_debug_implementations, reason = "the peripherals have none")]
pub struct Board {
    /// For converter and display.
    pub i2c: &'static SharedI2c,
    /// The SD card.
    pub card: Card,
    /// The serial line.
    pub console: Console,
    /// Resets the board unless it is petted.
    pub watchdog: Watchdog,
}

impl Board {
    /// Starts clocks and peripherals; the tick is started by [`clock::start_tick`].
    #[must_use]
    pub fn init() -> Self {
        // Embassy leaves the core's own peripherals to us.
        if let Some(core) = cortex_m::Peripherals::take() {
            stack::guard(&core.MPU);
        }
        let p = embassy_stm32::init(clocks());
        clock::start();
        Self::with(p)
    }

    fn with(p: Peripherals) -> Self {
        static I2C: StaticCell<SharedI2c> = StaticCell::new();
        let mut config = i2c::Config::default();
        config.frequency = Hertz::khz(400);
        config.timeout = I2C_LIMIT;
        let i2c = I2c::new_blocking(p.I2C1, p.PB8, p.PB9, config);

        // The card is slow until it has been set up.
        let mut config = spi::Config::default();
        config.frequency = Hertz::khz(400);
        let spi = Spi::new_blocking(p.SPI2, p.PB13, p.PB15, p.PB14, config);
        let select = Output::new(p.PB12, Level::High, Speed::Medium);
        let device = match ExclusiveDevice::new(spi, select, Delay) {
            Ok(device) => device,
            Err(never) => match never {},
        };
        let card = SdCard::new(device, Delay);
        speed_up(&card);

        let uart = match Uart::new_blocking(p.USART2, p.PA3, p.PA2, usart::Config::default()) {
            Ok(uart) => uart,
            // 115 200 baud from 16 MHz is a valid configuration.
            Err(_) => unreachable!(),
        };
        Self {
            i2c: I2C.init(Mutex::new(RefCell::new(i2c))),
            card,
            console: Console::new(uart),
            watchdog: IndependentWatchdog::new(p.IWDG, WATCHDOG_US),
        }
    }
}

/// 16 MHz from the internal oscillator, which the crystal keeps in step.
fn clocks() -> embassy_stm32::Config {
    let mut config = embassy_stm32::Config::default();
    config.rcc.msi = Some(rcc::MSIRange::RANGE16M);
    config.rcc.sys = rcc::Sysclk::MSI;
    config.rcc.ls = rcc::LsConfig::default_lse();
    config.rcc.mux.lptim1sel = rcc::mux::Lptim1sel::LSE;
    config
}

/// A card that has answered may be clocked at 8 MHz.
fn speed_up(card: &Card) {
    if card.num_bytes().is_ok() {
        let mut config = spi::Config::default();
        config.frequency = Hertz::mhz(8);
        // The divider exists: 16 MHz over two.
        let _ = card.spi(|device| device.bus_mut().set_config(&config));
    }
}
