//! Assigns sample indices to time stamps.

use floe_core::RawSample;

use super::timing::{Shared, Timing};
use crate::rounding::{counted, significant};

/// Distance of a stamp from its sample, in periods, from which it is reported.
const MISFIT: f64 = 0.25;
/// Number of samples over which the phase of fine stamps is averaged: enough to make jitter of half
/// a period harmless, few enough to follow a clock that is wrong by 1e-4.
const PHASE_SAMPLES: f64 = 1024.0;
/// Gap, in periods, after which the phase is determined again, because the logger may have been
/// restarted.
const LONG_GAP: f64 = 256.0;

/// Assigns an index to every row.
///
/// For fine stamps it is the nearest index on a grid whose phase follows the mean of the stamps, so
/// that jitter below half a period, or a slightly wrong clock, causes no gaps or duplicates. For
/// shared stamps it is the next index, unless this stamp and the following ones agree that samples
/// are missing or extra.
#[derive(Clone, Debug)]
pub struct Clock {
    timing: Timing,
    period_s: f64,
    /// Index after that of the last sample.
    next: u64,
    /// Time of the last sample, s after the first: a small number, so that adding periods stays
    /// exact.
    time_s: f64,
    /// Number of samples in the mean phase.
    averaged: f64,
    misfits: u64,
    /// Rows whose index is taken, rows after a short gap, and all rows.
    dropped: u64,
    gaps: u64,
    rows: u64,
    /// Number of gaps shortened to [`Clock::FARTHEST`].
    far: u64,
}

impl Clock {
    /// Largest gap, in periods (half a year at 16 Hz). A longer one counts as this, since usually
    /// the clock was set, and an index has 31 bits. Times are not changed.
    pub const FARTHEST: u64 = 1 << 28;

    /// State before the first sample.
    #[must_use]
    pub fn new(timing: Timing) -> Self {
        let period_s = timing.rate_hz.recip();
        let time_s = -period_s;
        Self {
            timing,
            period_s,
            next: 0,
            time_s,
            averaged: PHASE_SAMPLES,
            misfits: 0,
            dropped: 0,
            gaps: 0,
            rows: 0,
            far: 0,
        }
    }

    /// Index and time of the row with this stamp; `None` beyond [`RawSample::LAST_INDEX`].
    /// `records`: rows since the previous one, by the log's own numbers. `ahead`: the following
    /// stamps (up to [`Self::lookahead`]), used for shared stamps.
    pub fn place(
        &mut self,
        stamp_s: f64,
        records: u32,
        ahead: impl Iterator<Item = f64>,
    ) -> Option<(u32, f64)> {
        let (records, start_s) = (f64::from(records), self.timing.start_s);
        let stamp_s = stamp_s - start_s;
        let ahead = ahead.map(|stamp| stamp - start_s);
        let steps = match self.timing.shared {
            None => self.fine_steps(stamp_s, records),
            Some(shared) => self.shared_steps(shared, stamp_s, records, ahead),
        };
        self.rows += 1;
        self.dropped += u64::from(steps == 0);
        self.gaps += u64::from(steps > 1 && (steps as f64) < LONG_GAP);
        self.far += u64::from(steps > Self::FARTHEST);
        self.next = self.next.saturating_add(steps.min(Self::FARTHEST));
        let index = u32::try_from(self.next.saturating_sub(1)).ok()?;
        (index <= RawSample::LAST_INDEX).then_some((index, start_s + self.time_s))
    }

    /// Number of stamps needed after a row.
    #[must_use]
    pub fn lookahead(&self) -> usize {
        const GROUPS: f64 = 8.0;
        const MOST: f64 = 2048.0;
        let rows = |step: f64| (GROUPS.min((MOST / step).floor()) * step).ceil().max(1.0);
        self.timing.shared.map_or(0, |shared| rows(shared.step) as usize)
    }

    /// Relation of samples and stamps.
    #[must_use]
    pub fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Number of stamps far from their samples.
    #[must_use]
    pub fn misfits(&self) -> u64 {
        self.misfits
    }

    /// Warnings about the stamps.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let rate_hz = significant(self.timing.rate_hz);
        let misfits = (self.misfits > 0).then(|| {
            format!("{} time stamps do not fit {rate_hz} samples per second", self.misfits)
        });
        let uneven = self.is_uneven().then(|| {
            format!(
                "many samples are missing and as many are dropped: the times do not fit {rate_hz} \
                 samples per second; give --rate-hz R, write them with more digits, or leave them out \
                 if the samples came evenly"
            )
        });
        let far = (self.far > 0).then(|| {
            let days = Self::FARTHEST as f64 * self.period_s / 86_400.0;
            format!(
                "{} longer than {days:.1} days: {} samples each are counted as missing; was the \
                 clock set anew?",
                counted(self.far, "gap"),
                Self::FARTHEST - 1
            )
        });
        [misfits, uneven, far].into_iter().flatten()
    }

    /// Whether rows are dropped and missing so often that the rate or the stamps must be wrong. Where
    /// fine stamps fit, rows are repeated and lost.
    fn is_uneven(&self) -> bool {
        const FEW: u64 = 8;
        let unfit = if self.timing.shared.is_none() { self.misfits } else { u64::MAX };
        self.dropped.min(self.gaps).min(unfit) > FEW.max(self.rows / 200)
    }

    fn fine_steps(&mut self, stamp_s: f64, records: f64) -> u64 {
        let elapsed = (stamp_s - self.time_s) * self.timing.rate_hz;
        // A jump of the record numbers is a gap even if the stamps hide it.
        let least = if records > 1.0 { records } else { 0.0 };
        let regular = (elapsed - 1.0).abs() < 0.5 && least < 1.0;
        let steps = if regular { 1.0 } else { elapsed.round().max(least) };
        let off = elapsed - steps;
        self.misfits += u64::from(off.abs() > MISFIT);
        // Stamps that continue across a jump of the numbers continue from their position.
        let run_on = least > 0.0 && off < MISFIT - 1.0;
        let is_anew = steps > LONG_GAP || run_on;
        let share = if is_anew { self.begin_phase() } else { self.phase_share() };
        self.time_s += (steps + off * share) * self.period_s;
        steps as u64
    }

    /// Starts the mean phase: the first stamp has the full weight.
    fn begin_phase(&mut self) -> f64 {
        self.averaged = 1.0;
        1.0
    }

    fn phase_share(&mut self) -> f64 {
        if self.averaged < PHASE_SAMPLES {
            self.averaged += 1.0;
            return self.averaged.recip();
        }
        PHASE_SAMPLES.recip()
    }

    fn shared_steps(
        &mut self,
        shared: Shared,
        stamp_s: f64,
        records: f64,
        ahead: impl Iterator<Item = f64>,
    ) -> u64 {
        let (last_s, rate_hz) = (self.time_s, self.timing.rate_hz);
        let off = |stamp: f64, steps: f64| (stamp - last_s) * rate_hz - steps - shared.centre;
        let own = off(stamp_s, records);
        let mut steps = records;
        if own.abs() > shared.step / 2.0 + MISFIT {
            let gap_s = shared.step * 1.5 / rate_hz;
            let next = |stamp, k| off(stamp, records + k);
            let ahead = ahead.take(self.lookahead().saturating_sub(1));
            let mean = mean_offset((own, stamp_s), (shared.step, gap_s), next, ahead);
            // Without a complete group: distance from the edge of the stamp's own group.
            let shift = mean.unwrap_or_else(|| own - (shared.step / 2.0 - MISFIT).copysign(own));
            self.misfits += u64::from(shift.abs() < 0.5);
            steps = (records + shift.round()).max(0.0);
        }
        self.time_s += steps * self.period_s;
        steps as u64
    }
}

/// Mean offset of a row and the following ones, over complete groups up to the next visible gap. A
/// part of a group would give the offset of a sawtooth. `None` without a complete group.
fn mean_offset(
    (own, stamp_s): (f64, f64),
    (step, gap_s): (f64, f64),
    off: impl Fn(f64, f64) -> f64,
    ahead: impl Iterator<Item = f64>,
) -> Option<f64> {
    let (mut sum, mut count, mut last_s) = (own, 1.0, stamp_s);
    let (mut mean, mut whole) = (None, step);
    for stamp in ahead {
        if (stamp - last_s).abs() > gap_s {
            break;
        }
        sum += off(stamp, count);
        count += 1.0;
        last_s = stamp;
        if count >= whole {
            mean = Some(sum / count);
            whole += step;
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::*;

    fn indices(timing: Timing, stamps: &[f64]) -> (Vec<u32>, u64) {
        let mut clock = Clock::new(timing);
        let index = |(i, &t): (usize, &f64)| {
            clock.place(t, 1, stamps.iter().skip(i + 1).copied()).unwrap().0
        };
        let all = stamps.iter().enumerate().map(index).collect();
        (all, clock.misfits())
    }

    fn fine(stamps: &[f64]) -> (Vec<u32>, u64) {
        indices(Timing { rate_hz: 16.0, start_s: 0.0, shared: None }, stamps)
    }

    /// Two scans per stamp, as a CR10 writes them; scans in eighths of a second.
    fn cr10(eighths: &[u32]) -> (Vec<u32>, u64) {
        let shared = Some(Shared { step: 2.0, centre: -0.5 });
        let stamps: Vec<f64> = eighths.iter().map(|&n| f64::from(n) * 0.125).collect();
        indices(Timing { rate_hz: 16.0, start_s: 0.0, shared }, &stamps)
    }

    fn pairs(range: std::ops::Range<u32>) -> Vec<u32> {
        range.flat_map(|n| [n, n]).collect()
    }

    #[test]
    fn fine_stamps_give_gaps_and_duplicates() {
        let stamps = [0.0, 0.0625, 0.0625, 0.25, 0.3125];
        assert_eq!(fine(&stamps), (vec![0, 1, 1, 4, 5], 0));
        assert_eq!(fine(&[0.0, 0.08, 0.12]), (vec![0, 1, 2], 1));
    }

    #[test]
    fn a_clock_that_is_slightly_off_is_followed_for_days() {
        let mut clock = Clock::new(Timing { rate_hz: 16.0, start_s: 0.0, shared: None });
        for i in 0..2_000_000_u32 {
            let (index, _) = clock.place(f64::from(i) / 16.001, 1, std::iter::empty()).unwrap();
            assert_eq!(index, i);
        }
    }

    #[test]
    fn a_restart_out_of_phase_makes_no_trail_of_gaps() {
        let half = |i: i32| f64::from(i) / 16.0 + if i < 100 { 0.0 } else { 60.031 };
        let stamps: Vec<f64> = (0..200).map(half).collect();
        let (indices, _) = fine(&stamps);
        assert!(indices.windows(2).enumerate().all(|(i, w)| i == 99 || w[1] == w[0] + 1));
    }

    #[test]
    fn a_jump_in_the_record_numbers_is_a_gap() {
        let mut clock = Clock::new(Timing { rate_hz: 16.0, start_s: 0.0, shared: None });
        let none = std::iter::empty::<f64>;
        let mut place = |stamp_s, records| clock.place(stamp_s, records, none()).unwrap().0;
        assert_eq!((place(0.0, 1), place(0.0625, 3)), (0, 3));
        // With arbitrary stamps no row after it is lost.
        for row in 4..900_u32 {
            assert_eq!(place(f64::from(row - 2) / 16.0, 1), row);
        }
    }

    #[test]
    fn two_scans_a_stamp_follow_each_other() {
        assert_eq!(cr10(&pairs(0..20)), ((0..40).collect(), 0));
    }

    #[test]
    fn a_scan_stamped_one_step_off_is_no_gap() {
        let mut stamps = pairs(0..20);
        stamps[11] = 6; // 5,6 6,6: one alone, then three
        assert_eq!(cr10(&stamps), ((0..40).collect(), 1));
        let mut stamps = pairs(0..20);
        stamps[12] = 5; // three, then one alone
        assert_eq!(cr10(&stamps), ((0..40).collect(), 1));
    }

    #[test]
    fn a_missing_scan_is_a_gap() {
        for lost in 8..12 {
            let mut stamps = pairs(0..20);
            stamps.remove(lost);
            let (indices, misfits) = cr10(&stamps);
            assert_eq!((indices.last(), misfits), (Some(&39), 0), "{lost}");
            let gap = indices.windows(2).position(|w| w[1] == w[0] + 2).unwrap();
            assert!(gap.abs_diff(lost - 1) <= 1, "{lost} {gap}");
        }
    }

    #[test]
    fn a_long_gap_is_counted_from_the_stamps() {
        let mut stamps = pairs(0..10);
        stamps.extend(pairs(90..100));
        let expected: Vec<u32> = (0..20).chain(180..200).collect();
        assert_eq!(cr10(&stamps), (expected, 0));
    }

    #[test]
    fn a_repeated_scan_is_a_duplicate() {
        let mut stamps = pairs(0..20);
        stamps.insert(10, 5);
        let (indices, _) = cr10(&stamps);
        assert_eq!(indices.last(), Some(&39));
    }

    #[test]
    fn a_clock_that_is_set_anew_leaves_an_index_for_what_follows() {
        let mut clock = Clock::new(Timing { rate_hz: 16.0, start_s: 0.0, shared: None });
        let mut place = |stamp_s| clock.place(stamp_s, 1, std::iter::empty());
        for years in 0..8_u32 {
            let (index, time_s) = place(f64::from(years) * 3.2e7).unwrap();
            assert_eq!((index, time_s), (years * (1 << 28), f64::from(years) * 3.2e7));
        }
        assert_eq!((place(1e9), clock.far), (None, 8));
    }
}
