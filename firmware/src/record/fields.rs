//! Encoding and decoding of a sector's fields.

use floe_core::{Calibration, Config, Counts};
use heapless::String;
use heapless::string::StringView;

use super::Record;
use super::bytes::{Reader, Writer};
use crate::adc::{AdcFault, Input};
use crate::notebook::{Kind, Track, WeightFrom};
use crate::sample::Sample;
use crate::settings::{NAME_LEN, Settings};

/// Writes bytes 8 to 84, which exist in every version.
pub(super) fn put_first(out: &mut Writer<'_>, record: &Record) {
    let Record { sector, part, clock_hz, overruns, adc_faults, settings, .. } = record;
    let numbers = [*sector, part.run, part.first_index, *clock_hz, *overruns, *adc_faults];
    numbers.iter().for_each(|&n| out.put_u32(n));
    put_config(out, &settings.config);
    let mut name = [0; NAME_LEN];
    name.iter_mut().zip(settings.name.bytes()).for_each(|(to, from)| *to = from);
    out.put(name);
}

/// Appends ASCII bytes to a text; `None` if another byte occurs or the room ends.
#[inline(never)]
fn ascii_into(text: &mut StringView, bytes: &[u8]) -> Option<()> {
    let put = |byte: &u8| text.push(char::from(*byte)).ok().filter(|()| byte.is_ascii());
    bytes.iter().try_for_each(put)
}

/// A text of ASCII bytes; `None` if another byte occurs or the room is too small.
pub(super) fn ascii<const N: usize>(bytes: &[u8]) -> Option<String<N>> {
    let mut text = String::new();
    ascii_into(&mut text, bytes).map(|()| text)
}

// This function and the next are not inlined: fields then have small offsets from the record
// instead of large ones from the stack pointer.
/// Reads bytes 8 to 84; `None` if the name is invalid.
#[inline(never)]
pub(super) fn take_first(from: &mut Reader<'_>, record: &mut Record) -> Option<()> {
    record.sector = from.u32();
    record.part.run = from.u32();
    record.part.first_index = from.u32();
    record.clock_hz = from.u32();
    record.overruns = from.u32();
    record.adc_faults = from.u32();
    take_config(from, &mut record.settings.config);
    let bytes: [u8; NAME_LEN] = from.take();
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    record.settings.name = ascii(bytes.get(..end)?)?;
    Some(())
}

/// Writes the fields added in version 2.
pub(super) fn put_second(out: &mut Writer<'_>, record: &Record) {
    let Record { part, settings, running, .. } = record;
    let Settings { effects, stds, weight_from, zero, notes, .. } = settings;
    out.put([u8::from(*running)]);
    out.put_choice(WeightFrom::ALL, *weight_from);
    out.put_choice(Kind::ALL, notes.kind);
    out.put_choice(Track::ALL, notes.track);
    out.put([0; 2]);
    out.put_some_u64(part.id);
    out.put_some_u64(part.start_ms);
    out.put_u32(part.number);
    out.put_some_u32(part.gap);
    out.put_some_u32(effects.enabled);
    out.put_some_u32(effects.compiled);
    stds.first().iter().for_each(|&std| out.put_some_f32(std));
    out.put_some_f32(zero.before_n);
    out.put_some_f32(zero.after_n);
    notes.lengths().iter().for_each(|&length| out.put_some_f32(length));
    out.put_some_f32(stds.winch_m_per_s);
}

#[inline(never)]
pub(super) fn take_second(from: &mut Reader<'_>, record: &mut Record) {
    let Record { part, settings, running, .. } = record;
    let Settings { effects, stds, weight_from, zero, notes, .. } = settings;
    let [byte] = from.take();
    *running = byte == 1;
    *weight_from = from.choice(WeightFrom::ALL);
    notes.kind = from.choice(Kind::ALL);
    notes.track = from.choice(Track::ALL);
    let _spare: [u8; 2] = from.take();
    part.id = from.some_u64();
    part.start_ms = from.some_u64();
    part.number = from.some_u32().unwrap_or(0);
    let gap = from.some_u32();
    // No sampling period is lost before the first part.
    part.gap = if part.number == 0 { Some(0) } else { gap };
    effects.enabled = from.some_u32();
    effects.compiled = from.some_u32();
    from.some_f32(&mut stds.weight_n);
    from.some_f32(&mut stds.slope_rad);
    from.some_f32(&mut stds.zero_n);
    from.some_f32(&mut stds.span);
    from.some_f32(&mut stds.damping);
    from.some_f32(&mut zero.before_n);
    from.some_f32(&mut zero.after_n);
    from.some_f32(&mut notes.snow_mm);
    from.some_f32(&mut notes.length_m);
    from.some_f32(&mut notes.width_m);
    from.some_f32(&mut notes.height_m);
    from.some_f32(&mut notes.cable_length_m);
    from.some_f32(&mut notes.cable_ae_n);
    from.some_f32(&mut stds.winch_m_per_s);
}

/// Writes the core's configuration; winch speed and range are 0 if unknown.
fn put_config(out: &mut Writer<'_>, config: &Config) {
    out.put_f32(config.rate_hz);
    out.put_f32(config.weight_n);
    out.put_f32(config.slope_rad);
    out.put_f32(config.winch_m_per_s.unwrap_or(0.0));
    out.put_f32(config.range_n.unwrap_or(0.0));
    let calibration = &config.calibration;
    out.put(calibration.tare_counts.to_le_bytes());
    out.put(calibration.range_counts.0.to_le_bytes());
    out.put(calibration.range_counts.1.to_le_bytes());
    out.put_f32(calibration.counts_per_n);
}

/// Reads the core's configuration. Its other values are not stored; `Settings::core_config` sets
/// them.
fn take_config(from: &mut Reader<'_>, config: &mut Config) {
    let known = |value: f32| (value != 0.0).then_some(value);
    config.rate_hz = from.f32();
    config.weight_n = from.f32();
    config.slope_rad = from.f32();
    config.winch_m_per_s = known(from.f32());
    config.range_n = known(from.f32());
    let Calibration { tare_counts, counts_per_n, range_counts } = &mut config.calibration;
    *tare_counts = from.i32();
    *range_counts = (from.i32(), from.i32());
    *counts_per_n = from.f32();
}

pub(super) fn put_sample(out: &mut Writer<'_>, sample: &Sample) {
    out.put_u32(sample.index);
    out.put_u32(sample.stamp);
    let code = sample.reading.map_or(0, |counts| counts.0);
    let [b0, b1, b2, _] = code.to_le_bytes();
    let state = match sample.reading {
        Ok(_) => 0,
        Err(AdcFault::Silent) => 1,
        Err(AdcFault::NotReady) => 2,
        Err(AdcFault::Garbled) => 3,
        Err(AdcFault::Stuck) => 4,
        Err(AdcFault::Registers) => 5,
    };
    out.put([b0, b1, b2, state]);
}

pub(super) fn take_sample(from: &mut Reader<'_>) -> Sample {
    let (index, stamp) = (from.u32(), from.u32());
    let [b0, b1, b2, state] = from.take();
    let code = i32::from_le_bytes([0, b0, b1, b2]) >> 8;
    let reading = match state {
        0 => Ok(Counts(code)),
        1 => Err(AdcFault::Silent),
        2 => Err(AdcFault::NotReady),
        4 => Err(AdcFault::Stuck),
        5 => Err(AdcFault::Registers),
        _ => Err(AdcFault::Garbled),
    };
    Sample { index, stamp, input: Input::Bridge, reading }
}
