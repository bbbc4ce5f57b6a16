//! Address of a board.

use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

use serial2::SerialPort;

use crate::error::InputError;

/// Baud rate of the console on every board.
const BAUD: u32 = 115_200;
/// Longest wait of a read, and thereby longest delay of a command.
const READ_WAIT: Duration = Duration::from_millis(50);
const WRITE_WAIT: Duration = Duration::from_secs(1);
const CONNECT_WAIT: Duration = Duration::from_secs(3);

/// A serial device or a socket.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// `/dev/ttyACM0`, `COM3`.
    Serial(String),
    /// `HOST:PORT`, with or without `tcp:` before it.
    Tcp(String),
    /// `unix:PATH`.
    Unix(String),
}

/// A connection in both directions, with short waits.
pub trait Stream: Read + Write + Send {}

impl<T: Read + Write + Send> Stream for T {}

impl Place {
    /// Parses the user's text.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        if let Some(path) = text.strip_prefix("unix:") {
            return Self::Unix(path.to_string());
        }
        if let Some(address) = text.strip_prefix("tcp:") {
            return Self::Tcp(address.trim_start_matches('/').to_string());
        }
        match text.rsplit_once(':') {
            Some((host, port)) if !host.contains('/') && port.parse::<u16>().is_ok() => {
                Self::Tcp(text.to_string())
            }
            _ => Self::Serial(text.to_string()),
        }
    }

    /// Opens the connection.
    ///
    /// # Errors
    /// The problem and its remedy, in one line.
    pub fn open(&self) -> Result<Box<dyn Stream>, InputError> {
        let opened = match self {
            Self::Serial(name) => open_serial(name),
            Self::Tcp(address) => open_tcp(address),
            Self::Unix(path) => open_unix(path),
        };
        opened.map_err(|error| InputError::new(self.remedy(&error)).within(self))
    }

    /// Whether the address would be `HOST:PORT` if its number were smaller.
    fn has_too_large_a_port(&self) -> bool {
        let (Self::Serial(text) | Self::Tcp(text)) = self else { return false };
        text.rsplit_once(':').is_some_and(|(host, port)| {
            let is_number = !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit());
            !host.contains('/') && is_number && port.parse::<u16>().is_err()
        })
    }

    fn remedy(&self, error: &io::Error) -> String {
        match (self, error.kind()) {
            (_, ErrorKind::NotFound | ErrorKind::InvalidInput) if self.has_too_large_a_port() => {
                format!("the number of a port is {} at most", u16::MAX)
            }
            (Self::Serial(_), ErrorKind::NotFound) => format!("no such port; {}", ports()),
            (Self::Serial(_), ErrorKind::PermissionDenied) => "no permission: become a member of \
                the port's group (sudo usermod -aG dialout $USER) and log in again"
                .to_string(),
            (Self::Serial(_), _) => format!("cannot be used as a serial port: {error}"),
            (_, ErrorKind::NotFound) => "no such socket; is the emulator running?".to_string(),
            (_, ErrorKind::PermissionDenied) => format!("no permission to connect: {error}"),
            (_, ErrorKind::ConnectionRefused) => {
                "nobody listens there; is the emulator running (cargo xtask emulate LOG --live)?"
                    .to_string()
            }
            (_, _) => format!("cannot be reached: {error}"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(place) | Self::Tcp(place) | Self::Unix(place) => f.write_str(place),
        }
    }
}

fn open_serial(name: &str) -> io::Result<Box<dyn Stream>> {
    let mut port = SerialPort::open(name, BAUD)?;
    port.set_read_timeout(READ_WAIT)?;
    port.set_write_timeout(WRITE_WAIT)?;
    Ok(Box::new(port))
}

fn open_tcp(address: &str) -> io::Result<Box<dyn Stream>> {
    let mut failed = io::Error::new(ErrorKind::NotFound, "this name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_WAIT) {
            Ok(stream) => {
                stream.set_read_timeout(Some(READ_WAIT))?;
                stream.set_write_timeout(Some(WRITE_WAIT))?;
                stream.set_nodelay(true)?;
                return Ok(Box::new(stream));
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

#[cfg(unix)]
fn open_unix(path: &str) -> io::Result<Box<dyn Stream>> {
    let stream = std::os::unix::net::UnixStream::connect(path)?;
    stream.set_read_timeout(Some(READ_WAIT))?;
    stream.set_write_timeout(Some(WRITE_WAIT))?;
    Ok(Box::new(stream))
}

#[cfg(not(unix))]
fn open_unix(_: &str) -> io::Result<Box<dyn Stream>> {
    Err(io::Error::new(ErrorKind::Unsupported, "this system has no such sockets"))
}

/// The existing ports, as text.
fn ports() -> String {
    let mut found = SerialPort::available_ports().unwrap_or_default();
    found.sort();
    let names: Vec<String> = found.iter().map(|port| port.display().to_string()).collect();
    match names.as_slice() {
        [] => "no serial port is there: plug the board in".to_string(),
        names => format!("there are: {}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places() {
        let serial = |text: &str| Place::Serial(text.to_string());
        let tcp = |text: &str| Place::Tcp(text.to_string());
        for (text, place) in [
            ("/dev/ttyACM0", serial("/dev/ttyACM0")),
            ("COM3", serial("COM3")),
            (
                "/dev/serial/by-path/pci-0000:00:14.0",
                serial("/dev/serial/by-path/pci-0000:00:14.0"),
            ),
            ("/dev/odd/name:1", serial("/dev/odd/name:1")),
            ("localhost:4004", tcp("localhost:4004")),
            ("tcp:localhost:4004", tcp("localhost:4004")),
            ("tcp://localhost:4004", tcp("localhost:4004")),
            ("[::1]:4004", tcp("[::1]:4004")),
            ("host:70000", serial("host:70000")),
            ("unix:/run/floe", Place::Unix("/run/floe".to_string())),
            ("", serial("")),
        ] {
            assert_eq!(Place::parse(text), place, "{text}");
        }
    }
}
