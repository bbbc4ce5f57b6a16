//! Stretches of the log at full resolution, spread over its whole length.

/// Largest number of clips; a long log keeps at least half as many.
const MOST: usize = 16;
/// Length of a clip, s, within the bounds below.
const LENGTH_S: f64 = 256.0;

/// Consecutive samples.
#[derive(Clone, Debug)]
struct Clip {
    number: u64,
    start_s: f64,
    /// N; NaN where there is no force.
    forces_n: Vec<f32>,
}

/// Clips of equal length. All are kept while there is room, then every second one, then every
/// fourth, ...
#[derive(Clone, Debug)]
pub(super) struct Clips {
    period_s: f64,
    length: u64,
    stride: u64,
    kept: Vec<Clip>,
}

impl Clips {
    pub fn new(rate_hz: f64) -> Self {
        let length = (LENGTH_S * rate_hz).clamp(4096.0, 65536.0) as u64;
        Self { period_s: 1.0 / rate_hz, length, stride: 1, kept: Vec::new() }
    }

    /// Adds the sample `offset` periods after the first one.
    pub fn push(&mut self, offset: u64, time_s: f64, force_n: Option<f32>) {
        let (number, within) = (offset / self.length, (offset % self.length) as usize);
        if self.kept.last().is_none_or(|clip| clip.number < number) {
            self.begin(number, time_s - within as f64 * self.period_s);
        }
        let Some(clip) = self.kept.last_mut().filter(|clip| clip.number == number) else { return };
        if within >= clip.forces_n.len() {
            clip.forces_n.resize(within, f32::NAN);
            clip.forces_n.push(force_n.unwrap_or(f32::NAN));
        }
    }

    fn begin(&mut self, number: u64, start_s: f64) {
        while self.kept.len() >= MOST {
            self.stride *= 2;
            let stride = self.stride;
            self.kept.retain(|clip| clip.number.is_multiple_of(stride));
        }
        if number.is_multiple_of(self.stride) {
            self.kept.push(Clip { number, start_s, forces_n: Vec::new() });
        }
    }

    /// Removes a sample that turned out to be a spike.
    pub fn forget(&mut self, offset: u64) {
        let (number, within) = (offset / self.length, (offset % self.length) as usize);
        let clip = self.kept.iter_mut().rev().find(|clip| clip.number == number);
        if let Some(force) = clip.and_then(|clip| clip.forces_n.get_mut(within)) {
            *force = f32::NAN;
        }
    }

    fn end_s(&self, clip: &Clip) -> f64 {
        clip.start_s + clip.forces_n.len() as f64 * self.period_s
    }

    /// Offset and time, s, of the first sample, and the forces, N, of every clip.
    pub fn stretches(&self) -> impl Iterator<Item = (u64, f64, &[f32])> {
        self.kept.iter().map(|c| (c.number * self.length, c.start_s, c.forces_n.as_slice()))
    }

    /// Whether every moment from `from_s` to `to_s` lies in a clip.
    pub fn covers(&self, from_s: f64, to_s: f64) -> bool {
        let mut number = None;
        for clip in self.kept.iter().skip_while(|clip| self.end_s(clip) < from_s) {
            let continues = number.map_or(clip.start_s <= from_s, |n| clip.number == n + 1);
            if !continues || self.end_s(clip) >= to_s {
                return continues;
            }
            number = Some(clip.number);
        }
        false
    }

    /// Times (s) and forces (N, NaN where there is none) from `from_s` to `to_s`.
    pub fn window(&self, from_s: f64, to_s: f64) -> Vec<(f64, f64)> {
        let inside = |&(time_s, _): &(f64, f64)| (from_s..=to_s).contains(&time_s);
        let overlapping =
            self.kept.iter().filter(|clip| clip.start_s <= to_s && self.end_s(clip) >= from_s);
        overlapping.flat_map(|clip| self.samples(clip)).filter(inside).collect()
    }

    fn samples(&self, clip: &Clip) -> impl Iterator<Item = (f64, f64)> {
        let (start_s, period_s) = (clip.start_s, self.period_s);
        let at = move |(i, &force): (usize, &f32)| (start_s + i as f64 * period_s, force.into());
        clip.forces_n.iter().enumerate().map(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(samples: u64) -> Clips {
        let mut clips = Clips::new(16.0);
        for i in 0..samples {
            clips.push(i, 100.0 + i as f64 / 16.0, Some(i as f32));
        }
        clips
    }

    #[test]
    fn a_short_log_is_kept_whole() {
        let clips = filled(16 * 3600);
        assert!(clips.covers(100.0, 3699.0));
        assert!(!clips.covers(99.0, 3699.0) && !clips.covers(100.0, 3701.0));
        let window = clips.window(355.9, 356.1); // across the first boundary
        assert_eq!(window, [(355.9375, 4095.0), (356.0, 4096.0), (356.0625, 4097.0)]);
    }

    #[test]
    fn a_long_log_is_thinned_evenly() {
        let clips = filled(4096 * 100);
        assert_eq!(clips.kept.iter().map(|c| c.number).max(), Some(96));
        assert!((MOST / 2..=MOST).contains(&clips.kept.len()));
        assert!(clips.covers(101.0, 300.0) && !clips.covers(300.0, 400.0));
    }

    #[test]
    fn gaps_and_spikes_are_not_forces() {
        let mut clips = filled(3);
        clips.push(5, 100.3125, Some(9.0));
        clips.forget(1);
        let missing: Vec<bool> =
            clips.window(0.0, 200.0).iter().map(|(_, force)| force.is_nan()).collect();
        assert_eq!(missing, [false, true, false, true, true, false]);
        clips.push(1 << 60, 1e17, Some(1.0));
        assert_eq!(clips.kept.len(), 2);
    }
}
