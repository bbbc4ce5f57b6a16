//! The field display: 128 × 64 points, readable with gloves on.

use core::fmt::Write;

use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::ascii::{FONT_6X10, FONT_9X15};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{DrawTarget, Point};
use embedded_graphics::text::{Baseline, Text};
use embedded_graphics::{Drawable, mono_font::MonoFont};
use floe_core::{Estimate, Phase};
use heapless::String;

use crate::app::View;

type Row = String<22>;

/// Draws force, state, coefficients and health; clears what was there.
///
/// # Errors
/// The display's own.
pub fn draw<D>(target: &mut D, view: &View) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    target.clear(BinaryColor::Off)?;
    text(target, &FONT_9X15, 0, &force(view))?;
    let report = view.report;
    text(target, &FONT_6X10, 22, &coefficient("mu_s", report.and_then(|r| r.mu_s)))?;
    text(target, &FONT_6X10, 33, &coefficient("mu  ", report.and_then(|r| r.mu)))?;
    text(target, &FONT_6X10, 44, &state(view))?;
    text(target, &FONT_6X10, 54, &health(view))
}

fn text<D>(target: &mut D, font: &MonoFont<'_>, y: i32, row: &str) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    let style = MonoTextStyle::new(font, BinaryColor::On);
    Text::with_baseline(row, Point::new(0, y), style, Baseline::Top).draw(target).map(drop)
}

fn force(view: &View) -> Row {
    let mut row = Row::new();
    // A row that is too long is cut: there is no more room anyway.
    let _ = match view.force_n {
        Some(force_n) => write!(row, "{} N", fixed(force_n, 1)),
        None => write!(row, "--- N"),
    };
    row
}

fn coefficient(name: &str, estimate: Option<Estimate>) -> Row {
    let mut row = Row::new();
    let _ = match estimate {
        Some(e) => write!(row, "{name} {} +- {}", fixed(e.mean, 4), fixed(e.std_error, 4)),
        None => write!(row, "{name} ---"),
    };
    row
}

/// A number with so many decimals, at most 4; the standard library's way would
/// be a tenth of the program.
fn fixed(value: f32, decimals: usize) -> Row {
    let mut row = Row::new();
    let scale = [1.0, 10.0, 100.0, 1_000.0, 10_000.0].get(decimals).copied().unwrap_or(1.0);
    let scaled = value * scale;
    let rounded = (scaled + if scaled < 0.0 { -0.5 } else { 0.5 }) as i32;
    let (whole, rest) = (rounded / scale as i32, (rounded % scale as i32).abs());
    let sign = if rounded < 0 { "-" } else { "" };
    let _ = write!(row, "{sign}{}.{rest:0decimals$}", whole.abs());
    row
}

fn state(view: &View) -> Row {
    let mut row = Row::new();
    let phase = match view.phase {
        Phase::Unknown => "",
        Phase::Stick => "sticks",
        Phase::Slip => "SLIPS",
    };
    let _ = match view.report {
        Some(report) => write!(row, "{} events {phase}", report.events),
        None => write!(row, "no test"),
    };
    row
}

fn health(view: &View) -> Row {
    let mut row = Row::new();
    let health = &view.health;
    let lost = health.overruns.saturating_add(health.adc_faults);
    let card = if health.store_failures > 0 { "NO CARD" } else { "card ok" };
    let _ = write!(row, "{card} lost {lost}");
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::Health;
    use embedded_graphics::mock_display::MockDisplay;

    fn lit(view: &View) -> usize {
        let mut display = MockDisplay::new();
        display.set_allow_out_of_bounds_drawing(true);
        display.set_allow_overdraw(true);
        draw(&mut display, view).unwrap();
        let points = (0..64).flat_map(|x| (0..64).map(move |y| Point::new(x, y)));
        points.filter(|&p| display.get_pixel(p) == Some(BinaryColor::On)).count()
    }

    #[test]
    fn what_is_known_is_drawn() {
        let health = Health::default();
        let empty = View { force_n: None, report: None, phase: Phase::Unknown, health };
        let force = View { force_n: Some(-8888.8), ..empty };
        assert!(lit(&force) > lit(&empty));
    }

    #[test]
    fn numbers_are_rounded() {
        assert_eq!(fixed(-0.04, 1).as_str(), "0.0");
        assert_eq!(fixed(-0.06, 1).as_str(), "-0.1");
        assert_eq!(fixed(123.456, 1).as_str(), "123.5");
        assert_eq!(fixed(1.00004, 4).as_str(), "1.0000");
        assert_eq!(fixed(0.00996, 4).as_str(), "0.0100");
    }

    #[test]
    fn rows_fit_the_display() {
        let estimate = Estimate { mean: 1.2, std_error: 0.1, spread: None, events: 4_000_000 };
        assert_eq!(coefficient("mu_s", Some(estimate)).as_str(), "mu_s 1.2000 +- 0.1000");
        let health = Health { overruns: u32::MAX, store_failures: 1, ..Health::default() };
        let view = View { force_n: Some(-65_432.1), report: None, phase: Phase::Slip, health };
        assert!(force(&view).len() <= 12, "9-point font: 14 characters a row");
        assert!(super::health(&view).len() <= 21, "6-point font: 21 characters a row");
    }
}
