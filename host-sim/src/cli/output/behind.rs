//! A file that is written on a thread of its own, while what comes next is computed.

use std::fs::File;
use std::io::{self, Write};
use std::panic::resume_unwind;
use std::sync::mpsc::{SyncSender, sync_channel};

/// Bytes that are written to a file at once.
const PIECE: usize = 1 << 18;
/// Pieces that wait to be written; bounds the memory.
const WAITING: usize = 4;

/// Takes what goes into a file.
#[derive(Debug)]
pub struct Behind {
    piece: Vec<u8>,
    pieces: SyncSender<Vec<u8>>,
}

/// Fills a file with what `write` writes. Gives what that gives, and the file.
///
/// # Errors
/// The file cannot be written, or of `write`.
pub(super) fn fill<T>(
    mut file: File,
    write: impl FnOnce(&mut Behind) -> io::Result<T>,
) -> io::Result<(T, File)> {
    std::thread::scope(|scope| {
        let (sender, pieces) = sync_channel::<Vec<u8>>(WAITING);
        let writer = scope.spawn(move || {
            pieces.into_iter().try_for_each(|piece| file.write_all(&piece)).map(|()| file)
        });
        let mut out = Behind { piece: Vec::new(), pieces: sender };
        let made = write(&mut out).and_then(|made| out.flush().map(|()| made));
        drop(out);
        // What is wrong with the file is why it took no more.
        let file = writer.join().unwrap_or_else(|panic| resume_unwind(panic))?;
        Ok((made?, file))
    })
}

impl Write for Behind {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_all(bytes).map(|()| bytes.len())
    }

    #[inline]
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.piece.len() + bytes.len() > PIECE {
            self.flush()?;
        }
        self.piece.extend_from_slice(bytes);
        Ok(())
    }

    /// Hands over what has come together.
    fn flush(&mut self) -> io::Result<()> {
        if self.piece.is_empty() {
            return Ok(());
        }
        let piece = std::mem::replace(&mut self.piece, Vec::with_capacity(PIECE));
        self.pieces.send(piece).map_err(|_| io::ErrorKind::BrokenPipe.into())
    }
}
