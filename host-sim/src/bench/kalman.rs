//! A Kalman filter that switches between the two modes of the block.
//!
//! State, with time in sampling periods: `F`, `F'`, `k w`, `Fp`, `omega`, `Fs`. At rest `F` grows
//! by `k w` per period; in a slip `(F, F')` turns about `(Fp, 0)` at `omega` until `F'` equals
//! `k w` again. Both modes have closed forms, linearized by difference quotients (extended Kalman
//! filter). A sample far below the prediction starts a slip: the filter goes back four samples and
//! tries onsets after them. The uncertainty of the onset enters as process noise, so `Fs` stays
//! correlated with later samples and is refined until the next onset, when the event is reported.
//!
//! The filter is written here on `nalgebra`. The switch requires copies of the whole filter and
//! noise along one direction of the state, which `minikalman` (state on the heap, not copyable) and
//! `adskalman` (linear transitions) do not offer.

use super::method::{Found, Method, Sample, Setup, Tick};

mod filter;

use filter::{CENTRE, FORCE, Filter, LOADING, OMEGA, RATE, STATIC, moved, slide};

/// Innovation, in standard deviations, above which a sample does not fit the mode.
const GATE: f64 = 5.0;
/// Largest number of samples between an onset and its detection.
const BACK: usize = 4;
/// Number of trial onsets: first over the whole span, then around the best one.
const TRIALS: u32 = 9;
/// `Fp` as a fraction of `Fs` before the first slip, and its uncertainty.
const CENTRE_GUESS: (f64, f64) = (0.62, 0.15);
/// Standard deviation of the change between events: `Fp` relative to the weight, `omega` and `k w`
/// relative to themselves.
const DRIFT: (f64, f64, f64) = (0.1, 0.01, 0.01);
/// Consecutive samples that fit no mode, after which the filter restarts.
const STRIKES: u32 = 4;
/// Number of samples before the first statement.
const LEARNING: f64 = 8.0;
/// Quantile of the second differences that tracks the noise, since slips and bends of the line
/// hardly change it; its value for unit noise; and its change per sample.
const NOISE_QUANTILE: f64 = 0.3;
const QUANTILE_AT: f64 = 0.943_8;
const NOISE_STEP: f64 = 0.1;

/// Mode of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one is kept, in place")]
enum Mode {
    Rest,
    /// A slip that began between two samples.
    Slip {
        /// The sample before the onset, with the filter at that time.
        base: Past,
        /// Onset in periods after `base`.
        onset: f64,
    },
}

/// A sample with the filter after it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Past {
    filter: Filter,
    sample: Sample,
}

/// The method.
#[derive(Clone, Copy, Debug)]
pub struct Kalman {
    setup: Setup,
    filter: Filter,
    mode: Mode,
    noise_n2: f64,
    /// Number of samples since the filter started.
    samples: f64,
    /// The last samples, newest first.
    past: [Option<Past>; BACK],
    /// Onset of the event still being refined, periods.
    pending: Option<f64>,
    /// Number of slips since the filter started.
    slips: u32,
    strikes: u32,
}

impl Method for Kalman {
    const NAME: &'static str = "Kalman filter";

    fn new(setup: &Setup) -> Self {
        Self {
            setup: *setup,
            filter: Filter::new(setup),
            mode: Mode::Rest,
            noise_n2: (0.01 * setup.weight_n).powi(2),
            samples: 0.0,
            past: [None; BACK],
            pending: None,
            slips: 0,
            strikes: 0,
        }
    }

    fn step(&mut self, sample: Sample) -> Tick {
        let last = self.past[0].map(|past| past.sample.index);
        if last.is_some_and(|last| sample.index <= last) || !self.setup.is_force(sample.force_n) {
            return self.tick(None);
        }
        let periods = last.map_or(0.0, |last| (sample.index - last) as f64);
        self.samples += 1.0;
        self.follow_noise(sample);
        let event = match self.mode {
            Mode::Rest => self.rest_step(sample, periods),
            Mode::Slip { base, onset } => {
                self.slip_step(sample, periods, base, onset);
                None
            }
        };
        self.past.rotate_right(1);
        self.past[0] = Some(Past { filter: self.filter, sample });
        self.tick(event)
    }

    fn finish(&mut self) -> Option<Found> {
        let filter = self.filter;
        self.close(&filter)
    }

    fn state_bytes(&self) -> usize {
        size_of::<Self>()
    }
}

impl Kalman {
    fn tick(&self, event: Option<Found>) -> Tick {
        Tick { slips: self.mode != Mode::Rest, event }
    }

    fn follow_noise(&mut self, sample: Sample) {
        let [Some(last), Some(before), ..] = self.past else { return };
        if sample.index - before.sample.index != 2 {
            return;
        }
        let second_n = sample.force_n - 2.0 * last.sample.force_n + before.sample.force_n;
        let above = f64::from(second_n).powi(2) > self.noise_n2 * QUANTILE_AT * QUANTILE_AT;
        let step = if above { NOISE_QUANTILE } else { NOISE_QUANTILE - 1.0 };
        self.noise_n2 *= 1.0 + NOISE_STEP * step;
    }

    fn rest_step(&mut self, sample: Sample, periods: f64) -> Option<Found> {
        let force_n = f64::from(sample.force_n);
        self.filter.rest(periods);
        let (innovation, variance) = self.filter.innovation(force_n);
        let relative2 = innovation * innovation / (variance + self.noise_n2);
        let fits = relative2 < GATE * GATE || self.samples < LEARNING;
        let high = self.slips == 0 || self.filter.x[FORCE] > self.filter.x[CENTRE];
        if !fits
            && innovation < 0.0
            && high
            && let [Some(c), Some(b), Some(a), Some(base)] = self.past
        {
            let event = self.close(&base.filter);
            self.slip_from(base, [a.sample, b.sample, c.sample, sample]);
            return event;
        }
        self.strikes = if fits { 0 } else { self.strikes + 1 };
        let mut event = None;
        if self.strikes >= STRIKES {
            let filter = self.filter;
            event = self.close(&filter);
            (self.filter, self.slips, self.strikes) = (Filter::new(&self.setup), 0, 0);
            self.samples = 0.0;
        } else if !fits {
            // The sample fits neither rest nor slip: the line may have jumped.
            self.filter.widen(FORCE, innovation);
        }
        self.filter.correct(force_n, self.noise_n2);
        event
    }

    fn slip_step(&mut self, sample: Sample, periods: f64, base: Past, onset: f64) {
        let force_n = f64::from(sample.force_n);
        let since = (sample.index - base.sample.index) as f64;
        let mut without = base.filter;
        without.rest(since);
        let (innovation, variance) = without.innovation(force_n);
        if innovation > -GATE * (variance + self.noise_n2).sqrt() {
            // The force is on the stick line again, so there was no slip.
            without.correct(force_n, self.noise_n2);
            (self.filter, self.mode, self.pending) = (without, Mode::Rest, None);
            return;
        }
        self.filter.predict(|x| slide(x, periods));
        let stopped = self.is_at_rest();
        self.filter.correct(force_n, self.noise_n2);
        self.keep_possible();
        let longest = 2.0 * std::f64::consts::PI / self.filter.x[OMEGA] + 2.0;
        if stopped || since - onset > longest {
            self.mode = Mode::Rest;
        }
    }

    fn is_at_rest(&self) -> bool {
        let x = &self.filter.x;
        x[FORCE] < x[CENTRE] && (x[RATE] - x[LOADING]).abs() <= 1e-9 * x[LOADING].abs()
    }

    /// Goes back to `base` and starts a slip before the last of the later samples.
    fn slip_from(&mut self, base: Past, samples: [Sample; BACK]) {
        self.filter = base.filter;
        self.expect_change();
        let point = |s: Sample| ((s.index - base.sample.index) as f64, f64::from(s.force_n));
        let points = samples.map(point);
        let span = points[BACK - 1].0;
        let x = self.filter.x;
        let error = |(time, force_n): (f64, f64), onset| force_n - moved(&x, onset, time)[FORCE];
        let misfit = |onset: f64| points.map(|p| error(p, onset).powi(2)).iter().sum::<f64>();
        let best = |from: f64, width: f64| {
            let trial = |i: u32| from + width * (f64::from(i) + 0.5) / f64::from(TRIALS);
            let trials = (0..TRIALS).map(trial).map(|onset| (misfit(onset), onset));
            trials.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(from, |(_, onset)| onset)
        };
        let step = span / f64::from(TRIALS);
        let onset = best(best(0.0, span) - 0.5 * step, step);
        let mut before = 0.0;
        for (time, force_n) in points {
            if time <= onset {
                self.filter.rest(time - before);
            } else if before <= onset {
                self.begin(onset - before, time - before, span);
            } else {
                self.filter.predict(|x| slide(x, time - before));
            }
            self.filter.correct(force_n, self.noise_n2);
            self.keep_possible();
            before = time;
        }
        self.pending = Some(base.sample.index as f64 + onset);
        self.slips += 1;
        self.mode = if self.is_at_rest() { Mode::Rest } else { Mode::Slip { base, onset } };
    }

    /// Adds process noise between events: the coefficients vary, cable and winch hardly change.
    fn expect_change(&mut self) {
        let (centre, omega, loading) = DRIFT;
        let x = self.filter.x;
        if self.slips == 0 {
            self.filter.x[CENTRE] = CENTRE_GUESS.0 * x[FORCE];
            self.filter.widen(CENTRE, CENTRE_GUESS.1 * x[FORCE]);
        }
        self.filter.widen(CENTRE, centre * self.setup.weight_n);
        self.filter.widen(OMEGA, omega * x[OMEGA]);
        self.filter.widen(LOADING, loading * x[LOADING]);
    }

    /// Predicts across the onset to the next sample; the onset is uniformly distributed within
    /// `span`.
    fn begin(&mut self, onset: f64, periods: f64, span: f64) {
        let (x, h) = (self.filter.x, 1e-4);
        let along = (moved(&x, onset + h, periods) - moved(&x, onset - h, periods)) / (2.0 * h);
        self.filter.predict(|x| moved(x, onset, periods));
        self.filter.p += along * along.transpose() * (span * span / 12.0);
    }

    /// Limits `omega` and the loading rate to the range of the formulas.
    fn keep_possible(&mut self) {
        let x = &mut self.filter.x;
        x[OMEGA] = x[OMEGA].clamp(0.05, 20.0);
        x[LOADING] = x[LOADING].max(1e-6 * self.setup.weight_n);
    }

    fn close(&mut self, filter: &Filter) -> Option<Found> {
        let onset = self.pending.take()?;
        let (x, p) = (&filter.x, &filter.p);
        if x[STATIC] <= x[CENTRE] {
            return None;
        }
        let value =
            |state: usize| self.setup.value(x[state], Some(p[(state, state)].max(0.0).sqrt()));
        let onset_s = onset / self.setup.rate_hz;
        Some(Found { onset_s, mu_s: value(STATIC), mu: value(CENTRE) })
    }
}
