//! Runs a method over a scene's records: first the errors, then the times.

use std::hint::black_box;
use std::time::Instant;

use super::matching::{Detection, matched};
use super::method::{Found, Method, Sample, Setup, Value};
use super::result::{Errors, Row};
use super::scenes::{Record, Trial, Truth};

/// Number of timed runs, after one for warm-up.
const RUNS: usize = 7;
/// Half the width of a 95 % interval, standard deviations.
const INTERVAL: f64 = 1.96;

/// Output of a method for one record.
struct Answer {
    found: Vec<Found>,
    /// Times at which the method started to report a slip, s.
    declared_s: Vec<f64>,
    state_bytes: usize,
}

/// An estimate, the true value, and the bound of the error.
#[derive(Clone, Copy, Debug)]
struct Pair {
    estimate: Value,
    truth: f64,
    bound: Option<f64>,
}

/// Accuracy of a method in a scene.
#[derive(Clone, Copy, Debug)]
pub struct Judgement {
    /// How well the events were found.
    pub detection: Detection,
    /// True events with a value for both coefficients.
    pub read: usize,
    /// Errors of `mu_s`; `None` without any value.
    pub mu_s: Option<Errors>,
    /// Errors of `mu`.
    pub mu: Option<Errors>,
    /// Mean time from the true onset to the report of a slip, s.
    pub onset_delay_s: Option<f64>,
    /// Bytes kept between samples, at the end of the longest record.
    pub state_bytes: usize,
}

/// Measures errors and times of a method over a scene.
#[must_use]
pub fn assess<M: Method>(trial: &Trial) -> Row {
    let judgement = judge::<M>(trial);
    let Judgement { detection, mu_s, mu, state_bytes, .. } = judgement;
    let events = detection.hits + detection.misses;
    Row {
        scene: trial.name.to_owned(),
        linear: trial.linear,
        noise_percent: 100.0 * trial.noise,
        method: M::NAME.to_owned(),
        streams: M::STREAMS,
        events,
        f1: detection.f1(),
        read_percent: 100.0 * judgement.read as f64 / events.max(1) as f64,
        mu_s,
        mu,
        onset_delay_ms: judgement.onset_delay_s.map(|s| 1e3 * s).filter(|_| M::STREAMS),
        ns_per_sample: ns_per_sample::<M>(trial),
        state_bytes,
        worst_tick_ns: M::STREAMS.then(|| worst_tick_ns::<M>(trial)),
        board: None,
    }
}

/// Measures the errors of a method over a scene.
#[must_use]
pub fn judge<M: Method>(trial: &Trial) -> Judgement {
    let mut detection = Detection::default();
    let (mut mu_s, mut mu, mut delays_s) = (Vec::new(), Vec::new(), Vec::new());
    let (mut read, mut state_bytes) = (0, 0);
    for record in &trial.records {
        let answer = answer::<M>(&trial.setup, record);
        let judged = record.judged();
        let (pairs, found) = matched(judged, &answer.found, trial.setup.rate_hz);
        detection.add(found);
        state_bytes = state_bytes.max(answer.state_bytes);
        delays_s.extend(delays(judged, &answer.declared_s));
        for (t, f) in pairs {
            let (truth, found) = (&judged[t], &answer.found[f]);
            read += usize::from(found.mu_s.is_some() && found.mu.is_some());
            let pair = |estimate, truth, bound| Pair { estimate, truth, bound };
            mu_s.extend(found.mu_s.map(|v| pair(v, truth.mu_s, truth.bound.map(|b| b.0))));
            mu.extend(found.mu.map(|v| pair(v, truth.mu, truth.bound.map(|b| b.1))));
        }
    }
    let onset_delay_s = mean(&delays_s);
    let (mu_s, mu) = (errors(&mu_s), errors(&mu));
    Judgement { detection, read, mu_s, mu, onset_delay_s, state_bytes }
}

fn answer<M: Method>(setup: &Setup, record: &Record) -> Answer {
    let mut method = M::new(setup);
    let (mut found, mut declared_s, mut slipped) = (Vec::new(), Vec::new(), false);
    for &sample in &record.samples {
        let tick = method.step(sample);
        found.extend(tick.event);
        if tick.slips && !slipped {
            declared_s.push(sample.index as f64 / setup.rate_hz);
        }
        slipped = tick.slips;
    }
    let state_bytes = method.state_bytes();
    found.extend(std::iter::from_fn(|| method.finish()));
    Answer { found, declared_s, state_bytes }
}

/// Time from each true onset to the first report of a slip before the next onset.
fn delays(events: &[Truth], declared_s: &[f64]) -> Vec<f64> {
    let delay = |(i, event): (usize, &Truth)| {
        let end_s = events.get(i + 1).map_or(f64::INFINITY, |next| next.onset_s);
        let first = declared_s.partition_point(|&t| t < event.onset_s);
        let declared = declared_s.get(first).copied().filter(|&t| t < end_s)?;
        Some(declared - event.onset_s)
    };
    events.iter().enumerate().filter_map(delay).collect()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn errors(pairs: &[Pair]) -> Option<Errors> {
    let of = |f: &dyn Fn(&Pair) -> Option<f64>| pairs.iter().filter_map(f).collect::<Vec<f64>>();
    let error = |p: &Pair| p.estimate.value - p.truth;
    let scale = 100.0 / mean(&of(&|p| Some(p.truth)))?;
    let mut sizes = of(&|p| Some(error(p).abs()));
    sizes.sort_by(f64::total_cmp);
    let p95 = sizes.get((0.95 * sizes.len() as f64) as usize).or(sizes.last())?;
    let covers = |p: &Pair| {
        let std = p.estimate.std?;
        Some(f64::from(u8::from(error(p).abs() <= INTERVAL * std)))
    };
    Some(Errors {
        over_bound: mean(&of(&|p| Some((error(p) / p.bound?).powi(2)))).map(f64::sqrt),
        rms_percent: scale * mean(&of(&|p| Some(error(p).powi(2))))?.sqrt(),
        bias_percent: scale * mean(&of(&|p| Some(error(p))))?,
        p95_percent: scale * p95,
        coverage_percent: mean(&of(&covers)).map(|share| 100.0 * share),
    })
}

/// The first records, as many as are timed.
fn timed(trial: &Trial) -> &[Record] {
    let mut samples = 0;
    let enough = trial.records.iter().position(|record| {
        samples += record.samples.len();
        samples >= trial.timed_samples
    });
    trial.records.get(..=enough.unwrap_or(usize::MAX - 1)).unwrap_or(&trial.records)
}

fn ns_per_sample<M: Method>(trial: &Trial) -> f64 {
    let records = timed(trial);
    let run = || {
        for record in records {
            let mut method = M::new(&trial.setup);
            for &sample in &record.samples {
                black_box(method.step(black_box(sample)));
            }
            while black_box(method.finish()).is_some() {}
        }
    };
    shortest_ns(run) / samples(records).count() as f64
}

/// Time to read each sample once and keep the largest, ns per sample: a lower limit for any method.
#[must_use]
pub fn one_pass_ns(trial: &Trial) -> f64 {
    let records = timed(trial);
    let run = || {
        for record in records {
            let largest = record.samples.iter().fold(f32::MIN, |max, s| max.max(s.force_n));
            black_box(largest);
        }
    };
    shortest_ns(run) / samples(records).count() as f64
}

fn samples(records: &[Record]) -> impl Iterator<Item = Sample> + '_ {
    records.iter().flat_map(|record| record.samples.iter().copied())
}

/// Shortest of several runs, which excludes other load of the computer.
fn shortest_ns(run: impl Fn()) -> f64 {
    run();
    let times_ns = [(); RUNS].map(|()| {
        let begin = Instant::now();
        run();
        begin.elapsed().as_nanos() as f64
    });
    times_ns.into_iter().fold(f64::INFINITY, f64::min)
}

fn worst_tick_ns<M: Method>(trial: &Trial) -> f64 {
    let records = timed(trial);
    let mut shortest_ns = vec![u128::MAX; samples(records).count()];
    for _ in 0..RUNS {
        let mut place = shortest_ns.iter_mut();
        for record in records {
            let mut method = M::new(&trial.setup);
            for (&sample, shortest) in record.samples.iter().zip(&mut place) {
                let begin = Instant::now();
                black_box(method.step(black_box(sample)));
                *shortest = (*shortest).min(begin.elapsed().as_nanos());
            }
        }
    }
    let worst_ns = shortest_ns.into_iter().max().unwrap_or(0);
    worst_ns.saturating_sub(clock_ns()) as f64
}

/// Time of reading the clock, ns.
fn clock_ns() -> u128 {
    let read = |_| Instant::now().elapsed().as_nanos();
    (0..1000).map(read).min().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_known_estimates() {
        let pair = |value: f64, std: f64| Pair {
            estimate: Value { value, std: Some(std) },
            truth: 0.5,
            bound: Some(0.01),
        };
        let e = errors(&[pair(0.51, 0.01), pair(0.53, 0.01)]).unwrap();
        assert!((e.over_bound.unwrap() - 5.0_f64.sqrt()).abs() < 1e-9);
        assert!((e.bias_percent - 4.0).abs() < 1e-9);
        assert!((e.rms_percent - 2.0 * 5.0_f64.sqrt()).abs() < 1e-9);
        assert!((e.p95_percent - 6.0).abs() < 1e-9);
        assert!((e.coverage_percent.unwrap() - 50.0).abs() < 1e-9);
        assert_eq!(errors(&[]), None);
    }

    #[test]
    fn a_delay_runs_from_the_onset_to_the_next_declaration() {
        let truth =
            |onset_s| Truth { onset_s, stop_s: onset_s + 0.2, mu_s: 1.0, mu: 0.5, bound: None };
        let events = [truth(1.0), truth(3.0), truth(5.0)];
        let seen = delays(&events, &[0.9, 1.1, 1.2, 5.3]);
        assert_eq!(seen.len(), 2);
        assert!((seen[0] - 0.1).abs() < 1e-9 && (seen[1] - 0.3).abs() < 1e-9);
    }
}
