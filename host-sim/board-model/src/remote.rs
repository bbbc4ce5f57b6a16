//! The console on a TCP port of this PC, in real time, for one client at a time.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// The port and its client.
#[derive(Debug)]
pub struct Remote {
    listener: TcpListener,
    visitor: Option<TcpStream>,
    start: Instant,
}

impl Remote {
    /// Opens the port.
    ///
    /// # Errors
    /// The port is in use.
    pub fn new(port: u16) -> std::io::Result<Self> {
        let listener = TcpListener::bind(("127.0.0.1", port))?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, visitor: None, start: Instant::now() })
    }

    /// Waits until real time has caught up with emulated time.
    pub fn keep_pace(&self, now_ns: u64) {
        let due = Duration::from_nanos(now_ns);
        std::thread::sleep(due.saturating_sub(self.start.elapsed()));
    }

    /// Sends console output to the client and returns the typed bytes. Output without a client is
    /// lost, as on a serial line.
    pub fn exchange(&mut self, said: &[u8]) -> Vec<u8> {
        if self.visitor.is_none() {
            self.visitor = self.listener.accept().ok().map(|(stream, _)| stream);
            if let Some(stream) = &self.visitor {
                // A client that reads too slowly loses the output that does not fit.
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
