//! The memory of a replay does not grow with the number of samples and events.
#![cfg(target_os = "linux")]

use std::io::{BufWriter, Write};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Forces of a block of 630 N that slips every 28 samples.
fn force_n(index: u64) -> f64 {
    let noise = (index.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / f64::from(1 << 24);
    let force_n = match index % 28 {
        phase @ 0..24 => 200.0 + 22.0 * phase as f64,
        24 => 700.0,
        25 => 480.0,
        26 => 260.0,
        _ => 205.0,
    };
    force_n + noise
}

/// Peak memory of a process, kB; `None` once it has ended.
fn high_water(pid: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Replays a log of this many samples to a table, JSON and a report; returns the peak memory, kB.
fn replayed(samples: u64) -> u64 {
    let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
        .args(["replay", "-", "--weight-n", "630", "--json", "/dev/null", "--report", "/dev/null"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut log = BufWriter::new(child.stdin.take().unwrap());
    writeln!(log, "Time [s],Force [N]").unwrap();
    for index in 0..samples {
        writeln!(log, "{},{:.2}", index as f64 / 16.0, force_n(index)).unwrap();
    }
    drop(log);
    let mut most_kb = 0;
    while child.try_wait().unwrap().is_none() {
        most_kb = high_water(child.id()).unwrap_or(0).max(most_kb);
        sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    most_kb
}

/// `FLOE_SAMPLES=1e8` sets another length.
#[test]
fn more_events_take_no_more_memory() {
    let asked = std::env::var("FLOE_SAMPLES").ok().and_then(|n| n.parse::<f64>().ok());
    let samples = asked.unwrap_or(1e6) as u64;
    // At 4·10⁵ samples the list of events for the figures is full for the first time; later it is
    // thinned out again and again, and the gaps in the memory are filled only after that.
    let few = (samples / 10).max(400_000);
    let few_kb = replayed(few);
    let many_kb = replayed(samples);
    println!("{few} samples: {few_kb} kB; {samples}: {many_kb} kB");
    assert!(few_kb > 0 && many_kb < few_kb + 8192, "{few_kb} kB became {many_kb} kB");
    assert!(many_kb < 150_000, "{many_kb} kB");
}
