//! A Kalman filter that switches between the two modes of the block.
//!
//! State, time in sampling periods: `F`, `F'`, `k w`, `Fp`, `omega`, `Fs`. At rest
//! `F` grows by `k w` a period; in a slip `(F, F')` turns about `(Fp, 0)` with
//! `omega` until `F'` is `k w` again: both modes in closed form, linearized by
//! difference quotients (extended Kalman filter). A sample far below the forecast
//! starts a slip: the filter goes back four samples and tries onsets after them;
//! the onset's uncertainty enters as noise, so `Fs` stays correlated with all that
//! follows and is refined until the next onset, when the event is given.
//!
//! Our own filter of few lines on `nalgebra`: the switch needs copies of the whole
//! filter to go back to and noise along one direction of the state, which the
//! filters of `minikalman` (state on the heap, not to be copied) and `adskalman`
//! (linear transitions) do not offer.

use super::method::{Found, Method, Sample, Setup, Tick, Value};

mod filter;

use filter::{CENTRE, FORCE, Filter, LOADING, OMEGA, RATE, STATIC, moved, slide};

/// Innovations beyond this many standard deviations do not belong to the mode.
const GATE: f64 = 5.0;
/// Samples that a slip may go back.
const BACK: usize = 4;
/// Onsets that are tried: so many over the whole span, then so many around the best.
const TRIALS: u32 = 9;
/// Before the first slip: `Fp` over `Fs`, and its uncertainty.
const CENTRE_GUESS: (f64, f64) = (0.62, 0.15);
/// From event to event: change of `Fp` over the weight, of `omega` and of `k w`
/// over themselves.
const DRIFT: (f64, f64, f64) = (0.1, 0.01, 0.01);
/// Samples in a row that fit no mode, until the filter starts anew.
const STRIKES: u32 = 4;
/// Samples before anything is declared.
const LEARNING: f64 = 8.0;
/// The noise is followed by this quantile of the second differences, which slips and
/// bends of the line hardly move; their value there for noise of one; step per sample.
const NOISE_QUANTILE: f64 = 0.3;
const QUANTILE_AT: f64 = 0.943_8;
const NOISE_STEP: f64 = 0.1;

/// What the block does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one is kept, in place")]
enum Mode {
    Rest,
    /// Began between these samples.
    Slip {
        /// The one before, with the filter then.
        base: Past,
        /// Periods after it.
        onset: f64,
    },
}

/// A filter after a sample.
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
    /// Samples since the filter started.
    samples: f64,
    /// The last samples, newest first.
    past: [Option<Past>; BACK],
    /// Onset of the event that is still being refined, periods.
    pending: Option<f64>,
    /// Slips since the filter started.
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
            // Neither rest nor slip as the model has them: the line may have jumped.
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
            // Back on the stick line: it was no slip.
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

    /// Goes back to `base` and lets a slip begin before the last of the samples since.
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

    /// From event to event the coefficients vary, the cable and the winch hardly.
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

    /// Moves through the onset to the sample after it; the onset may be anywhere
    /// within `span`, evenly.
    fn begin(&mut self, onset: f64, periods: f64, span: f64) {
        let (x, h) = (self.filter.x, 1e-4);
        let along = (moved(&x, onset + h, periods) - moved(&x, onset - h, periods)) / (2.0 * h);
        self.filter.predict(|x| moved(x, onset, periods));
        self.filter.p += along * along.transpose() * (span * span / 12.0);
    }

    /// Keeps `omega` and the loading rate where the formulas hold.
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
        let value = |state: usize| {
            let std = p[(state, state)].max(0.0).sqrt() * self.setup.per_newton();
            let value = Value::bare(self.setup.coefficient(x[state]))?;
            Some(Value { std: Some(std), ..value })
        };
        let onset_s = onset / self.setup.rate_hz;
        Some(Found { onset_s, mu_s: value(STATIC), mu: value(CENTRE) })
    }
}
