//! The field display: 128 × 64 points, readable with gloves on.

use core::ops::Range;

use embedded_graphics::Pixel;
use embedded_graphics::image::GetPixel;
use embedded_graphics::mono_font::ascii::FONT_6X10;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{DrawTarget, Point};
use floe_core::{Cause, Change, Estimate, Phase, Report};
use heapless::String;

use crate::app::View;
use crate::line::{Health, Weighed};
use crate::measuring::Hindrance;
use crate::store::CardState;
use crate::text::{Fixed, Out, Show};
use crate::wall_clock::TimeOfDay;

type Row = String<22>;

/// Points of a letter.
const WIDTH: i32 = 6;
const HEIGHT: i32 = 10;

/// Where a row is, how large its letters are, and the lines of a letter that are its own:
/// the first of the ten is free in this font, and the last of the large ones, which has
/// no comma or g, would be in the next row.
struct Place {
    top: i32,
    zoom: i32,
    lines: Range<i32>,
}

const LARGE: Place = Place { top: -2, zoom: 2, lines: 1..HEIGHT - 1 };
const PLACES: [Place; 6] = [LARGE, small(16), small(25), small(35), small(44), small(54)];

const fn small(top: i32) -> Place {
    Place { top, zoom: 1, lines: 1..HEIGHT }
}

/// What the display shows: only what differs from that is drawn, and sent.
#[derive(Debug, Default)]
pub struct Picture {
    rows: [Row; 6],
    bar: i32,
}

impl Picture {
    /// Draws force, state, coefficients and health over what is shown; the first picture
    /// over nothing.
    ///
    /// # Errors
    /// The display's own.
    pub fn draw<D>(&mut self, target: &mut D, view: &View) -> Result<(), D::Error>
    where
        D: DrawTarget<Color = BinaryColor>,
    {
        let rows = rows(view);
        for ((row, shown), place) in rows.iter().zip(&self.rows).zip(&PLACES) {
            text(target, place, shown, row)?;
        }
        self.rows = rows;
        let bar = bar(view.rate_n_per_s.unwrap_or(0.0));
        if bar != self.bar {
            draw_bar(target, bar)?;
        }
        self.bar = bar;
        Ok(())
    }
}

fn rows(view: &View) -> [Row; 6] {
    let [first, second, third, fourth] = match &view.weighed {
        Some(weighed) => weighing(weighed),
        None => pulling(view),
    };
    [force(view), first, second, third, fourth, last_row(view)]
}

/// The rate of the force: a point for each half of a decade from 10 N/s on, negative where
/// it falls.
fn bar(rate_n_per_s: f32) -> i32 {
    const STEPS: [f32; MOST as usize] = [10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10_000.0];
    let points = STEPS.iter().filter(|&&step| rate_n_per_s.abs() >= step).count() as i32;
    if rate_n_per_s > 0.0 { points } else { -points }
}

/// Most points of the bar.
const MOST: i32 = 7;

/// Up or down from the middle of the first row, at its right end.
fn draw_bar<D>(target: &mut D, points: i32) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    const LEFT: i32 = 123;
    const WIDE: i32 = 5;
    let lit = points.min(0)..points.max(0);
    let places = (-MOST..MOST).flat_map(|height| (0..WIDE).map(move |x| (x, height)));
    target.draw_iter(places.map(|(x, height)| {
        let point = Point::new(LEFT + x, MOST - 1 - height);
        Pixel(point, BinaryColor::from(lit.contains(&height)))
    }))
}

/// Coefficients, the newest slip, what the block does.
fn pulling(view: &View) -> [Row; 4] {
    let report = view.report;
    [
        coefficient("mu_s", report.and_then(|r| r.mu_s)),
        coefficient("mu  ", report.and_then(|r| r.mu)),
        about(view),
        state(view),
    ]
}

/// The block's weight so far.
fn weighing(weighed: &Weighed) -> [Row; 4] {
    let (weight, swing) = match weighed.load {
        Ok(load) => {
            let weight = row((Fixed(load.value, 2), " +- ", (Fixed(load.std, 2), " N")));
            let swing = load.swing.map(|swing| {
                let degrees = Fixed(swing.amplitude_rad.to_degrees(), 1);
                row(("swing ", Fixed(swing.period_s, 2), (" s ", degrees, " deg")))
            });
            (weight, swing.unwrap_or_else(|| row("no swing seen")))
        }
        Err(Hindrance::Short) => (row("weighing"), row("8 s of rest needed")),
        Err(Hindrance::Drifts) => (row("weighing"), row("it DRIFTS: wait")),
        Err(Hindrance::Moves) => (row("weighing"), row("it MOVES: calm it")),
        Err(Hindrance::OutOfRange) => (row("weighing"), row("OUT OF RANGE")),
    };
    [weight, swing, row((weighed.duration_s as u32, " s of 64")), row("accept or abort?")]
}

/// Writes the letters of a row that are not shown yet.
fn text<D>(target: &mut D, place: &Place, shown: &str, row: &str) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    let letters = |row: &str, column| row.as_bytes().get(column).copied().unwrap_or(b' ');
    for column in 0..shown.len().max(row.len()) {
        let wanted = letters(row, column);
        if wanted != letters(shown, column) {
            letter(target, place, column as i32, wanted)?;
        }
    }
    Ok(())
}

fn letter<D>(target: &mut D, place: &Place, column: i32, letter: u8) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    let &Place { top, zoom, ref lines } = place;
    let points = lines.clone().flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    target.draw_iter(points.flat_map(|(x, y)| {
        let colour = BinaryColor::from(is_lit(letter, x, y));
        let corner = Point::new((column * WIDTH + x) * zoom, top + y * zoom);
        let square = (0..zoom).flat_map(move |y| (0..zoom).map(move |x| Point::new(x, y)));
        square.map(move |point| Pixel(corner + point, colour))
    }))
}

/// Is a point of a letter lit?
fn is_lit(letter: u8, x: i32, y: i32) -> bool {
    // The font's picture begins with the space and has 16 letters a line.
    let place = i32::from(letter) - i32::from(b' ');
    let point = Point::new(place % 16 * WIDTH + x, place / 16 * HEIGHT + y);
    FONT_6X10.image.pixel(point) == Some(BinaryColor::On)
}

fn row(content: impl Show) -> Row {
    let mut row = Row::new();
    // What is too long is cut: there is no more room anyway.
    content.show(&mut Out::new(&mut row));
    row
}

fn force(view: &View) -> Row {
    match view.force_n {
        Some(force_n) => row((Fixed(force_n, 1), " N")),
        None => row("--- N"),
    }
}

fn coefficient(name: &str, estimate: Option<Estimate>) -> Row {
    match estimate {
        Some(e) => match e.combined_std() {
            Some(std) => row(((name, " ", Fixed(e.mean, 4)), " +- ", Fixed(std, 4))),
            None => row(((name, " ", Fixed(e.mean, 4)), " +- ?")),
        },
        None => row((name, " ---")),
    }
}

fn state(view: &View) -> Row {
    let phase = match view.phase {
        Phase::Unknown => "",
        Phase::Stick => "sticks",
        Phase::Slip => "SLIPS",
    };
    match view.report {
        Some(report) => row((report.events, " events ", phase)),
        None => match view.unix_ms {
            Some(unix_ms) => row(("no test  ", TimeOfDay(unix_ms))),
            None => row("no test, clock not set"),
        },
    }
}

/// The first answer on the newest slip, mu_s and mu.
fn about(view: &View) -> Row {
    let Some(answer) = view.provisional else { return Row::new() };
    let mu_s = ("about ", Fixed(answer.mu_s.value, 3), " ");
    match answer.mu {
        Some(mu) => row((mu_s, Fixed(mu.value, 3))),
        None => row((mu_s, "---")),
    }
}

/// What to know of the test, if all is well with the board.
fn last_row(view: &View) -> Row {
    match &view.report {
        Some(Report { change: Some(change), .. }) if is_well(&view.health) => changed(change),
        Some(Report { zero_n: Some(zero_n), .. }) if is_well(&view.health) => {
            row(("zero off? ", Fixed(*zero_n, 1), " N"))
        }
        _ => health(view),
    }
}

/// Since which event what is another.
fn changed(change: &Change) -> Row {
    let event = change.event;
    match change.cause {
        Cause::Mass => row((event, ": weight x ", Fixed(change.weight_ratio, 3))),
        Cause::Friction => row((event, ": other friction")),
        Cause::Unknown => row((event, ": weigh block")),
    }
}

fn lost(health: &Health) -> u32 {
    health.overruns.saturating_add(health.adc_faults)
}

/// Nothing to tell of the board but that it runs.
fn is_well(health: &Health) -> bool {
    lost(health) == 0 && health.store_failures == 0
}

fn health(view: &View) -> Row {
    let health = &view.health;
    let lost = (" lost ", lost(health).min(9_999_999));
    match view.card {
        CardState::Making(percent) => row(("card ", u32::from(percent), (" %", lost))),
        CardState::Ready if health.store_failures == 0 => row(("card ok", lost)),
        CardState::Ready => row(("card was away", lost)),
        CardState::NoCard => row(("NO CARD", lost)),
        CardState::Unreadable
        | CardState::ExFat
        | CardState::Fat12
        | CardState::NotFat
        | CardState::NoRoom => row(("BAD CARD", lost)),
    }
}

#[cfg(test)]
mod pictures;
#[cfg(test)]
mod tests {
    use super::*;
    use crate::weighing::{Load, Swing};
    use embedded_graphics::Drawable;
    use embedded_graphics::mock_display::MockDisplay;
    use embedded_graphics::mono_font::MonoTextStyle;
    use embedded_graphics::text::{Baseline, Text};
    use floe_core::{Coefficient, Provisional, SampleTime};

    pub(super) fn nothing() -> View {
        View {
            force_n: None,
            rate_n_per_s: None,
            weighed: None,
            unix_ms: None,
            report: None,
            phase: Phase::Unknown,
            provisional: None,
            health: Health::default(),
            card: CardState::Ready,
        }
    }

    /// The lit points of the display's left half.
    fn picture(view: &View) -> Vec<Point> {
        let mut display = MockDisplay::new();
        display.set_allow_out_of_bounds_drawing(true);
        display.set_allow_overdraw(true);
        Picture::default().draw(&mut display, view).unwrap();
        lit(&display)
    }

    fn lit(display: &MockDisplay<BinaryColor>) -> Vec<Point> {
        let points = (0..64).flat_map(|x| (0..64).map(move |y| Point::new(x, y)));
        points.filter(|&p| display.get_pixel(p) == Some(BinaryColor::On)).collect()
    }

    #[test]
    fn letters_are_the_fonts() {
        let row: String<32> = (b' '..=b'~').step_by(3).map(char::from).collect();
        for (place, letters) in row.as_bytes().chunks(10).enumerate() {
            let letters = core::str::from_utf8(letters).unwrap();
            let (mut ours, mut fonts) = (MockDisplay::new(), MockDisplay::new());
            text(&mut ours, &small(10 * place as i32), "", letters).unwrap();
            let style = MonoTextStyle::new(&FONT_6X10, BinaryColor::On);
            let at = Point::new(0, 10 * place as i32);
            Text::with_baseline(letters, at, style, Baseline::Top).draw(&mut fonts).unwrap();
            assert_eq!(lit(&ours), lit(&fonts), "{letters}");
        }
    }

    #[test]
    fn large_digits_end_above_the_next_row() {
        let mut display = MockDisplay::new();
        display.set_allow_out_of_bounds_drawing(true);
        text(&mut display, &LARGE, "", "-0.8 N").unwrap();
        let drawn = |y| (0..64).any(|x| display.get_pixel(Point::new(x, y)).is_some());
        let lines: Vec<i32> = (0..64).filter(|&y| drawn(y)).collect();
        assert_eq!((lines.first(), lines.last()), (Some(&0), Some(&15)));
        // What its place leaves out has nothing of these letters.
        let last_line = |letter| (0..WIDTH).any(|x| is_lit(letter, x, HEIGHT - 1));
        assert!(!b"-0123456789. N".iter().any(|&letter| last_line(letter)));
    }

    #[test]
    fn what_is_known_is_drawn() {
        let health = Health::default();
        let empty = View { health, card: CardState::Ready, ..nothing() };
        let force = View { force_n: Some(-8888.8), ..empty };
        assert!(picture(&force).len() > picture(&empty).len());
        let mu_s = Coefficient::random(1.24, 0.01);
        let provisional = Some(Provisional { mu_s, mu: None });
        let about = View { provisional, ..empty };
        assert!(picture(&about).len() > picture(&empty).len());
    }

    #[test]
    fn numbers_are_rounded() {
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
        assert_eq!(changed(&told(Cause::Mass)).as_str(), "99999: weight x 0.653");
        assert_eq!(changed(&told(Cause::Friction)).as_str(), "99999: other friction");
        assert_eq!(changed(&told(Cause::Unknown)).as_str(), "99999: weigh block");
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
        assert_eq!(last_row(&view).as_str(), "zero off? 14.3 N");
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
        assert_eq!(coefficient("mu_s", Some(estimate)).as_str(), "mu_s 1.2000 +- 0.1000");
        let one = Estimate { std_error: None, events: 1, ..estimate };
        assert_eq!(coefficient("mu", Some(one)).as_str(), "mu 1.2000 +- ?");
        let health = Health { overruns: u32::MAX, store_failures: 1, ..Health::default() };
        let mu = Coefficient::random(-11.234, 0.1);
        let provisional = Some(Provisional { mu_s: mu, mu: Some(mu) });
        let card = CardState::NoCard;
        let view = View { force_n: Some(-65_432.1), provisional, health, card, ..nothing() };
        assert_eq!(about(&view).as_str(), "about -11.234 -11.234");
        assert!(force(&view).len() <= 10, "twice as large: 10 letters a row");
        assert_eq!(super::health(&view).as_str(), "NO CARD lost 9999999");
        let swing = Some(Swing { period_s: 3.45, amplitude_rad: 0.2, excess: 12.0 });
        let load = Ok(Load { value: 3299.99, std: 0.12, swing });
        let [weight, swing, ..] = weighing(&Weighed { duration_s: 64.0, load });
        assert_eq!(weight.as_str(), "3299.99 +- 0.12 N");
        assert_eq!(swing.as_str(), "swing 3.45 s 11.5 deg");
    }
}
