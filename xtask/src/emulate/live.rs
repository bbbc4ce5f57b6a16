//! Test of the board's UART in real time, with clients.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

use floe_firmware::line::Line;

use super::machine::{Machine, Setup};
use super::record::Record;
use super::{card, outcome};
use crate::Result;
use crate::arm::Route;

/// Samples of the run: 15 s.
const SAMPLES: usize = 240;
/// Complete samples that a client waits for, and number of clients.
const HEARD: usize = 32;
const VISITS: usize = 3;
/// Time limit for an answer: the board answers within two periods, a slow PC later.
const PATIENCE: Duration = Duration::from_secs(5);

/// Repeatedly connects to the UART, asks, listens and disconnects. Every question must be answered,
/// no line damaged, and the run must equal the PC's bit for bit.
///
/// # Errors
/// The first deviation.
pub fn check_live(route: Route) -> Result<()> {
    let machine = Machine::prepare(Some(route))?;
    let free = TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr());
    let port = free.map_err(|e| e.to_string())?.port();
    let mut record = Record::stick_slip();
    record.codes.truncate(SAMPLES);
    record.times_s.truncate(SAMPLES);
    let visitor =
        thread::spawn(move || (0..VISITS).map(|_| visit(port)).collect::<Result<Vec<_>>>());
    let image = card::Image::large("live")?;
    let card = Some(image.path());
    let run =
        machine.run(&record, Setup { samples: true, port: Some(port), card, cut_at: None })?;
    let answers = visitor.join().map_err(|_| "the visitor failed")??;
    let slowest = answers.into_iter().max().unwrap_or_default().as_millis();
    let same = outcome::decode(&run.shown)?.compare(&record, &run.delivered)?;
    // The card does not contain the answers to the clients.
    let kept = card::codes_as_given(image.path(), &run)?.samples.len();
    println!(
        "live: attached {VISITS} times, answered within {slowest} ms; {same}; card: {kept} codes"
    );
    Ok(())
}

/// Connects once; returns the time until the board's answer.
fn visit(port: u16) -> Result<Duration> {
    let mut board = attach(port)?;
    let failed = |e: std::io::Error| format!("UART: {e}");
    board.set_read_timeout(Some(PATIENCE)).map_err(failed)?;
    let asked = Instant::now();
    board.write_all(b"status\r\n").map_err(failed)?;
    let (mut answered, mut samples) = (None, 0);
    for (number, line) in BufReader::new(board).lines().enumerate() {
        match Line::parse(&line.map_err(failed)?) {
            Ok(Line::Start { .. }) => answered = answered.or(Some(asked.elapsed())),
            Ok(Line::Sample(_)) => samples += 1,
            Ok(_) => {}
            // The first line may be incomplete.
            Err(_) if number == 0 => {}
            Err(error) => return Err(format!("UART: line {number}: {error}")),
        }
        match answered {
            Some(answered) if samples >= HEARD => return Ok(answered),
            None if samples > 4 * HEARD => return Err("UART: a question was not answered".into()),
            _ => {}
        }
    }
    Err("UART: closed early".into())
}

/// Connects, with retries while the emulator starts.
fn attach(port: u16) -> Result<TcpStream> {
    let start = Instant::now();
    loop {
        match TcpStream::connect(("127.0.0.1", port)) {
            Ok(board) => return Ok(board),
            Err(error) if start.elapsed() > PATIENCE => return Err(format!("UART: {error}")),
            Err(_) => thread::sleep(Duration::from_millis(50)),
        }
    }
}
