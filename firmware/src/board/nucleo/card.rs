//! The card in its slot: it may come and go.

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

/// 250 kHz of 16 MHz, until a card is ready; the specification wants at most 400.
const SLOW: Br = Br::DIV64;
/// 8 MHz afterwards.
const FAST: Br = Br::DIV2;
/// Ten bytes are 80 clocks; the specification wants 74 before the first command.
const WAKE_BYTES: [u8; 10] = [0xFF; 10];
/// CMD0 with its checksum.
const GO_IDLE: [u8; 6] = [0x40, 0, 0, 0, 0, 0x95];
/// Bytes within which any card answers a command.
const ANSWER_BYTES: usize = 10;
/// Longest time for anything asked of a card, us: the specification gives it 1 s to get
/// ready and half a second to write.
const LIMIT_US: u32 = 1_000_000;

/// The bus to the only card on it. Chip select stays low once the card is awake: the
/// specification does not let it rise within a transaction, and the driver's are cut
/// into many.
struct CardBus {
    spi: Spi<'static, Blocking, spi::mode::Master>,
    select: Output<'static>,
    /// When what is being asked for began.
    since: u32,
}

/// The bus failed, or the card took too long.
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
    /// Wakes whatever is there; whether anybody answers the first command.
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

    /// The bus is idle: whatever was sent has been waited for.
    fn set_speed(&mut self, divider: Br) {
        SPI2.cr1().modify(|w| w.set_spe(false));
        SPI2.cr1().modify(|w| {
            w.set_br(divider);
            w.set_spe(true);
        });
    }
}

/// A slot with a card or none.
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

    /// Does something with a card that is ready. One that fails has to be got ready
    /// again: it may be another.
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
