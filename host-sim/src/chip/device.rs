//! The chip: registers, commands, conversions.

use super::load_cell::LoadCell;
use super::trouble::{Schedule, Trouble, noise};

/// One of the two chips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// I²C, four registers, data most significant byte first.
    C04,
    /// Serial, five registers, data least significant byte first.
    U04,
}

/// A conversion in progress.
#[derive(Clone, Copy, Debug)]
struct Conversion {
    start_ns: u64,
    end_ns: u64,
}

/// The chip. Time is an argument of every call and must not decrease.
#[derive(Debug)]
pub struct Device {
    variant: Variant,
    registers: [u8; 5],
    conversion: Option<Conversion>,
    code: i32,
    counter: u8,
    fresh: bool,
    result_sample: u64,
    first_start_ns: Option<u64>,
    load_cell: LoadCell,
    trouble: Schedule,
    delivered: Vec<(u64, i32)>,
}

/// Code of a chip whose modulator hangs, independent of its registers.
const FROZEN_CODE: i32 = 123_456;

/// Supply voltage of chip and bridge, V.
const SUPPLY_V: f64 = 3.3;

/// Temperature of the chip, °C.
const TEMPERATURE_C: f64 = -12.0;

const RESET: u8 = 0x06;
const START: u8 = 0x08;
const POWER_DOWN: u8 = 0x02;

/// Indices of registers, data sheet section 8.6.
const CONFIG_2: usize = 2;
const DRDY: u8 = 1 << 7;

impl Device {
    /// A chip after power-up.
    #[must_use]
    pub fn new(variant: Variant, load_cell: LoadCell, trouble: Schedule) -> Self {
        Self {
            variant,
            registers: [0; 5],
            conversion: None,
            code: 0,
            counter: 0,
            fresh: false,
            result_sample: 0,
            first_start_ns: None,
            load_cell,
            trouble,
            delivered: Vec::new(),
        }
    }

    /// Which chip this is.
    #[must_use]
    pub fn variant(&self) -> Variant {
        self.variant
    }

    /// Every bridge conversion that was read, once: number of the load cell's sample, and code.
    #[must_use]
    pub fn delivered(&self) -> &[(u64, i32)] {
        &self.delivered
    }

    /// Number of the load cell's next sample, from 0; beyond the last one at the end of the record.
    #[must_use]
    pub fn sample_at(&self, now_ns: u64) -> u64 {
        self.first_start_ns.map_or(0, |first| self.load_cell.sample_at(now_ns - first))
    }

    /// Time at which the load cell switches to the sample after this one, half a period before that
    /// sample is converted. `None` before the first conversion.
    #[must_use]
    pub fn sample_end_ns(&self, sample: u64) -> Option<u64> {
        Some(self.first_start_ns?.saturating_add(self.load_cell.end_ns(sample)))
    }

    /// Number of samples of the load cell.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.load_cell.samples()
    }

    /// Current fault of the chip.
    #[must_use]
    pub fn trouble(&self, now_ns: u64) -> Option<Trouble> {
        self.trouble.at(self.sample_at(now_ns))
    }

    /// Executes a command without arguments; unknown commands are ignored.
    pub fn command(&mut self, now_ns: u64, command: u8) {
        self.advance(now_ns);
        match command & !1 {
            RESET => self.reset(),
            START => self.start(now_ns),
            POWER_DOWN => self.conversion = None,
            _ => {}
        }
    }

    /// Writes a register; a missing one ignores the value. All except register 4 restart a
    /// conversion in progress.
    pub fn write_register(&mut self, now_ns: u64, register: usize, value: u8) {
        self.advance(now_ns);
        if register >= self.register_count() {
            return;
        }
        let writable = [0xFF, 0xFF, !DRDY, 0xFC | self.auto_bit(), 0x7F];
        self.registers[register] = value & writable[register];
        if register != 4 && self.conversion.is_some() {
            self.start(now_ns);
        }
    }

    /// Reads a register, followed by its inverse if enabled. A missing register reads as zero.
    pub fn read_register(&mut self, now_ns: u64, register: usize) -> Vec<u8> {
        self.advance(now_ns);
        let mut value = self.registers.get(register).copied().unwrap_or(0);
        if register == CONFIG_2 && self.fresh {
            value |= DRDY;
        }
        self.with_inverse(vec![value])
    }

    /// Reads the last conversion: counter if enabled, code, and inverse if enabled.
    pub fn read_data(&mut self, now_ns: u64) -> Vec<u8> {
        self.advance(now_ns);
        if self.fresh && self.measures_bridge() {
            self.delivered.push((self.result_sample, self.code));
        }
        self.fresh = false;
        let [b0, b1, b2, _] = self.code.to_le_bytes();
        let mut data = Vec::with_capacity(8);
        if self.registers[CONFIG_2] & 1 << 6 != 0 {
            data.push(self.counter);
        }
        match self.variant {
            Variant::C04 => data.extend([b2, b1, b0]),
            Variant::U04 => data.extend([b0, b1, b2]),
        }
        self.with_inverse(data)
    }

    /// Executes a command with its argument received over I²C; returns the bytes that the chip
    /// sends on the next read.
    pub fn i2c_write(&mut self, now_ns: u64, bytes: &[u8]) -> Vec<u8> {
        let [command, rest @ ..] = bytes else { return Vec::new() };
        let register = usize::from(command >> 2 & 0b11);
        let mut answer = match command >> 4 {
            0b0001 => self.read_data(now_ns),
            0b0010 => self.read_register(now_ns, register),
            _ => Vec::new(),
        };
        match (command >> 4, rest.first()) {
            (0b0001 | 0b0010, _) | (0b0100, None) => {}
            (0b0100, Some(&value)) => self.write_register(now_ns, register, value),
            _ => self.command(now_ns, *command),
        }
        if self.trouble(now_ns) == Some(Trouble::Babbling) {
            (now_ns..).zip(&mut answer).for_each(|(place, byte)| *byte = noise(place));
        }
        answer
    }

    fn with_inverse(&self, mut data: Vec<u8>) -> Vec<u8> {
        let inverted = self.registers[CONFIG_2] >> 4 & 0b11 == 0b01;
        if inverted {
            data.extend_from_within(..);
            let half = data.len() / 2;
            data[half..].iter_mut().for_each(|byte| *byte = !*byte);
        }
        data
    }

    fn register_count(&self) -> usize {
        match self.variant {
            Variant::C04 => 4,
            Variant::U04 => 5,
        }
    }

    fn auto_bit(&self) -> u8 {
        u8::from(self.variant == Variant::U04)
    }

    fn reset(&mut self) {
        self.registers = [0; 5];
        self.conversion = None;
        (self.code, self.counter, self.fresh) = (0, 0, false);
    }

    fn start(&mut self, now_ns: u64) {
        if self.measures_bridge() {
            self.first_start_ns.get_or_insert(now_ns);
        }
        let start_ns = now_ns;
        let slow_ns = match self.trouble(now_ns) {
            Some(Trouble::Slow { ns }) => ns,
            _ => 0,
        };
        self.conversion =
            Some(Conversion { start_ns, end_ns: now_ns + self.aperture_ns() + slow_ns });
    }

    /// Advances to a time: executes brown-outs and ends conversions.
    fn advance(&mut self, now_ns: u64) {
        let sample = self.sample_at(now_ns);
        match self.trouble.take_glitch(sample) {
            Some(Trouble::BrownOut) => self.reset(),
            Some(Trouble::Upset { register, mask }) => {
                self.registers[register.min(4)] ^= mask;
            }
            _ => {}
        }
        let ended = self.conversion.filter(|c| c.end_ns <= now_ns);
        let Some(conversion) = ended else { return };
        self.conversion = None;
        self.finish(conversion);
        if self.registers[1] & 1 << 3 != 0 {
            // In continuous mode the next conversion follows at once.
            self.start(conversion.end_ns);
            self.advance(now_ns);
        }
    }

    fn finish(&mut self, conversion: Conversion) {
        match self.trouble(conversion.start_ns) {
            Some(Trouble::Stuck) => return,
            Some(Trouble::Frozen) => self.code = FROZEN_CODE,
            Some(Trouble::Saturated) => self.code = (1 << 23) - 1,
            _ => self.code = self.convert(conversion),
        }
        self.result_sample = self.sample_at(conversion.start_ns);
        self.counter = self.counter.wrapping_add(1);
        self.fresh = true;
    }

    fn convert(&mut self, conversion: Conversion) -> i32 {
        let first_ns = self.first_start_ns.unwrap_or(conversion.start_ns);
        let since_ns = conversion.start_ns.saturating_sub(first_ns);
        let noise = self.load_cell.noise();
        if self.registers[1] & 1 != 0 {
            // 14 bits at the top, in 1/32 °C.
            return (TEMPERATURE_C * 32.0).round() as i32 * 1024;
        }
        let gain = f64::from(1_u32 << (self.registers[0] >> 1 & 0b111));
        // Inputs as fractions of the reference; the monitors bypass the gain.
        let input = match self.registers[0] >> 4 {
            0b0000 => gain * self.load_cell.ratio(since_ns, self.registers[CONFIG_2] & 1 << 3 != 0),
            0b0011 => -gain * self.load_cell.ratio(since_ns, false),
            0b1100 => 0.25,
            0b1101 => 0.25 * SUPPLY_V / self.reference_v(),
            _ => 0.0,
        };
        let code = (input * f64::from(1 << 23)).round() + noise.round();
        code.clamp(-f64::from(1 << 23), f64::from((1 << 23) - 1)) as i32
    }

    /// Reference voltage; the external reference and the supply are both the excitation of the
    /// bridge.
    fn reference_v(&self) -> f64 {
        if self.registers[1] >> 1 & 0b11 == 0 { 2.048 } else { SUPPLY_V }
    }

    fn measures_bridge(&self) -> bool {
        let burn_out = self.registers[CONFIG_2] & 1 << 3 != 0;
        self.registers[0] >> 4 == 0 && self.registers[1] & 1 == 0 && !burn_out
    }

    /// Duration of a single-shot conversion (data sheet section 8.3.6, in clock periods at 1.024
    /// MHz in normal and 2.048 MHz in turbo mode).
    fn aperture_ns(&self) -> u64 {
        const NORMAL: [u64; 8] = [51_213, 22_805, 11_557, 5_941, 3_141, 1_749, 1_061, 1_061];
        const TURBO: [u64; 8] = [51_217, 22_809, 11_561, 5_945, 3_145, 1_753, 1_065, 1_065];
        let rate = usize::from(self.registers[1] >> 5);
        let turbo = self.registers[1] & 1 << 4 != 0;
        if turbo { TURBO[rate] * 1_000_000 / 2048 } else { NORMAL[rate] * 1_000_000 / 1024 }
    }
}
