//! Commands and registers, from the data sheets SBAS751B (C04) and SBAS752B (U04).

use crate::adc::Input;

/// Resets all registers to their values after power-up: zero.
pub const RESET: u8 = 0x06;
/// Starts one conversion.
pub const START: u8 = 0x08;
/// Reads the last conversion.
pub const READ_DATA: u8 = 0x10;
/// Reads the register whose address is shifted in.
pub const READ_REGISTER: u8 = 0x20;
/// Writes the register whose address is shifted in.
pub const WRITE_REGISTER: u8 = 0x40;

/// Bit 7 of register 2: a new conversion is available. The chip sets this bit.
pub const DATA_READY: u8 = 0x80;

const TURBO_90: u8 = 0b001 << 5 | TURBO;
const TURBO_2000: u8 = 0b110 << 5 | TURBO;
const TURBO: u8 = 1 << 4;
const EXTERNAL_REFERENCE: u8 = 0b01 << 1;

/// Registers 0 to 3 for an input.
///
/// Bridge: AIN0 against AIN1, gain 128, ratiometric (reference from REFP and REFN, which are wired
/// to the bridge's excitation), 90 conversions a second in turbo mode (11.1 ms aperture), single
/// shot, with conversion counter and inverted copies of all data bytes.
#[must_use]
pub fn settings(input: Input) -> [u8; 4] {
    const GAIN_128: u8 = 0b111 << 1;
    const SHORTED: u8 = 0b1110 << 4;
    const TEMPERATURE: u8 = 1;
    const COUNTER_AND_INVERTED: u8 = 1 << 6 | 0b01 << 4;
    const BURN_OUT: u8 = 1 << 3;
    let bridge = [GAIN_128, TURBO_90 | EXTERNAL_REFERENCE, COUNTER_AND_INVERTED, 0];
    match input {
        Input::Bridge => bridge,
        Input::Shorted => [SHORTED | GAIN_128, bridge[1], bridge[2], 0],
        Input::Temperature => [GAIN_128, TURBO_90 | TEMPERATURE, bridge[2], 0],
        Input::BurnOut => [GAIN_128, bridge[1], bridge[2] | BURN_OUT, 0],
    }
}

/// Registers 0 and 1 for the chip's temperature sensor; conversion time 0.52 ms.
pub const THERMOMETER: [u8; 2] = [0, TURBO_2000 | 1];

/// Registers 0 and 1 for a quarter of the supply voltage against the internal 2.048 V reference;
/// conversion time 0.52 ms.
pub const SUPPLY: [u8; 2] = [0b1101 << 4 | PGA_BYPASS, TURBO_2000];

/// Registers 0 and 1 for a conversion with a known result: a quarter of the reference at gain 1,
/// which is a quarter of full scale; conversion time 0.52 ms.
pub const MONITOR: [u8; 2] = [0b1100 << 4 | PGA_BYPASS, TURBO_2000 | EXTERNAL_REFERENCE];
const PGA_BYPASS: u8 = 1;
