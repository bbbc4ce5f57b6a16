//! `cargo xtask bench`: host and board figures in one table.

use std::process::Command;

use crate::Result;
use crate::arm::Route;
use crate::shell::{self, cargo, output};
use crate::target::Tests;

/// Cycles per instruction of a Cortex-M4F without flash wait states (16 MHz and below). Loads take
/// two cycles, divisions and roots up to 14; 1.5 is a cautious estimate for this code, not yet
/// measured on the board.
const CYCLES_PER_INSTRUCTION: f64 = 1.5;
/// Sampling periods per second.
const RATE_HZ: f64 = 16.0;
/// Clock frequencies of the board in the table, MHz.
const CLOCKS_MHZ: [f64; 3] = [4.0, 16.0, 80.0];
/// Duration of the bus traffic per sampling period, s: one conversion and four registers read, one
/// conversion started; 314 bits (measured by `tests/adc_chip.rs`) on the I²C bus at 400 kHz.
const BUS_S: f64 = 314.0 / 400_000.0;

/// Currents of the STM32L476 (data sheet, typical at 25 °C, range 1, code in flash): run and sleep,
/// mA per MHz, and peripherals that stay on, mA.
const RUN_MA_PER_MHZ: f64 = 0.10;
const SLEEP_MA_PER_MHZ: f64 = 0.035;
const PERIPHERALS_MA: f64 = 0.10;
/// Currents, mA, of the ADS122C04 in turbo mode while it converts (11.1 ms of 62.5), and of a 350
/// ohm bridge at 3.3 V that is always on.
const CONVERTER_MA: f64 = 0.6 * 11.1 / 62.5;
const BRIDGE_MA: f64 = 3.3 / 0.350;

/// Prints the table of the host if its tool is available, then that of the board.
///
/// # Errors
/// The firmware does not build or run.
pub fn run(forced: Option<Route>) -> Result<()> {
    if let Some(table) = host_table() {
        println!("{table}");
    }
    let counts = Tests::prepare(forced)?.bench("bench")?;
    println!("board: instructions, counted by the emulator");
    println!("{:14} {:>9} {:>9}", "job", "mean", "worst");
    for (name, mean, worst) in &counts {
        println!("{name:14} {mean:9} {worst:9}");
    }
    let of = |name: &str| counts.iter().find(|(n, ..)| n == name);
    let mean = |name: &str| of(name).map_or(0.0, |&(_, mean, _)| mean as f64);
    // A sector is written in every eighth period; an event comes about every 28th.
    let tick = mean("sampler") + mean("step") + mean("record") / 8.0 + mean("event-line") / 28.0;
    let live = tick + mean("sample-line");
    let worst = of("step").map_or(0.0, |&(.., worst)| worst as f64);
    println!("\nper tick: {tick:.0} instructions, {live:.0} with live samples");
    println!("clock    busy per tick   worst step   duty    MCU     with converter and bridge");
    for mhz in CLOCKS_MHZ {
        let seconds = |n: f64| n * CYCLES_PER_INSTRUCTION / (mhz * 1e6);
        let busy_s = seconds(live) + BUS_S;
        let duty = busy_s * RATE_HZ;
        let mcu = mhz * (duty * RUN_MA_PER_MHZ + (1.0 - duty) * SLEEP_MA_PER_MHZ) + PERIPHERALS_MA;
        println!(
            "{mhz:3.0} MHz  {:8.2} ms    {:7.2} ms   {:4.1} %  {mcu:5.2} mA  {:5.1} mA",
            busy_s * 1e3,
            seconds(worst) * 1e3,
            duty * 100.0,
            mcu + CONVERTER_MA + BRIDGE_MA,
        );
    }
    println!("Estimates: {CYCLES_PER_INSTRUCTION} cycles an instruction, data sheet currents.");
    Ok(())
}

fn host_table() -> Option<String> {
    shell::say("host figures: floe bench");
    let mut command: Command = cargo();
    output(command.args(["run", "--quiet", "--release", "--package", "floe", "--", "bench"]))
}
