//! Stick or slip: the state of the block, sample by sample.
//!
//! ```text
//!            falls from the stick line by more than the noise
//!            and by more than a part of the usual drop
//!   ┌───────┐ ────────────── Onset ──────────────► ┌──────┐
//!   │ Stick │                                      │ Slip │
//!   └───────┘ ◄──── Restick, or Cancelled ──────── └──────┘
//!            has stopped falling, and stays below the line
//! ```
//!
//! *Stick line*: the straight line followed recursively since the block came to
//! rest. *Innovation*: a sample minus the line's forecast. *Noise*: the running
//! scale of the innovations. No limit is in newtons: all are multiples of the noise
//! or parts of the drops seen so far.
//!
//! Delay: an onset is known one or two samples after it, a re-stick two samples
//! after the lowest one (half the slip's length for longer slips).

use crate::line::Line;
use crate::math;
use crate::memory::Memory;
use crate::noise::Noise;
use crate::pending::since;
use crate::sample::Phase;
use crate::window::{WINDOW, Window};

/// Samples whose innovation exceeds this many standard deviations are not on the line.
const OFF_LINE: f32 = 6.0;
/// Least drop of the first slip, standard deviations of the noise.
const FIRST_DROP: f32 = 8.0;
/// Least drop of a slip when the usual drop is known, or when there is no line.
const LEAST_DROP: f32 = 6.0;
/// Least drop of a slip that starts in the upper half of the last one's range,
/// parts of the usual drop. Flop of the cable starts in the lower half.
const LEAST_PART: f32 = 0.35;
/// Least drop of a slip that starts in the lower half.
const LEAST_PART_LOW: f32 = 0.5;
/// Rise that ends a slip at once, parts of its drop.
const CLEAR_RISE: f32 = 0.12;
/// Fewest samples that make a stick line.
const LINE_POINTS: u32 = 4;
/// A slip leaves the force lower by at least this part of its drop; a spike does not.
const LEAST_SHIFT: f32 = 0.4;
/// So many samples in a row off the line, all on one side: the line starts anew;
/// twice as many on both sides as well.
const NEW_LINE: u32 = 3;
/// Weight below which a sample does not count for the start of a line.
const LEAST_WEIGHT: f32 = 0.02;
/// A line's mean time is kept below this, periods.
const FAR: f32 = 64.0;
/// A gap longer than this starts anew, periods.
const LONGEST_GAP: u64 = 8;

/// A sample and where it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extreme {
    /// Index of the sample.
    pub index: u64,
    /// Its force, N.
    pub force_n: f32,
}

/// What a sample changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// A slip has begun.
    Onset,
    /// The block rests again; the stick line that ended is [`Detector::ended`].
    Restick {
        /// Highest sample before the slip.
        peak: Extreme,
        /// Lowest sample.
        low: Extreme,
    },
    /// What looked like a slip was none.
    Cancelled,
    /// A long gap: what was before cannot be continued.
    Lost,
}

/// The stick line since the last re-stick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stick {
    /// Index of the first sample: time zero of `first`.
    pub origin: u64,
    /// Where the line is now: ends at the next onset.
    pub line: Line,
    /// Index at time zero of `line` and `trial`: stays near them, so that a block that
    /// rests for days costs no digits.
    line_origin: u64,
    /// The line as it started, unless `straight`.
    first: Line,
    /// All samples so far are on one line, with endless memory: `line` is also how
    /// it started.
    straight: bool,
    /// Weight of the next sample in `first`; zero: `first` is complete.
    first_weight: f32,
    /// The line with another memory, on trial.
    trial: Line,
    /// Next index to be taken into the line.
    pub next: u64,
    /// Highest sample since the re-stick.
    pub highest: Extreme,
    /// Samples in a row off the line, and how many of them on the last one's side.
    strikes: u32,
    same_side: u32,
    strike_sign: f32,
}

impl Stick {
    /// At rest from an index on.
    fn new(origin: u64, highest: Extreme, straight: bool) -> Self {
        let (line_origin, next, first_weight) = (origin, origin, 1.0);
        Self { origin, line_origin, next, highest, straight, first_weight, ..Self::default() }
    }

    /// The line as it started, at the last re-stick; times from an index on.
    #[must_use]
    pub fn first_from(&self, index: u64) -> Line {
        if self.straight { self.line_from(index) } else { moved(self.first, self.origin, index) }
    }

    /// The line as it is now; times from an index on.
    #[must_use]
    pub fn line_from(&self, index: u64) -> Line {
        moved(self.line, self.line_origin, index)
    }

    /// Begins the line anew, from an index on; keeps how it started.
    fn start_line(&mut self, index: u64) {
        self.first = self.first_from(self.origin);
        (self.straight, self.first_weight, self.strikes) = (false, 0.0, 0);
        (self.line, self.trial, self.line_origin) = (Line::default(), Line::default(), index);
    }

    /// Leaves out a line that does not describe the force: only the last samples
    /// before the highest one count.
    fn forget_line(&mut self) {
        (self.line, self.first) = (Line::default(), Line::default());
        self.next = self.next.min(self.origin.max(self.highest.index.saturating_sub(3)));
    }

    /// Takes a sample into the lines.
    fn take(&mut self, index: u64, force_n: f32, memory: &Memory) {
        let time = since(self.line_origin, index);
        self.line.fade(memory.fade());
        self.line.add(time, force_n, 1.0);
        self.trial.fade(memory.trial_fade());
        self.trial.add(time, force_n, 1.0);
        if !self.straight && self.first_weight > LEAST_WEIGHT {
            self.first.add(since(self.origin, index), force_n, self.first_weight);
            self.first_weight *= memory.fade();
        }
        if self.line.time >= FAR {
            self.line.shift(FAR);
            self.trial.shift(FAR);
            self.line_origin += FAR as u64;
        }
    }
}

/// A line whose time begins at one index, with times from another one on.
fn moved(mut line: Line, from: u64, to: u64) -> Line {
    line.shift(since(from, to));
    line
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Detector {
    window: Window,
    noise: Noise,
    /// The noise's standard deviations at the newest sample, N.
    std_n: Option<f32>,
    line_std_n: Option<f32>,
    memory: Memory,
    phase: Phase,
    stick: Stick,
    ended: Stick,
    lowest: Extreme,
    /// Newest sample.
    last: Extreme,
    /// Usual drop of a slip, N; zero before the first.
    usual_drop_n: f32,
    /// Usual time from the highest to the lowest sample, periods.
    usual_fall: f32,
    /// Middle of the last slip's range, N.
    middle_n: f32,
}

impl Detector {
    /// Before the first sample, for a rate in hertz.
    #[must_use]
    pub fn new(rate_hz: f32) -> Self {
        Self {
            window: Window::new(),
            noise: Noise::new(),
            std_n: None,
            line_std_n: None,
            memory: Memory::new(),
            phase: Phase::Unknown,
            stick: Stick::default(),
            ended: Stick::default(),
            lowest: Extreme::default(),
            last: Extreme::default(),
            usual_drop_n: 0.0,
            // A fifth of a second: replaced by the first slip.
            usual_fall: 0.2 * rate_hz,
            middle_n: 0.0,
        }
    }

    /// What the block is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Highest sample before the slip and lowest one so far.
    #[must_use]
    pub fn extremes(&self) -> (Extreme, Extreme) {
        (self.stick.highest, self.lowest)
    }

    /// Would the slip be over if this sample, the next one, is no spike?
    #[must_use]
    pub fn turns_with(&self, next: Extreme) -> bool {
        self.phase == Phase::Slip && next.force_n > self.lowest.force_n && self.turns(next)
    }

    /// Has the force stopped falling?
    fn turns(&self, now: Extreme) -> bool {
        let std = self.std_n.unwrap_or(0.0);
        let drop = self.stick.highest.force_n - self.lowest.force_n;
        let fall = self.lowest.index - self.stick.highest.index;
        let rise = now.force_n - self.lowest.force_n;
        let rises = rise > (4.0 * std).min(0.5 * drop).max(CLEAR_RISE * drop);
        rises || now.index - self.lowest.index >= fall.div_ceil(2).max(2)
    }

    /// The newest sample.
    #[must_use]
    pub fn last(&self) -> Extreme {
        self.last
    }

    /// The last samples.
    #[must_use]
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// The stick line since the last re-stick.
    #[must_use]
    pub fn stick(&self) -> &Stick {
        &self.stick
    }

    /// The stick line before the last slip, or before the last long gap.
    #[must_use]
    pub fn ended(&self) -> &Stick {
        &self.ended
    }

    /// Standard deviation of the noise, N, to about 10 %.
    #[must_use]
    pub fn noise_n(&self) -> Option<f32> {
        self.std_n
    }

    /// Usual drop of a slip, N; zero before the first.
    #[must_use]
    pub fn usual_drop_n(&self) -> f32 {
        self.usual_drop_n
    }

    /// Takes the noise that the fits of the events leave, N.
    pub fn fitted_noise(&mut self, noise_n: f32) {
        self.noise.fitted(noise_n);
    }

    /// Takes a good sample with an index past all earlier ones.
    pub fn step(&mut self, index: u64, force_n: f32) -> Option<Transition> {
        let now = Extreme { index, force_n };
        let gap = index.saturating_sub(self.last.index);
        self.window.push(index, force_n);
        let started = self.phase != Phase::Unknown;
        self.noise.see(force_n, started && gap == 1);
        (self.line_std_n, self.std_n) = self.noise.std_n(force_n);
        self.last = now;
        if !started || gap > LONGEST_GAP {
            self.rest_from(now, index);
            return started.then_some(Transition::Lost);
        }
        match self.phase {
            Phase::Unknown | Phase::Stick => self.stick_step(now),
            Phase::Slip => self.slip_step(now),
        }
    }

    /// A new stick line whose first sample is `next`.
    fn rest_from(&mut self, highest: Extreme, next: u64) {
        self.phase = Phase::Stick;
        self.memory.decide();
        self.ended = self.stick;
        if !self.line_fits() {
            self.ended.forget_line();
        }
        let straight = self.memory.is_endless();
        self.stick = Stick::new(next, highest, straight);
    }

    fn stick_step(&mut self, now: Extreme) -> Option<Transition> {
        if now.force_n > self.stick.highest.force_n && !self.jumps(now) {
            self.stick.highest = now;
        }
        if self.slips(now) {
            self.phase = Phase::Slip;
            self.lowest = now;
            return Some(Transition::Onset);
        }
        self.extend_line(now.index);
        None
    }

    /// Is the sample far above all before and above the stick line: more than one
    /// spike in a row?
    fn jumps(&self, now: Extreme) -> bool {
        let Some(std) = self.std_n else { return false };
        let far = OFF_LINE * std;
        let is_above = |(innovation, spread)| innovation > far * spread;
        now.force_n > self.stick.highest.force_n + far && self.innovation(now).is_some_and(is_above)
    }

    /// Has the force left the stick line downwards, by more than noise and flop do?
    fn slips(&self, now: Extreme) -> bool {
        let Some(std) = self.std_n else { return false };
        let stick = &self.stick;
        let part = if stick.highest.force_n > self.middle_n { LEAST_PART } else { LEAST_PART_LOW };
        let usual = self.usual_drop_n;
        let least = if usual > 0.0 {
            (LEAST_DROP * std).max(part * usual)
        } else if self.line_fits() {
            FIRST_DROP * std
        } else {
            LEAST_DROP * std
        };
        if stick.highest.force_n - now.force_n < least {
            return false;
        }
        match self.innovation(now) {
            Some((innovation, spread)) => innovation < -OFF_LINE * std * spread,
            // Rests too briefly for a line: the drop alone decides.
            None => true,
        }
    }

    /// Does the stick line describe the force, or does the block never rest long
    /// enough?
    fn line_fits(&self) -> bool {
        match (self.line_std_n, self.std_n) {
            (Some(line), Some(std)) => line < 2.5 * std,
            _ => true,
        }
    }

    /// Sample minus the line's forecast, N, and its standard deviation in units of
    /// the noise. `None` with fewer than four samples on the line.
    fn innovation(&self, now: Extreme) -> Option<(f32, f32)> {
        let stick = &self.stick;
        let slope = stick.line.slope().filter(|_| stick.line.count >= LINE_POINTS)?;
        let time = since(stick.line_origin, now.index);
        let spread = math::rough_sqrt(1.0 + stick.line.leverage(time));
        Some((now.force_n - stick.line.at(time, slope), spread))
    }

    /// Takes samples into the line, far enough behind the newest one that a slip
    /// which has just begun, unseen, does not bend it.
    fn extend_line(&mut self, newest: u64) {
        let delay = 2 + (0.3 * self.usual_fall) as u64;
        while self.stick.next + delay.min(WINDOW as u64 / 4) <= newest {
            let index = self.stick.next;
            self.stick.next += 1;
            if let Some(force_n) = self.window.get(index) {
                self.take_into_line(Extreme { index, force_n });
            }
        }
    }

    fn take_into_line(&mut self, sample: Extreme) {
        let time = since(self.stick.line_origin, sample.index);
        if let Some((innovation, spread)) = self.innovation(sample) {
            let relative = innovation / spread;
            let std = self.line_std_n;
            self.noise.add(relative);
            if std.is_some_and(|std| relative.abs() > OFF_LINE * std) {
                return self.strike(sample.index, relative);
            }
            if let Some(slope) = self.stick.trial.slope() {
                self.memory.compare(innovation, sample.force_n - self.stick.trial.at(time, slope));
            }
        }
        self.stick.strikes = 0;
        self.stick.take(sample.index, sample.force_n, &self.memory);
    }

    /// A sample off the line is left out; several on one side start a new line.
    fn strike(&mut self, index: u64, innovation: f32) {
        let stick = &mut self.stick;
        stick.strikes += 1;
        let same = stick.strikes > 1 && innovation * stick.strike_sign > 0.0;
        stick.same_side = if same { stick.same_side + 1 } else { 1 };
        stick.strike_sign = innovation;
        if stick.same_side < NEW_LINE && stick.strikes < 2 * NEW_LINE {
            return;
        }
        let start = (index + 1).saturating_sub(u64::from(NEW_LINE));
        stick.start_line(start);
        for past in start..=index {
            if let Some(force_n) = self.window.get(past) {
                stick.take(past, force_n, &self.memory);
            }
        }
    }

    fn slip_step(&mut self, now: Extreme) -> Option<Transition> {
        if now.force_n < self.lowest.force_n {
            self.lowest = now;
        }
        let peak = self.stick.highest;
        let fall = self.lowest.index - peak.index;
        if now.index - peak.index > WINDOW as u64 * 3 / 4 {
            self.rest_from(now, now.index);
            return Some(Transition::Lost);
        }
        if !self.turns(now) {
            return None;
        }
        let drop = peak.force_n - self.lowest.force_n;
        Some(if self.is_back(now, drop) { self.cancel(now) } else { self.restick(now, drop, fall) })
    }

    /// Is the force back on the old stick line, as after a spike?
    fn is_back(&self, now: Extreme, drop: f32) -> bool {
        let innovation = self.innovation(now).filter(|_| self.line_fits());
        innovation.is_some_and(|(innovation, _)| innovation > -LEAST_SHIFT * drop)
    }

    fn restick(&mut self, now: Extreme, drop: f32, fall: u64) -> Transition {
        let (peak, low) = (self.stick.highest, self.lowest);
        self.middle_n = 0.5 * (peak.force_n + low.force_n);
        if self.usual_drop_n > 0.0 {
            let change = (drop - self.usual_drop_n).clamp(-0.5 * self.usual_drop_n, drop);
            self.usual_drop_n = (self.usual_drop_n + 0.25 * change).max(0.5 * drop);
            self.usual_fall += 0.25 * (fall as f32 - self.usual_fall);
        } else {
            self.usual_drop_n = drop;
            self.usual_fall = fall as f32;
        }
        self.rest_from(now, now.index + 1);
        for index in low.index..now.index {
            let earlier = self.window.get(index).unwrap_or(f32::MIN);
            if earlier > self.stick.highest.force_n {
                self.stick.highest = Extreme { index, force_n: earlier };
            }
        }
        Transition::Restick { peak, low }
    }

    /// Back to the old line, without the samples that looked like a slip.
    fn cancel(&mut self, now: Extreme) -> Transition {
        self.phase = Phase::Stick;
        self.stick.next = now.index + 1;
        Transition::Cancelled
    }
}
