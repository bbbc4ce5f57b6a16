//! The console as a TCP port of this PC, in real time: one visitor at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// The port and who is there.
#[derive(Debug)]
pub struct Remote {
    listener: TcpListener,
    visitor: Option<TcpStream>,
    start: Instant,
}

impl Remote {
    /// Listens.
    ///
    /// # Errors
    /// The port is taken.
    pub fn new(port: u16) -> std::io::Result<Self> {
        let listener = TcpListener::bind(("127.0.0.1", port))?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, visitor: None, start: Instant::now() })
    }

    /// Emulated time must not run ahead of the clock on the wall.
    pub fn keep_pace(&self, now_ns: u64) {
        let due = Duration::from_nanos(now_ns);
        std::thread::sleep(due.saturating_sub(self.start.elapsed()));
    }

    /// Passes on what was said; gives what was typed. What is said while nobody
    /// listens is gone, as on a serial line.
    pub fn exchange(&mut self, said: &[u8]) -> Vec<u8> {
        if self.visitor.is_none() {
            self.visitor = self.listener.accept().ok().map(|(stream, _)| stream);
            if let Some(stream) = &self.visitor {
                // A visitor who reads too slowly loses what does not fit.
                let _ = stream.set_nonblocking(true);
                let _ = stream.set_nodelay(true);
            }
        }
        let Some(stream) = &mut self.visitor else { return Vec::new() };
        let _ = stream.write(said);
        let mut typed = [0; 256];
        match stream.read(&mut typed) {
            Ok(0) => self.visitor = None,
            Ok(count) => return typed[..count].to_vec(),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(_) => self.visitor = None,
        }
        Vec::new()
    }
}
