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
//! Delay: an onset high on the line is known at the first sample that is clearly below
//! the line, a re-stick two samples after the lowest one (half the slip's length for
//! longer slips). The spike filter before adds a sample; [`Detector::foresees_slip`]
//! looks at the sample that it holds, so the phase that is shown has no such delay.
//!
//! Before the noise is known nothing can be told: once it is, and while there was no
//! slip, the window is looked at again, a few samples a step.

mod slack_wait;

use crate::detector::slack_wait::SlackWait;
use crate::effect::{Effect, Effects};
use crate::noise::flop::FlopProfile;
use crate::noise::forgetting::Forgetting;
use crate::noise::ripple::{ColoredNoise, Ripple};
use crate::noise::scale::Noise;
use crate::num::math::{self, larger, smaller};
use crate::sample::{ForcePoint, Phase, since};
use crate::signal::window::{WINDOW, Window};
use crate::stats::line::Line;

/// Samples whose innovation exceeds this many standard deviations are not on the line.
const OFF_LINE: f32 = 6.0;
/// Least drop of the first slip, standard deviations of the noise.
const FIRST_DROP: f32 = 8.0;
/// Least drop of a slip when the usual drop is known, or when there is no line.
const LEAST_DROP: f32 = 6.0;
/// Least drop of a slip that starts in the upper half of the usual range, parts of
/// the usual drop: a part of the contact may slip. Flop of the cable starts in the
/// lower half.
const LEAST_PART: f32 = 0.05;
/// The same without a line, where one sample too high would feign a drop.
const LEAST_PART_BRIEF: f32 = 0.35;
/// Least drop of a slip that starts in the lower half.
const LEAST_PART_LOW: f32 = 0.5;
/// A larger fall in one sample, usual drops, is not taken for a slip beforehand.
const LARGEST_DROP: f32 = 1.1;
/// Most noise, usual drops: with more of it they could not have been told.
const MOST_NOISE: f32 = 0.1;
/// Rise that ends a slip at once, parts of its drop.
const CLEAR_RISE: f32 = 0.12;
/// Fewest samples that make a stick line.
const LINE_POINTS: u32 = 4;
/// A slip leaves the force lower by at least this part of its drop; a spike does not.
const LEAST_SHIFT: f32 = 0.4;
/// The same without a line, below the sample before the highest one.
const LEAST_SHIFT_BRIEF: f32 = 0.1;
/// So many samples in a row off the line, all on one side: the line starts anew;
/// twice as many on both sides as well.
const NEW_LINE: u32 = 3;
/// Weight below which a sample does not count for the start of a line.
const LEAST_WEIGHT: f32 = 0.02;
/// Samples looked at in a step, while catching up.
const CATCH_UP: u32 = 3;
/// Part of the noise thought of that makes it worth looking at all samples again.
const LESS_NOISE: f32 = 0.4;
/// A line's mean time is kept below this, periods.
const FAR: f32 = 64.0;
/// A gap longer than this starts anew, periods.
const LONGEST_GAP: u64 = 8;

/// Samples of a longer stick that the profile looks at.
const PROFILE: u64 = WINDOW as u64 * 3 / 4;

/// What a sample changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// A slip has begun.
    Onset,
    /// The block rests again; the stick line that ended is [`Detector::ended`].
    Restick {
        /// Highest sample before the slip.
        peak: ForcePoint,
        /// Lowest sample.
        low: ForcePoint,
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
    pub straight: bool,
    /// The rate has broken off: the winch paused, or turned at another speed.
    pub broken: bool,
    /// Weight of the next sample in `first`; zero: `first` is complete.
    first_weight: f32,
    /// The line with another memory, on trial.
    trial: Line,
    /// Next index to be taken into the line.
    pub next: u64,
    /// Highest sample since the re-stick.
    pub highest: ForcePoint,
    /// Samples in a row off the line, and how many of them on the last one's side.
    strikes: u32,
    same_side: u32,
    strike_sign: f32,
}

impl Stick {
    /// At rest from an index on.
    fn new(origin: u64, highest: ForcePoint, straight: bool) -> Self {
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
        self.keep_first();
        self.strikes = 0;
        (self.line, self.trial, self.line_origin) = (Line::default(), Line::default(), index);
    }

    /// Keeps how the line started: from here on it is another one.
    fn keep_first(&mut self) {
        self.first = self.first_from(self.origin);
        (self.straight, self.first_weight) = (false, 0.0);
    }

    /// Goes on with the line on trial.
    fn take_trial(&mut self) {
        self.keep_first();
        self.line = core::mem::take(&mut self.trial);
    }

    /// Leaves out a line that does not describe the force: only the last samples
    /// before the highest one count.
    fn forget_line(&mut self) {
        (self.line, self.first) = (Line::default(), Line::default());
        self.next = self.next.min(self.origin.max(self.highest.index.saturating_sub(3)));
    }

    /// Takes a sample into the lines; its weight is one over its variance.
    #[inline]
    fn take(&mut self, index: u64, force_n: f32, memory: &Forgetting, weight: f32) {
        let time = since(self.line_origin, index);
        self.line.fade(memory.fade());
        self.line.add(time, force_n, weight, weight);
        if memory.has_trial() {
            self.trial.fade(memory.trial_fade());
            self.trial.add(time, force_n, weight, weight);
        }
        if !self.straight && self.first_weight > LEAST_WEIGHT {
            self.first.add(since(self.origin, index), force_n, self.first_weight, 1.0);
            self.first_weight *= memory.fade();
        }
        if self.line.time >= FAR {
            self.line.shift(FAR);
            self.trial.shift(FAR);
            self.line_origin += FAR as u64;
        }
    }
}

/// How far a stick line stays behind, for a usual fall and a time of creep in periods.
fn line_delay(usual_fall: f32, creep_periods: f32) -> u64 {
    (2 + (0.3 * usual_fall + creep_periods) as u64).min(WINDOW as u64 / 4)
}

/// A line whose time begins at one index, with times from another one on.
fn moved(mut line: Line, from: u64, to: u64) -> Line {
    line.shift(since(from, to));
    line
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Detector {
    effects: Effects,
    window: Window,
    noise: Noise,
    /// The noise's standard deviations at the newest sample, N.
    std_n: Option<f32>,
    line_std_n: Option<f32>,
    memory: Forgetting,
    whiteness: Ripple,
    profile: FlopProfile,
    phase: Phase,
    stick: Stick,
    ended: Stick,
    /// The cable may hang slack: the stick line has yet to start.
    floor: Option<SlackWait>,
    lowest: ForcePoint,
    /// Newest sample looked at, and the index from which to look on.
    last: ForcePoint,
    next: u64,
    /// Newest index taken.
    newest: u64,
    /// Most noise with which the samples were looked at, N.
    judged_with_n: f32,
    /// Usual drop of a slip, N; zero before the first.
    usual_drop_n: f32,
    /// Usual time from the highest to the lowest sample, periods.
    usual_fall: f32,
    /// The line stays so many samples behind the newest one.
    line_delay: u64,
    /// Time before an onset in which creep bends the line, periods.
    creep_periods: f32,
    /// Half the usual drop below the last highest sample, N.
    middle_n: f32,
    /// A stick line that has not risen above this ends in no slip, N.
    ceiling_n: f32,
}

impl Detector {
    /// Before the first sample, for a rate in hertz.
    #[must_use]
    pub fn new(rate_hz: f32, effects: Effects) -> Self {
        // A fifth of a second: replaced by the first slip.
        let usual_fall = 0.2 * rate_hz;
        Self {
            effects,
            window: Window::new(),
            noise: Noise::new(),
            std_n: None,
            line_std_n: None,
            memory: Forgetting::new(),
            whiteness: Ripple::default(),
            profile: FlopProfile::default(),
            phase: Phase::Unknown,
            stick: Stick::default(),
            ended: Stick::default(),
            floor: None,
            lowest: ForcePoint::default(),
            last: ForcePoint::default(),
            next: 0,
            newest: 0,
            judged_with_n: f32::INFINITY,
            usual_drop_n: 0.0,
            usual_fall,
            line_delay: line_delay(usual_fall, 0.0),
            creep_periods: 0.0,
            middle_n: 0.0,
            ceiling_n: f32::NEG_INFINITY,
        }
    }

    /// What the block is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Highest sample before the slip and lowest one so far.
    #[must_use]
    pub fn extremes(&self) -> (ForcePoint, ForcePoint) {
        (self.stick.highest, self.lowest)
    }

    /// Would the slip be over if this sample, the next one, is no spike?
    #[must_use]
    pub fn turns_with(&self, next: ForcePoint) -> bool {
        self.phase == Phase::Slip
            && self.is_up_to_date()
            && next.force_n > self.lowest.force_n
            && self.turns(next)
    }

    /// Has the force stopped falling?
    fn turns(&self, now: ForcePoint) -> bool {
        let std = self.std_n.unwrap_or(0.0);
        let drop = self.stick.highest.force_n - self.lowest.force_n;
        let fall = self.lowest.index - self.stick.highest.index;
        let rise = now.force_n - self.lowest.force_n;
        let rises = rise > larger(smaller(4.0 * std, 0.5 * drop), CLEAR_RISE * drop);
        rises || now.index - self.lowest.index >= fall.div_ceil(2).max(2)
    }

    /// The newest sample looked at.
    #[must_use]
    pub fn last(&self) -> ForcePoint {
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

    /// How the force strays from a straight stick line, beside the noise.
    #[must_use]
    pub fn wander(&self) -> ColoredNoise {
        self.whiteness.wander()
    }

    /// Weight of the samples between the lowest one and the newest, all of them together.
    #[must_use]
    pub fn rest_weight(&self) -> f32 {
        self.profile.weight(-0.5 * since(self.lowest.index, self.last.index))
    }

    /// Usual drop of a slip, N; zero before the first.
    #[must_use]
    pub fn usual_drop_n(&self) -> f32 {
        self.usual_drop_n
    }

    /// Do the rests of late show an effect of the noise?
    #[must_use]
    pub fn shows(&self, effect: Effect) -> bool {
        match effect {
            Effect::Flop => !self.profile.is_flat(),
            Effect::Ripple => self.wander().level > 0.0,
            Effect::Forgetting => !self.memory.is_endless(),
            Effect::Corner
            | Effect::Sag
            | Effect::Stiffening
            | Effect::Mass
            | Effect::Level
            | Effect::Drift
            | Effect::Damping => false,
        }
    }

    /// Takes the noise that the fits of the events leave, N.
    pub fn fitted_noise(&mut self, noise_n: f32) {
        self.noise.fitted(noise_n);
    }

    /// So many periods before the onset creep bends the line: they are not taken into it.
    pub fn creeps(&mut self, periods: f32) {
        // They are kept one by one, as the slip is.
        const ROOM: f32 = 48.0;
        self.creep_periods = periods.min(ROOM - self.usual_fall).max(0.0);
        self.line_delay = line_delay(self.usual_fall, self.creep_periods);
    }

    /// Where the force is constant nothing slips before it has risen above this, N.
    pub fn stays_below(&mut self, ceiling_n: Option<f32>) {
        self.ceiling_n = ceiling_n.unwrap_or(f32::NEG_INFINITY);
    }

    /// Takes a good sample with an index past all earlier ones.
    pub fn step(&mut self, index: u64, force_n: f32) -> Option<Transition> {
        let lies = self.floor.is_some_and(|floor| floor.is_long());
        self.noise.see(force_n, index == self.newest + 1 && !lies);
        if self.is_up_to_date() {
            self.next = index;
        }
        self.newest = index;
        self.window.push(index, force_n);
        (self.line_std_n, self.std_n) = self.noise.std_n(force_n);
        if self.usual_drop_n > 0.0 {
            let most_n = MOST_NOISE * self.usual_drop_n;
            self.std_n = self.std_n.map(|std| smaller(std, most_n));
        }
        self.judge_again();
        if self.next < index {
            return self.catch_up(CATCH_UP);
        }
        self.next = index + 1;
        self.look(ForcePoint { index, force_n })
    }

    /// Looks at samples that were taken and not yet looked at, as many as given, up
    /// to the first transition. At the end of a test: until it returns `None`.
    pub fn catch_up(&mut self, most: u32) -> Option<Transition> {
        for _ in 0..most {
            if self.is_up_to_date() {
                return None;
            }
            let index = self.window.first_from(self.next);
            self.next = index + 1;
            if let Some(force_n) = self.window.get(index) {
                let transition = self.look(ForcePoint { index, force_n });
                if transition.is_some() {
                    return transition;
                }
            }
        }
        None
    }

    /// Has it looked at all that it was given?
    #[must_use]
    pub fn is_up_to_date(&self) -> bool {
        self.next > self.newest
    }

    /// Without any slip so far, and with far less noise than was thought: looks at
    /// all samples in the window again.
    fn judge_again(&mut self) {
        let undecided = self.usual_drop_n <= 0.0 && self.phase != Phase::Slip;
        let Some(std) = self.std_n.filter(|_| undecided) else { return };
        if std < LESS_NOISE * self.judged_with_n {
            self.judged_with_n = std;
            self.whiteness = Ripple::default();
            self.next = 0;
            self.phase = Phase::Unknown;
        } else {
            self.judged_with_n = larger(self.judged_with_n, std);
        }
    }

    /// Follows one sample.
    fn look(&mut self, now: ForcePoint) -> Option<Transition> {
        let index = now.index;
        let started = self.phase != Phase::Unknown;
        let gap = index.saturating_sub(self.last.index);
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
    fn rest_from(&mut self, highest: ForcePoint, next: u64) {
        self.phase = Phase::Stick;
        if self.stick.next < self.stick.origin + PROFILE {
            self.learn_profile();
        }
        self.memory.decide();
        self.whiteness.interrupt();
        self.ended = self.stick;
        if !self.line_fits() {
            self.ended.forget_line();
        }
        if self.floor.take().is_some() {
            // It slipped as soon as it rose: what came before the peak may be slack.
            self.ended.origin = self.ended.highest.index;
            self.ended.next = self.ended.origin;
        }
        let straight = self.memory.is_endless();
        self.stick = Stick::new(next, highest, straight);
    }

    fn stick_step(&mut self, now: ForcePoint) -> Option<Transition> {
        if now.force_n > self.stick.highest.force_n {
            if !self.jumps(now) {
                self.stick.highest = now;
            }
        } else if self.slips(now) {
            self.phase = Phase::Slip;
            self.lowest = now;
            return Some(Transition::Onset);
        }
        if !self.hangs(now) {
            self.extend_line(now.index);
        }
        None
    }

    /// Does the cable still hang slack? Where its force has risen the line starts.
    fn hangs(&mut self, now: ForcePoint) -> bool {
        let Some(floor) = &mut self.floor else { return false };
        let Some(risen_n) = floor.risen_n(now.force_n) else { return true };
        self.floor = None;
        let since =
            self.ended.line.slope().map_or(0, |rate| slack_wait::periods_above(risen_n, rate));
        let origin = self.stick.origin.max(now.index.saturating_sub(since));
        self.stick = Stick::new(origin, self.stick.highest, self.stick.straight);
        false
    }

    /// Is the sample far above all before and above the stick line: more than one
    /// spike in a row?
    fn jumps(&self, now: ForcePoint) -> bool {
        let Some(std) = self.std_n else { return false };
        let far = OFF_LINE * std;
        // A forecast is never surer than a sample: most are judged without its spread.
        let spread = || self.spread(now, self.variance(now.index));
        let is_above = |off_n| off_n > far && off_n > far * spread();
        now.force_n > self.stick.highest.force_n + far && self.off_line_n(now).is_some_and(is_above)
    }

    /// Has the force left the stick line downwards, by more than noise and flop do?
    fn slips(&self, now: ForcePoint) -> bool {
        let Some(std) = self.std_n else { return false };
        let drop = self.stick.highest.force_n - now.force_n;
        // No slip drops by less: most samples are told at once.
        drop >= LEAST_DROP * std && drop > 0.0 && self.leaves_line(now, drop, std)
    }

    #[inline(never)]
    fn leaves_line(&self, now: ForcePoint, drop: f32, std: f32) -> bool {
        drop >= self.least_drop(std)
            && self.stick.highest.force_n > self.ceiling_n
            // Rests too briefly for a line: the drop alone decides.
            && self.depth(now).is_none_or(|depth| depth > OFF_LINE * std)
    }

    /// Would this sample begin a slip, if it came next and is no spike? Tells before
    /// the sample is judged; nothing is changed. A fall much larger than usual is more
    /// likely a spike.
    #[must_use]
    pub fn foresees_slip(&self, next: ForcePoint) -> bool {
        let drop = self.stick.highest.force_n - next.force_n;
        drop > 0.0
            && self.phase == Phase::Stick
            && self.is_up_to_date()
            && drop < LARGEST_DROP * self.usual_drop_n
            && self.slips(next)
    }

    /// Least drop of a slip, N.
    fn least_drop(&self, std: f32) -> f32 {
        let (stick, usual) = (&self.stick, self.usual_drop_n);
        let has_line = stick.line.count >= LINE_POINTS;
        if usual <= 0.0 {
            // A record may begin in the middle of a slip: that one is not told.
            return match self.line_fits() {
                true if has_line => FIRST_DROP * std,
                false if stick.highest.index > stick.origin => LEAST_DROP * std,
                _ => f32::INFINITY,
            };
        }
        let part = match stick.highest.force_n > self.middle_n {
            true if has_line => LEAST_PART,
            true => LEAST_PART_BRIEF,
            false => LEAST_PART_LOW,
        };
        larger(LEAST_DROP * std, part * usual)
    }

    /// How far a sample lies below the stick line, N, as sure as a single sample of
    /// that depth. `None` with fewer than four samples on the line.
    ///
    /// A rising line goes on above its mean, however little is known of its slope.
    fn depth(&self, now: ForcePoint) -> Option<f32> {
        let off_n = self.off_line_n(now)?;
        let (line, variance) = (&self.stick.line, self.variance(now.index));
        let below_mean =
            (line.level_n - now.force_n) / math::rough_sqrt(variance + 1.0 / line.weight);
        let rises = line.slope().is_some_and(|slope| slope > 0.0);
        let below_line = -off_n / self.spread(now, variance);
        Some(if rises { larger(below_line, below_mean) } else { below_line })
    }

    /// Does the stick line describe the force, or does the block never rest long
    /// enough?
    fn line_fits(&self) -> bool {
        match (self.line_std_n, self.std_n) {
            (Some(line), Some(std)) => line < 2.5 * std,
            _ => true,
        }
    }

    /// Sample minus the line's forecast, N. `None` with fewer than four samples on the line.
    fn off_line_n(&self, now: ForcePoint) -> Option<f32> {
        let stick = &self.stick;
        let slope = stick.line.slope().filter(|_| stick.line.count >= LINE_POINTS)?;
        let time = since(stick.line_origin, now.index);
        Some(now.force_n - stick.line.at(time, slope))
    }

    /// Standard deviation of that in units of a late sample's noise, one or more; the
    /// sample's own variance as from [`Self::variance`].
    fn spread(&self, now: ForcePoint, variance: f32) -> f32 {
        let time = since(self.stick.line_origin, now.index);
        math::rough_sqrt(variance + self.stick.line.leverage(time))
    }

    /// Variance of a resting block's sample over that of a late one.
    fn variance(&self, index: u64) -> f32 {
        self.profile.variance(since(self.stick.origin, index))
    }

    /// Takes the stick line so far into the profile.
    fn learn_profile(&mut self) {
        let (Stick { origin, next, .. }, window) = (self.stick, &self.window);
        let was_flat = self.profile.is_flat();
        let looks = self.effects.has(Effect::Flop);
        if !looks || window.first_from(origin) != origin || !self.profile.is_due() {
            return;
        }
        self.profile.learn((origin..next).map(|index| window.get(index)));
        if was_flat && !self.profile.is_flat() {
            // What the innovations told had the swing in it.
            (self.memory, self.whiteness) = (Forgetting::new(), Ripple::default());
        }
    }

    /// Takes samples into the line, far enough behind the newest one that a slip
    /// which has just begun, unseen, does not bend it, nor creep before it.
    fn extend_line(&mut self, newest: u64) {
        while self.stick.next + self.line_delay <= newest {
            let index = self.stick.next;
            self.stick.next += 1;
            if self.stick.next == self.stick.origin + PROFILE {
                self.learn_profile();
            }
            if let Some(force_n) = self.window.get(index) {
                self.take_into_line(ForcePoint { index, force_n });
            }
        }
    }

    fn take_into_line(&mut self, sample: ForcePoint) {
        let time = since(self.stick.line_origin, sample.index);
        let variance = self.variance(sample.index);
        let weight = 1.0 / variance;
        if let Some(innovation) = self.off_line_n(sample) {
            let relative = innovation / self.spread(sample, variance);
            let std = self.line_std_n;
            self.noise.add(relative);
            if std.is_some_and(|std| relative.abs() > OFF_LINE * std) {
                return self.strike(sample.index, relative);
            }
            if self.effects.has(Effect::Ripple) {
                self.whiteness.add(relative, weight);
            }
            let forgets = self.effects.has(Effect::Forgetting);
            if let Some(slope) = self.stick.trial.slope().filter(|_| forgets) {
                let trial = sample.force_n - self.stick.trial.at(time, slope);
                self.memory.compare(weight * innovation, weight * trial);
                if self.usual_drop_n <= 0.0 && self.memory.has_won() {
                    // Without slips no line would ever end.
                    self.memory.decide();
                    self.stick.take_trial();
                }
            }
        }
        self.stick.strikes = 0;
        self.stick.take(sample.index, sample.force_n, &self.memory, weight);
    }

    /// A sample off the line is left out; several on one side start a new line.
    #[inline(never)]
    fn strike(&mut self, index: u64, innovation: f32) {
        let stick = &mut self.stick;
        stick.strikes += 1;
        let same = stick.strikes > 1 && innovation * stick.strike_sign > 0.0;
        stick.same_side = if same { stick.same_side + 1 } else { 1 };
        stick.strike_sign = innovation;
        if stick.same_side < NEW_LINE && stick.strikes < 2 * NEW_LINE {
            return;
        }
        // The samples that are on it are taken once more.
        let start = (index + 1).saturating_sub(u64::from(NEW_LINE));
        stick.next = start;
        stick.start_line(start);
        // A cable that flops leaves the line as well.
        stick.broken = self.profile.is_flat();
        // What was higher before, a spike perhaps, is not of this line.
        stick.highest = ForcePoint { index: start, force_n: f32::NEG_INFINITY };
        for past in start..=self.last.index {
            let Some(force_n) = self.window.get(past) else { continue };
            if force_n > stick.highest.force_n {
                stick.highest = ForcePoint { index: past, force_n };
            }
        }
    }

    fn slip_step(&mut self, now: ForcePoint) -> Option<Transition> {
        if now.force_n < self.lowest.force_n {
            self.lowest = now;
        }
        let peak = self.stick.highest;
        if now.index - peak.index > WINDOW as u64 * 3 / 4 {
            self.rest_from(now, now.index);
            return Some(Transition::Lost);
        }
        if !self.turns(now) {
            return None;
        }
        let drop = peak.force_n - self.lowest.force_n;
        Some(if self.is_back(now, drop) { self.cancel(now) } else { self.restick(now, drop) })
    }

    /// Is the force back on the old stick line, as after a spike?
    fn is_back(&self, now: ForcePoint, drop: f32) -> bool {
        let off_n = self.off_line_n(now).filter(|_| self.line_fits());
        match (off_n, self.before_peak_n()) {
            (Some(off_n), _) => off_n > -LEAST_SHIFT * drop,
            (None, Some(before_n)) => self.lowest.force_n > before_n - LEAST_SHIFT_BRIEF * drop,
            (None, None) => false,
        }
    }

    /// The sample before the highest one, of the same stick line.
    fn before_peak_n(&self) -> Option<f32> {
        let index = self.stick.highest.index.checked_sub(1)?;
        self.window.get(index).filter(|_| index >= self.stick.origin)
    }

    fn restick(&mut self, now: ForcePoint, drop: f32) -> Transition {
        let peak = self.stick.highest;
        let floor = SlackWait::under(self.lowest, drop, self.std_n);
        let low = if floor.is_some() { self.first_low(peak.index) } else { self.lowest };
        let fall = low.index - peak.index;
        if self.usual_drop_n > 0.0 {
            // Not `clamp`, which panics at a limit that is no number.
            let change = (drop - self.usual_drop_n).max(-0.5 * self.usual_drop_n).min(drop);
            self.usual_drop_n = (self.usual_drop_n + 0.25 * change).max(0.5 * drop);
            self.usual_fall += 0.25 * (fall as f32 - self.usual_fall);
        } else {
            self.usual_drop_n = drop;
            self.usual_fall = fall as f32;
        }
        self.line_delay = line_delay(self.usual_fall, self.creep_periods);
        self.middle_n = peak.force_n - 0.5 * drop.max(self.usual_drop_n);
        self.rest_from(now, now.index + 1);
        self.floor = floor;
        for index in low.index..=now.index {
            let Some(force_n) = self.window.get(index) else { continue };
            if force_n > self.stick.highest.force_n {
                self.stick.highest = ForcePoint { index, force_n };
            }
            if self.floor.as_mut().is_some_and(|floor| floor.risen_n(force_n).is_some()) {
                self.floor = None;
            }
        }
        Transition::Restick { peak, low }
    }

    /// The first sample after the peak that is as low as the lowest one, but for noise:
    /// on a slack cable all are at zero.
    fn first_low(&self, peak: u64) -> ForcePoint {
        let limit_n = self.lowest.force_n + 3.0 * self.std_n.unwrap_or(0.0);
        let sample = |index| Some(ForcePoint { index, force_n: self.window.get(index)? });
        let low = (peak + 1..self.lowest.index).filter_map(sample).find(|s| s.force_n < limit_n);
        low.unwrap_or(self.lowest)
    }

    /// Back to the old line, without the samples that looked like a slip.
    fn cancel(&mut self, now: ForcePoint) -> Transition {
        self.phase = Phase::Stick;
        self.stick.next = now.index + 1;
        if self.stick.line.count < LINE_POINTS {
            self.stick.highest = now;
        }
        Transition::Cancelled
    }
}
