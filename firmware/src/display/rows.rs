//! The text of the display's rows.

use floe_core::{Cause, Change, Effects, Estimate, Phase};
use heapless::String;

use crate::app::View;
use crate::line::{Health, Weighed};
use crate::measuring::Hindrance;
use crate::store::CardState;
use crate::text::{Fixed, Out, Show};
use crate::wall_clock::TimeOfDay;

/// Text of a row; 21 letters fit.
pub type Row = String<21>;

/// All rows, the large one first.
#[must_use]
pub fn rows(view: &View) -> [Row; 6] {
    let mut rows: [Row; 6] = Default::default();
    let [first, middle @ .., last] = &mut rows;
    force(first, view);
    match &view.weighed {
        Some(weighed) => weighing(middle, weighed),
        None => pulling(middle, view),
    }
    last_row(last, view);
    rows
}

/// The rows of a test: coefficients, the newest slip, state of the block.
fn pulling([first, second, third, fourth]: &mut [Row; 4], view: &View) {
    let report = view.report.as_ref();
    coefficient(first, "mu_s", report.and_then(|r| r.mu_s.as_ref()));
    coefficient(second, "mu  ", report.and_then(|r| r.mu.as_ref()));
    about(third, view);
    state(fourth, view);
}

/// The rows of a weighing: the block's weight so far.
fn weighing([weight, swing, duration, advice]: &mut [Row; 4], weighed: &Weighed) {
    let hindered = match &weighed.load {
        Ok(load) => {
            put(weight, (Fixed(load.value, 2), " +- ", (Fixed(load.std, 2), " N")));
            match &load.swing {
                Some(it) => {
                    let degrees = Fixed(it.amplitude_rad.to_degrees(), 1);
                    put(swing, ("swing ", Fixed(it.period_s, 2), (" s ", degrees, " deg")));
                    None
                }
                None => Some("no swing seen"),
            }
        }
        Err(hindrance) => {
            put(weight, "weighing");
            Some(match hindrance {
                Hindrance::Short => "8 s of rest needed",
                Hindrance::Drifts => "it DRIFTS: wait",
                Hindrance::Moves => "it MOVES: calm it",
                Hindrance::OutOfRange => "OUT OF RANGE",
            })
        }
    };
    hindered.into_iter().for_each(|words| put(swing, words));
    put(duration, (weighed.duration_s as u32, " s of 64"));
    put(advice, "accept or abort?");
}

fn force(row: &mut Row, view: &View) {
    match view.force_n {
        Some(force_n) => put(row, (Fixed(force_n, 1), " N")),
        None => put(row, "--- N"),
    }
}

fn coefficient(row: &mut Row, name: &str, estimate: Option<&Estimate>) {
    let Some(estimate) = estimate else { return put(row, (name, " ---")) };
    let mean = (name, " ", (Fixed(estimate.mean, 4), " +- "));
    match estimate.combined_std() {
        Some(std) => put(row, (mean, Fixed(std, 4))),
        None => put(row, (mean, "?")),
    }
}

fn state(row: &mut Row, view: &View) {
    let phase = match view.phase {
        Phase::Unknown => "",
        Phase::Stick => "sticks",
        Phase::Slip => "SLIPS",
    };
    match (&view.report, view.unix_ms) {
        (Some(report), _) => put(row, (report.events, " events ", phase)),
        (None, Some(unix_ms)) => put(row, ("no test  ", TimeOfDay(unix_ms))),
        (None, None) => put(row, "no test, clock unset"),
    }
}

/// First answer on the newest slip: mu_s and mu.
fn about(row: &mut Row, view: &View) {
    let Some(answer) = &view.provisional else { return };
    let mu_s = ("about ", Fixed(answer.mu_s.value, 3), " ");
    match answer.mu {
        Some(mu) => put(row, (mu_s, Fixed(mu.value, 3))),
        None => put(row, (mu_s, "---")),
    }
}

/// The last row: a defect of the board, else a change, a zero that moved, or the random error,
/// which more events would reduce.
fn last_row(row: &mut Row, view: &View) {
    let Some(report) = view.report.as_ref().filter(|_| is_well(&view.health)) else {
        return health(row, view);
    };
    if let Some(change) = &report.change {
        changed(row, change)
    } else if let Some(zero_n) = report.zero_n {
        put(row, ("zero off? ", Fixed(zero_n, 1), " N"))
    } else if let Some(random) = report.mu_s.as_ref().and_then(|mu_s| mu_s.std_error) {
        put(row, ("random ", Fixed(random, 4), Found(report.found)))
    } else {
        health(row, view)
    }
}

/// Names of the effects found, as many as fit.
struct Found(Effects);

impl Show for Found {
    fn show(&self, out: &mut Out<'_>) {
        self.0.iter().for_each(|effect| (" ", effect.name()).show(out));
    }
}

/// The event at which a change was found, and the cause of the change.
fn changed(row: &mut Row, change: &Change) {
    let event = change.event;
    match change.cause {
        Cause::Mass => put(row, (event, ": weight x ", Fixed(change.weight_ratio, 3))),
        Cause::Friction => put(row, (event, ": other friction")),
        Cause::Unknown => put(row, (event, ": weigh block")),
    }
}

fn lost(health: &Health) -> u32 {
    health.overruns.saturating_add(health.adc_faults)
}

/// Whether the board has lost no sample and no sector.
fn is_well(health: &Health) -> bool {
    lost(health) == 0 && health.store_failures == 0
}

fn health(row: &mut Row, view: &View) {
    let health = &view.health;
    let lost = (" lost ", lost(health).min(999_999));
    let card = match view.card {
        CardState::Making(percent) => {
            return put(row, ("card ", u32::from(percent), (" %", lost)));
        }
        CardState::Ready if health.store_failures == 0 => "card ok",
        CardState::Ready => "card back",
        CardState::Full => "CARD FULL",
        CardState::NoCard => "NO CARD",
        CardState::Unreadable
        | CardState::ExFat
        | CardState::Fat12
        | CardState::NotFat
        | CardState::NoRoom => "BAD CARD",
    };
    put(row, (card, lost));
}

/// Writes text into a row; text that is too long is cut.
fn put(row: &mut Row, content: impl Show) {
    content.show(&mut Out::new(row));
}

#[cfg(test)]
mod tests {
    use super::super::tests::{nothing, picture};
    use super::*;
    use crate::weighing::{Load, Swing};
    use floe_core::{Coefficient, Effect, Provisional, Report, SampleTime};

    fn row<T: ?Sized>(write: impl Fn(&mut Row, &T), of: &T) -> Row {
        let mut row = Row::new();
        write(&mut row, of);
        row
    }

    #[test]
    fn numbers_are_rounded() {
        let row = |number: Fixed| row(|row, &number| put(row, number), &number);
        assert_eq!(row(Fixed(-0.04, 1)).as_str(), "0.0");
        assert_eq!(row(Fixed(-0.06, 1)).as_str(), "-0.1");
        assert_eq!(row(Fixed(123.456, 1)).as_str(), "123.5");
        assert_eq!(row(Fixed(1.00004, 4)).as_str(), "1.0000");
        assert_eq!(row(Fixed(0.00996, 4)).as_str(), "0.0100");
    }

    #[test]
    fn a_change_is_told_unless_something_is_wrong() {
        let mut pipeline = floe_core::Pipeline::new(&floe_core::Config {
            weight_n: 630.0,
            ..floe_core::Config::default()
        });
        let report = pipeline.as_mut().unwrap().report();
        let onset = SampleTime { index: 964, fraction: 0.4 };
        let weight = (0.653, 0.019);
        let told = |cause| {
            let (weight_ratio, weight_ratio_std) = weight;
            Change { event: 99_999, onset, cause, weight_ratio, weight_ratio_std }
        };
        assert_eq!(row(changed, &told(Cause::Mass)).as_str(), "99999: weight x 0.653");
        assert_eq!(row(changed, &told(Cause::Friction)).as_str(), "99999: other friction");
        assert_eq!(row(changed, &told(Cause::Unknown)).as_str(), "99999: weigh block");
        let view = |change, overruns| View {
            report: Some(Report { change, ..report }),
            phase: Phase::Stick,
            health: Health { overruns, ..Health::default() },
            card: CardState::Ready,
            ..nothing()
        };
        let change = Some(told(Cause::Mass));
        assert_ne!(picture(&view(change, 0)), picture(&view(None, 0)));
        assert_eq!(picture(&view(change, 3)), picture(&view(None, 3)));
        let zero = Report { zero_n: Some(14.25), ..report };
        let view = View { report: Some(zero), ..view(None, 0) };
        assert_eq!(row(last_row, &view).as_str(), "zero off? 14.3 N");
    }

    #[test]
    fn rows_fit_the_display() {
        let estimate = Estimate {
            mean: 1.2,
            std_error: Some(0.08),
            freedom: 1e6,
            systematic_std: 0.06,
            common_std: 0.0,
            spread: None,
            events: 4_000_000,
        };
        let mu = |name, of: &Estimate| row(|row, it| coefficient(row, name, Some(it)), of);
        assert_eq!(mu("mu_s", &estimate).as_str(), "mu_s 1.2000 +- 0.1000");
        let one = Estimate { std_error: None, events: 1, ..estimate };
        assert_eq!(mu("mu", &one).as_str(), "mu 1.2000 +- ?");
        let health = Health { overruns: u32::MAX, store_failures: 1, ..Health::default() };
        let mu = Coefficient::random(-11.234, 0.1);
        let provisional = Some(Provisional { mu_s: mu, mu: Some(mu) });
        let card = CardState::NoCard;
        let view = View { force_n: Some(-65_432.1), provisional, health, card, ..nothing() };
        assert_eq!(row(about, &view).as_str(), "about -11.234 -11.234");
        assert!(row(force, &view).len() <= 10, "twice as large: 10 letters a row");
        assert_eq!(row(super::health, &view).as_str(), "NO CARD lost 999999");
        let full = View { card: CardState::Full, ..view };
        assert_eq!(row(super::health, &full).as_str(), "CARD FULL lost 999999");
        let back = View { card: CardState::Ready, ..view };
        assert_eq!(row(super::health, &back).as_str(), "card back lost 999999");
        let idle = View { report: None, unix_ms: None, ..nothing() };
        assert_eq!(row(state, &idle).as_str(), "no test, clock unset");
        // The letters cut at the end of the 21-letter row differ.
        let mut pipeline = floe_core::Pipeline::new(&floe_core::Config {
            weight_n: 630.0,
            ..floe_core::Config::default()
        });
        let report = Report { mu_s: Some(estimate), ..pipeline.as_mut().unwrap().report() };
        let well = View { report: Some(report), card: CardState::Ready, ..nothing() };
        assert_eq!(row(last_row, &well).as_str(), "random 0.0800");
        let found = Effects::NONE.with(Effect::Sag, true).with(Effect::Onset, true);
        let shows = |found| View { report: Some(Report { found, ..report }), ..well };
        // The second effect does not fit.
        assert_eq!(row(last_row, &shows(found)).trim_end(), "random 0.0800 sag");
        let found = found.with(Effect::Sag, false);
        assert_eq!(row(last_row, &shows(found)).as_str(), "random 0.0800 onset");
        let swing = Some(Swing { period_s: 3.45, amplitude_rad: 0.2, excess: 12.0 });
        let load = Ok(Load { value: 3299.99, std: 0.12, swing });
        let mut rows: [Row; 4] = Default::default();
        weighing(&mut rows, &Weighed { duration_s: 64.0, load });
        let [weight, swing, ..] = &rows;
        assert_eq!(weight.as_str(), "3299.99 +- 0.12 N");
        assert_eq!(swing.as_str(), "swing 3.45 s 11.5 deg");
    }
}
