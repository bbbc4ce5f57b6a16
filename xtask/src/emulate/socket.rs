//! The console of a live run on a TCP port: for `floe live`, or any terminal.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::time::Duration;

use crate::Result;
use crate::shell::say;

/// Listens on this PC only; whoever connects hears the board from its start on.
///
/// # Errors
/// The port is taken.
pub fn serve(port: u16, directory: &Path) -> Result<()> {
    let listener = TcpListener::bind(("127.0.0.1", port));
    let listener = listener.map_err(|e| format!("port {port}: {e}"))?;
    say(&format!("console: nc 127.0.0.1 {port}, or floe live tcp://127.0.0.1:{port}"));
    let (typed, shown) = (directory.join("console.in"), directory.join("console.out"));
    std::thread::spawn(move || {
        for client in listener.incoming().flatten() {
            let (typed, shown) = (typed.clone(), shown.clone());
            std::thread::spawn(move || attend(client, &typed, &shown));
        }
    });
    Ok(())
}

/// One client, until it goes or the board ends.
fn attend(client: TcpStream, typed: &Path, shown: &Path) -> std::io::Result<()> {
    let mut keys = OpenOptions::new().append(true).open(typed)?;
    let mut from = client.try_clone()?;
    std::thread::spawn(move || std::io::copy(&mut from, &mut keys));
    let mut screen = File::open(shown)?;
    let mut to = client;
    let mut text = [0; 4096];
    while shown.exists() {
        let count = screen.read(&mut text)?;
        to.write_all(&text[..count])?;
        if count == 0 {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    Ok(())
}
