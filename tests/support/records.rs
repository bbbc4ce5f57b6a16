//! Sectors of a logger, built by the tests.

use crc::{CRC_32_ISO_HDLC, Crc};
use floe_core::Counts;
use floe_firmware::adc::Input;
use floe_firmware::record::{Part, Record, SECTOR_LEN, SECTOR_SAMPLES, Sector};
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

/// Length of the header in version 1, bytes.
const FIRST_LEN: usize = 84;
/// Length of the header in version 2, bytes.
const HEADER_LEN: usize = 180;
const CRC_AT: usize = SECTOR_LEN - 4;

/// Codes of a 630 N block that sticks and slips every two seconds, at 5000 codes per N.
#[must_use]
pub fn stick_slip(samples: u32) -> Vec<i32> {
    let force = |i: i32| match i % 32 {
        phase @ 0..28 => 200 + 22 * phase,
        28 => 700,
        29 => 480,
        30 => 260,
        _ => 205,
    };
    (0..samples as i32).map(|i| 5000 * force(i) + (i * 7919) % 8192).collect()
}

/// Settings for these codes.
#[must_use]
pub fn settings(weight_n: f32, name: &str) -> Settings {
    let mut settings =
        Settings { name: name.try_into().unwrap_or_default(), ..Settings::default() };
    settings.config.weight_n = weight_n;
    settings.config.calibration.counts_per_n = 5000.0;
    settings
}

/// A test of `samples` samples as records with sector numbers from `sector`. The clock shows
/// `stamp` at index 0, and runs at 1 MHz.
#[must_use]
pub fn test(part: Part, settings: &Settings, sector: u32, stamp: u32, samples: u32) -> Vec<Record> {
    let codes = stick_slip(samples);
    let indices: Vec<u32> = (0..samples).map(|i| part.first_index + i).collect();
    let sample = |(&index, &code): (&u32, &i32)| Sample {
        index,
        stamp: stamp.wrapping_add(62_500 * index),
        input: Input::Bridge,
        reading: Ok(Counts(code)),
    };
    let all: Vec<Sample> = indices.iter().zip(&codes).map(sample).collect();
    all.chunks(SECTOR_SAMPLES)
        .zip(sector..)
        .map(|(samples, sector)| Record {
            sector,
            part,
            running: true,
            clock_hz: 1_000_000,
            settings: settings.clone(),
            samples: samples.iter().copied().collect(),
            ..Record::default()
        })
        .collect()
}

/// The bytes of records, one sector each.
#[must_use]
pub fn bytes(records: &[Record]) -> Vec<u8> {
    records.iter().flat_map(Record::encode).collect()
}

/// A sector with the checksum of its content.
#[must_use]
pub fn sealed(mut sector: Sector) -> Sector {
    let sum = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&sector[..CRC_AT]);
    sector[CRC_AT..].copy_from_slice(&sum.to_le_bytes());
    sector
}

/// The sector in the layout of version 1.
#[must_use]
pub fn version_1(record: &Record) -> Sector {
    let new = record.encode();
    let mut old = [0; SECTOR_LEN];
    old[..FIRST_LEN].copy_from_slice(&new[..FIRST_LEN]);
    old[4] = 1;
    let body = &new[HEADER_LEN..CRC_AT];
    old[FIRST_LEN..FIRST_LEN + body.len()].copy_from_slice(body);
    sealed(old)
}

/// The sector with a header of another length, as a later version might write it.
#[must_use]
pub fn with_header(record: &Record, length: usize) -> Sector {
    let new = record.encode();
    let mut other = [0xA5; SECTOR_LEN];
    let kept = length.min(HEADER_LEN);
    other[..kept].copy_from_slice(&new[..kept]);
    other[FIRST_LEN..FIRST_LEN + 2].copy_from_slice(&(length as u16).to_le_bytes());
    let room = CRC_AT - length.max(HEADER_LEN);
    let body = &new[HEADER_LEN..HEADER_LEN + room];
    other[length..length + room].copy_from_slice(body);
    sealed(other)
}
