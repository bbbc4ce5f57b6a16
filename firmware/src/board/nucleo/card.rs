//! The SD card in its slot; a card may be inserted and removed at any time.

use core::cell::Cell;

use embassy_stm32::gpio::Output;
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::SPI2;
use embassy_stm32::pac::spi::vals::Br;
use embassy_stm32::spi::{self, Spi};
use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiBus, SpiDevice};
use embedded_sdmmc::sdcard::spi::AcquireOpts;
use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx, SdCard};

use super::clock::{Delay, clock};

/// 250 kHz from 16 MHz until a card is ready; the specification allows 400 kHz at most.
const SLOW: Br = Br::DIV64;
/// 8 MHz afterwards.
const FAST: Br = Br::DIV2;
/// 80 clocks; the specification requires 74 before the first command.
const WAKE_BYTES: [u8; 10] = [0xFF; 10];
/// CMD0 with its checksum.
const GO_IDLE: [u8; 6] = [0x40, 0, 0, 0, 0, 0x95];
/// Number of bytes within which any card answers a command.
const ANSWER_BYTES: usize = 10;
/// Time limit for each request to a card, us: the specification allows 1 s for start-up and 0.5 s
/// for a write.
const LIMIT_US: u32 = 1_000_000;

/// The SPI bus, on which the card is the only device. Chip select stays low once the card is awake:
/// the specification forbids it to rise within a transaction, and the driver splits a transaction
/// into many.
struct CardBus {
    spi: Spi<'static, Blocking, spi::mode::Master>,
    select: Output<'static>,
    /// Time of the clock at the start of the current request, us.
    since: u32,
}

/// Error: the bus failed, or the card exceeded the time limit.
#[derive(Clone, Copy, Debug)]
struct Failed;

impl Error for Failed {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for CardBus {
    type Error = Failed;
}

impl SpiDevice for CardBus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Failed> {
        if clock().wrapping_sub(self.since) > LIMIT_US {
            return Err(Failed);
        }
        for operation in operations {
            match operation {
                Operation::Read(bytes) => self.spi.read(bytes),
                Operation::Write(bytes) => self.spi.write(bytes),
                Operation::Transfer(read, write) => self.spi.transfer(read, write),
                Operation::TransferInPlace(bytes) => self.spi.transfer_in_place(bytes),
                Operation::DelayNs(_) => Ok(()),
            }
            .map_err(|_| Failed)?;
        }
        SpiBus::<u8>::flush(&mut self.spi).map_err(|_| Failed)
    }
}

impl CardBus {
    /// Resets a card to the idle state; returns whether a card answered.
    fn wake(&mut self) -> bool {
        self.set_speed(SLOW);
        self.select.set_high();
        let _ = self.spi.write(&WAKE_BYTES);
        let _ = SpiBus::<u8>::flush(&mut self.spi);
        self.select.set_low();
        let _ = self.spi.write(&GO_IDLE);
        let mut answer = [0xFF_u8; ANSWER_BYTES];
        let _ = self.spi.transfer_in_place(&mut answer);
        #[expect(clippy::manual_contains, reason = "80 bytes less of flash")]
        let answered = answer.iter().any(|&byte| byte == 0x01);
        if !answered {
            self.select.set_high();
        }
        answered
    }

    /// Sets the clock divider. All bytes must have been sent: the bus is idle.
    fn set_speed(&mut self, divider: Br) {
        SPI2.cr1().modify(|w| w.set_spe(false));
        SPI2.cr1().modify(|w| {
            w.set_br(divider);
            w.set_spe(true);
        });
    }
}

/// The card slot, with a card or empty.
#[expect(missing_debug_implementations, reason = "the driver has none")]
pub struct CardSlot {
    card: SdCard<CardBus, Delay>,
    ready: Cell<bool>,
}

type SdError = embedded_sdmmc::sdcard::spi::Error;

impl CardSlot {
    pub(super) fn new(
        spi: Spi<'static, Blocking, spi::mode::Master>,
        select: Output<'static>,
    ) -> Self {
        let options = AcquireOpts { acquire_retries: 2, ..AcquireOpts::default() };
        let bus = CardBus { spi, select, since: 0 };
        let card = SdCard::new_with_options(bus, Delay, options);
        Self { card, ready: Cell::new(false) }
    }

    /// Runs an operation with a card that is ready. After an error the card must be made ready
    /// again, because it may be a different one.
    fn with<R>(
        &self,
        deed: impl FnOnce(&SdCard<CardBus, Delay>) -> Result<R, SdError>,
    ) -> Result<R, SdError> {
        self.make_ready()?;
        deed(&self.card).inspect_err(|_| self.ready.set(false))
    }

    #[inline(never)]
    fn make_ready(&self) -> Result<(), SdError> {
        if !self.ready.get() {
            self.insert()?;
        }
        self.start_time();
        Ok(())
    }

    fn start_time(&self) {
        self.card.spi(|bus| bus.since = clock());
    }

    fn insert(&self) -> Result<(), SdError> {
        self.card.mark_card_uninit();
        if !self.card.spi(CardBus::wake) {
            return Err(SdError::CardNotFound);
        }
        self.start_time();
        self.card.num_bytes()?;
        self.card.spi(|bus| bus.set_speed(FAST));
        self.ready.set(true);
        Ok(())
    }
}

impl BlockDevice for CardSlot {
    type Error = SdError;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), SdError> {
        self.with(|card| card.read(blocks, start))
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), SdError> {
        self.with(|card| card.write(blocks, start))
    }

    fn num_blocks(&self) -> Result<BlockCount, SdError> {
        self.with(BlockDevice::num_blocks)
    }
}
