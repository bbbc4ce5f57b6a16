//! Commands and registers, from the data sheets SBAS751B (C04) and SBAS752B (U04).

use crate::adc::Input;

/// Back to the values after power-up: all registers zero.
pub const RESET: u8 = 0x06;
/// Starts one conversion.
pub const START: u8 = 0x08;
/// Reads the last conversion.
pub const READ_DATA: u8 = 0x10;
/// Reads the register whose address is shifted in.
pub const READ_REGISTER: u8 = 0x20;
/// Writes the register whose address is shifted in.
pub const WRITE_REGISTER: u8 = 0x40;

/// Bit 7 of register 2 tells of a new conversion; it is not ours to set.
pub const DATA_READY: u8 = 0x80;

const TURBO_90: u8 = 0b001 << 5 | TURBO;
const TURBO_2000: u8 = 0b110 << 5 | TURBO;
const TURBO: u8 = 1 << 4;
const EXTERNAL_REFERENCE: u8 = 0b01 << 1;

/// Registers 0 to 3 for what is to be measured.
///
/// Bridge: AIN0 against AIN1, gain 128, reference from REFP and REFN (which the
/// excitation of the bridge is wired to: ratiometric), 90 conversions a second in
/// turbo mode (11.1 ms aperture), single shot, with the conversion counter and
/// every byte repeated inverted.
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

/// Registers 0 and 1 for the chip's own temperature, in 0.52 ms.
pub const THERMOMETER: [u8; 2] = [0, TURBO_2000 | 1];

/// Registers 0 and 1 for a quarter of the supply against the chip's own reference, 2.048 V,
/// in 0.52 ms.
pub const SUPPLY: [u8; 2] = [0b1101 << 4 | PGA_BYPASS, TURBO_2000];

/// Registers 0 and 1 for an answer that is known beforehand, and soon: a quarter of
/// the reference with gain 1, which is a quarter of full scale, in 0.52 ms.
pub const MONITOR: [u8; 2] = [0b1100 << 4 | PGA_BYPASS, TURBO_2000 | EXTERNAL_REFERENCE];
const PGA_BYPASS: u8 = 1;
