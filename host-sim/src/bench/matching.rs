//! Matches found events with true ones by the time of the onset.

use super::method::Found;
use super::scenes::Truth;

/// Largest difference between the onsets, sampling periods, in addition to half the slip.
const NEAR_PERIODS: f64 = 2.0;

/// Counts of a detection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detection {
    /// True events that were found.
    pub hits: usize,
    /// Found events without a true one.
    pub false_alarms: usize,
    /// True events that were missed.
    pub misses: usize,
}

impl Detection {
    /// Adds the counts of another record.
    pub fn add(&mut self, other: Self) {
        self.hits += other.hits;
        self.false_alarms += other.false_alarms;
        self.misses += other.misses;
    }

    /// Harmonic mean of precision and recall, 0 to 1; 1 if there are neither true nor found events.
    #[must_use]
    pub fn f1(&self) -> f64 {
        let wrong = self.false_alarms + self.misses;
        if self.hits + wrong == 0 {
            return 1.0;
        }
        2.0 * self.hits as f64 / (2 * self.hits + wrong) as f64
    }
}

/// Pairs of indices into `truths` and `found`, and the counts of the remaining events.
///
/// Each event is used once, the nearest pairs first. Events found after the last true event are not
/// judged, because a slip that the end of the record cuts has no true event.
#[must_use]
pub fn matched(
    truths: &[Truth],
    found: &[Found],
    rate_hz: f64,
) -> (Vec<(usize, usize)>, Detection) {
    let mut near = Vec::new();
    for (t, truth) in truths.iter().enumerate() {
        let limit_s = NEAR_PERIODS / rate_hz + 0.5 * (truth.stop_s - truth.onset_s);
        for (f, event) in found.iter().enumerate() {
            let distance_s = (event.onset_s - truth.onset_s).abs();
            if distance_s <= limit_s {
                near.push((distance_s, t, f));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut true_used, mut found_used) = (vec![false; truths.len()], vec![false; found.len()]);
    let mut pairs = Vec::new();
    for (_, t, f) in near {
        if !true_used[t] && !found_used[f] {
            (true_used[t], found_used[f]) = (true, true);
            pairs.push((t, f));
        }
    }
    pairs.sort_unstable();
    let end_s = truths.last().map_or(f64::INFINITY, |last| last.stop_s);
    let judged = |(event, used): &(&Found, &bool)| !**used && event.onset_s <= end_s;
    let false_alarms = found.iter().zip(&found_used).filter(judged).count();
    let hits = pairs.len();
    (pairs, Detection { hits, false_alarms, misses: truths.len() - hits })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truths(onsets_s: &[f64]) -> Vec<Truth> {
        let truth = |&onset_s: &f64| Truth {
            onset_s,
            stop_s: onset_s + 0.2,
            mu_s: 1.0,
            mu: 0.6,
            bound: None,
        };
        onsets_s.iter().map(truth).collect()
    }

    fn found(onsets_s: &[f64]) -> Vec<Found> {
        onsets_s.iter().map(|&onset_s| Found { onset_s, mu_s: None, mu: None }).collect()
    }

    fn judge(truth: &[f64], seen: &[f64]) -> (usize, usize, usize) {
        let (_, d) = matched(&truths(truth), &found(seen), 16.0);
        (d.hits, d.false_alarms, d.misses)
    }

    #[test]
    fn events_are_matched_by_their_onset() {
        assert_eq!(judge(&[1.0, 3.0], &[1.01, 2.95]), (2, 0, 0));
        // The limit is 0.125 s for two periods plus 0.1 s for half the slip.
        assert_eq!(judge(&[1.0, 3.0], &[1.22, 3.23]), (1, 0, 1));
        assert_eq!(judge(&[1.0, 3.0], &[1.0, 2.0, 3.0]), (2, 1, 0));
        // A true event is matched once, with the nearest found event.
        assert_eq!(judge(&[1.0, 3.0], &[1.05, 1.0, 3.0]), (2, 1, 0));
        let (pairs, _) = matched(&truths(&[1.0, 3.0]), &found(&[1.05, 1.0, 3.0]), 16.0);
        assert_eq!(pairs, [(0, 1), (1, 2)]);
    }

    #[test]
    fn only_what_follows_the_last_true_event_is_not_judged() {
        assert_eq!(judge(&[1.0], &[1.0, 5.0]), (1, 0, 0));
        assert_eq!(judge(&[], &[5.0]), (0, 1, 0));
        assert_eq!(judge(&[1.0], &[]), (0, 0, 1));
    }

    #[test]
    fn f1_is_the_harmonic_mean_of_precision_and_recall() {
        let d = Detection { hits: 6, false_alarms: 2, misses: 4 };
        let (precision, recall) = (6.0 / 8.0, 6.0 / 10.0);
        assert!((d.f1() - 2.0 * precision * recall / (precision + recall)).abs() < 1e-12);
        assert!((Detection::default().f1() - 1.0).abs() < 1e-12);
        let alarm = Detection { false_alarms: 1, ..Detection::default() };
        assert!(alarm.f1().abs() < 1e-12);
    }
}
