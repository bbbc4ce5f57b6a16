//! Cuts a whole record into events, with limits taken from the record.

use super::cutter::{Cut, Cutter};
use super::method::{Sample, Setup};

/// Smallest fall and rise, in standard deviations of the noise.
const FALL_STDS: f32 = 7.0;
const RISE_STDS: f32 = 4.0;
/// Smallest fall, as a fraction of the record's large drops.
const FALL_PART: f32 = 0.25;
/// Upper limit of the smallest fall, as a fraction of the range of the forces: where the block
/// hardly rests, second differences do not measure the noise.
const FALL_RANGE: f32 = 0.3;
/// Quantile that defines a large drop.
const LARGE: f64 = 0.9;
/// Smallest fall, as a fraction of the weight.
const FALL_WEIGHT: f32 = 0.04;

/// Position of an event: times, s, and forces, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Time of the lowest sample before, or of the start.
    pub from_s: f64,
    /// Time and force of the highest sample.
    pub peak: (f64, f64),
    /// Time and force of the lowest sample.
    pub low: (f64, f64),
    /// Time just before the highest sample after the event, or of the end.
    pub to_s: f64,
}

/// The events of a record, in order.
#[must_use]
pub fn segments(setup: &Setup, samples: &[Sample]) -> Vec<Segment> {
    let noise_n = noise_n(samples);
    let most_n = FALL_RANGE * range_n(samples);
    let least_n = (FALL_STDS * noise_n).min(most_n).max(FALL_WEIGHT * setup.weight_n as f32);
    let rise_n = (RISE_STDS * noise_n).min(0.5 * most_n);
    let mut drops: Vec<f32> = cuts(Cutter::with_least(setup, least_n, rise_n), samples)
        .map(|(peak, low)| peak.force_n - low.force_n)
        .collect();
    drops.sort_by(f32::total_cmp);
    let large_n = drops.get((LARGE * drops.len() as f64) as usize).copied().unwrap_or(0.0);
    let cutter = Cutter::with_least(setup, least_n.max(FALL_PART * large_n), rise_n);
    let turns: Vec<(Sample, Sample)> = cuts(cutter, samples).collect();
    let time_s = |sample: &Sample| sample.index as f64 / setup.rate_hz;
    let end_s = turns.last().map_or(0.0, |(_, low)| time_s(&highest_after(samples, low)));
    let segment = |(i, (peak, low)): (usize, &(Sample, Sample))| {
        let before = i.checked_sub(1).and_then(|i| turns.get(i));
        Segment {
            from_s: before.map_or(-1.0, |(_, low)| time_s(low)),
            peak: (time_s(peak), peak.force_n.into()),
            low: (time_s(low), low.force_n.into()),
            to_s: turns.get(i + 1).map_or(end_s, |(p, _)| time_s(p)) - 1.0 / setup.rate_hz,
        }
    };
    turns.iter().enumerate().map(segment).collect()
}

/// Highest sample after the last slip; a slip cut by the end of the record begins later.
fn highest_after(samples: &[Sample], low: &Sample) -> Sample {
    let after = samples.iter().filter(|s| s.index >= low.index);
    *after.max_by(|a, b| a.force_n.total_cmp(&b.force_n)).unwrap_or(low)
}

fn cuts(mut cutter: Cutter, samples: &[Sample]) -> impl Iterator<Item = (Sample, Sample)> {
    samples.iter().filter_map(move |&sample| match cutter.step(sample) {
        Some(Cut::Rest { peak, low }) => Some((peak, low)),
        Some(Cut::Slip) | None => None,
    })
}

/// Range of the forces without the outermost percent at both ends, N.
fn range_n(samples: &[Sample]) -> f32 {
    let mut forces_n: Vec<f32> = samples.iter().map(|s| s.force_n).collect();
    forces_n.sort_by(f32::total_cmp);
    let edge = forces_n.len() / 100;
    let ends = forces_n.get(edge).zip(forces_n.iter().rev().nth(edge));
    ends.map_or(0.0, |(low, high)| high - low)
}

/// Standard deviation of white noise, from the median second difference, N.
fn noise_n(samples: &[Sample]) -> f32 {
    let triples = samples.iter().zip(samples.iter().skip(1)).zip(samples.iter().skip(2));
    let mut seconds: Vec<f32> =
        triples.map(|((a, b), c)| (a.force_n - 2.0 * b.force_n + c.force_n).abs()).collect();
    seconds.sort_by(f32::total_cmp);
    let median = seconds.get(seconds.len() / 2).copied().unwrap_or(0.0);
    median / (0.6745 * 6.0_f32.sqrt())
}
