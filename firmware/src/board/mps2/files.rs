//! Converter, console and card of the emulated board, as files in the emulator's working directory.
//!
//! | file | contents |
//! |---|---|
//! | `adc.out`, `adc.in` | FIFOs to a model of the converter |
//! | `console.in`, `console.out` | input (the file may grow) and output of the console |
//! | `uart` | if present, UART 0 is a second console with the same output |
//! | `card.img` | the SD card, if present |
//!
//! Emulated time stands still while the host reads or answers, so hours pass in seconds and every
//! run is identical. A frame to the converter is its time in clock ticks (u64), the number of bytes
//! and whether an answer is wanted (u8 each), and the bytes; the answer is a number of bytes and
//! the bytes. Numbers are little endian.

use core::convert::Infallible;

use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write};
use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};
use heapless::{Deque, Vec};
use semihosting::fs::File;
use semihosting::io::{self, Read as _, Seek as _, SeekFrom, Write as _};

use super::clock;
use super::uart::Uart;

/// The converter's serial line.
#[derive(Debug)]
pub struct AdcLine {
    to: File,
    from: File,
    frames: Vec<u8, 256>,
    unsent: Vec<u8, 32>,
    arrived: Deque<u8, 256>,
    now: u64,
}

impl AdcLine {
    /// Opens the FIFOs; `None` if the host has not created them.
    #[must_use]
    pub fn open() -> Option<Self> {
        let to = File::create(c"adc.out").ok()?;
        let from = File::open(c"adc.in").ok()?;
        let (frames, unsent, arrived) = (Vec::new(), Vec::new(), Deque::new());
        Some(Self { to, from, frames, unsent, arrived, now: 0 })
    }

    /// Ticks of the clock without its wrap; called far more often than the clock wraps.
    fn now(&mut self) -> u64 {
        let passed = clock().wrapping_sub(self.now as u32);
        self.now += u64::from(passed);
        self.now
    }

    fn add_frame(&mut self, wants_answer: bool) {
        let now = self.now();
        let _ = self.frames.extend_from_slice(&now.to_le_bytes());
        let _ = self.frames.push(self.unsent.len() as u8);
        let _ = self.frames.push(u8::from(wants_answer));
        let _ = self.frames.extend_from_slice(&self.unsent);
        self.unsent.clear();
    }

    fn exchange(&mut self) -> io::Result<()> {
        self.add_frame(true);
        self.to.write_all(&self.frames)?;
        self.frames.clear();
        let mut count = [0];
        self.from.read_exact(&mut count)?;
        let mut bytes = [0; 255];
        let bytes = &mut bytes[..usize::from(count[0])];
        self.from.read_exact(bytes)?;
        self.arrived.extend(bytes.iter().take(self.arrived.capacity()));
        Ok(())
    }
}

impl ErrorType for AdcLine {
    type Error = Infallible;
}

impl ReadReady for AdcLine {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        if self.arrived.is_empty() && self.exchange().is_err() {
            // The host has closed the line: the emulation is over.
            super::finish(0);
        }
        Ok(!self.arrived.is_empty())
    }
}

impl Read for AdcLine {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let mut count = 0;
        for slot in buffer {
            let Some(byte) = self.arrived.pop_front() else { break };
            *slot = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Write for AdcLine {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let _ = self.unsent.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    /// Puts the bytes and their time into a frame, which is sent with the next question.
    fn flush(&mut self) -> Result<(), Infallible> {
        self.add_frame(false);
        Ok(())
    }
}

/// The console.
#[derive(Debug)]
pub struct ConsoleFiles {
    typed: File,
    shown: File,
    bytes: Deque<u8, 128>,
    uart: Option<Uart>,
}

impl ConsoleFiles {
    /// Opens the files; `None` if the host has not created them.
    #[must_use]
    pub fn open() -> Option<Self> {
        let typed = File::open(c"console.in").ok()?;
        let shown = File::create(c"console.out").ok()?;
        let uart = File::open(c"uart").ok().map(|_| Uart::start());
        Some(Self { typed, shown, bytes: Deque::new(), uart })
    }
}

impl ErrorType for ConsoleFiles {
    type Error = ErrorKind;
}

impl ReadReady for ConsoleFiles {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        if self.bytes.is_empty() {
            let mut bytes = [0; 128];
            let count = self.typed.read(&mut bytes).map_err(|_| ErrorKind::Other)?;
            self.bytes.extend(bytes.iter().take(count));
        }
        if self.bytes.is_empty() {
            self.bytes.extend(self.uart.as_mut().and_then(Uart::typed));
        }
        Ok(!self.bytes.is_empty())
    }
}

impl Read for ConsoleFiles {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        let Some(slot) = buffer.first_mut() else { return Ok(0) };
        let byte = self.bytes.pop_front();
        *slot = byte.unwrap_or(0);
        Ok(usize::from(byte.is_some()))
    }
}

impl Write for ConsoleFiles {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        let count = self.shown.write(bytes).map_err(|_| ErrorKind::Other)?;
        if let (Some(uart), Some(bytes)) = (&mut self.uart, bytes.get(..count)) {
            uart.show(bytes);
        }
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// The SD card as an image with a partition table.
#[derive(Debug)]
pub struct CardFile(Option<File>);

impl CardFile {
    /// Opens the image. A missing image behaves like a slot without a card.
    #[must_use]
    pub fn open() -> Self {
        Self(File::options().read(true).write(true).open(c"card.img").ok())
    }

    fn at(&self, block: BlockIdx) -> Result<&File, CardError> {
        let mut file = self.0.as_ref().ok_or(CardError)?;
        let offset = u64::from(block.0) * Block::LEN as u64;
        file.seek(SeekFrom::Start(offset)).map_err(|_| CardError)?;
        Ok(file)
    }
}

/// The image is missing, or too short.
#[derive(Clone, Copy, Debug)]
pub struct CardError;

impl core::fmt::Display for CardError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("no card image, or one that is too short")
    }
}

impl core::error::Error for CardError {}

impl BlockDevice for CardFile {
    type Error = CardError;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), CardError> {
        let mut file = self.at(start)?;
        blocks
            .iter_mut()
            .try_for_each(|block| file.read_exact(&mut block.contents).map_err(|_| CardError))
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), CardError> {
        let mut file = self.at(start)?;
        blocks.iter().try_for_each(|block| file.write_all(&block.contents).map_err(|_| CardError))
    }

    fn num_blocks(&self) -> Result<BlockCount, CardError> {
        let file = self.0.as_ref().ok_or(CardError)?;
        let length = file.metadata().map_err(|_| CardError)?.len();
        u32::try_from(length / Block::LEN as u64).map(BlockCount).map_err(|_| CardError)
    }
}
