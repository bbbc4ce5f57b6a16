//! Compares the result on the display and in `floe live` with the console.

use embedded_graphics::framebuffer::{Framebuffer, buffer_size};
use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::pixelcolor::raw::{BigEndian, RawU1};
use floe::live;
use floe_core::{Phase, Report};
use floe_firmware::app::View;
use floe_firmware::display::{Picture, rows};
use floe_firmware::line::{Health, Line};
use floe_firmware::store::CardState;

const WIDTH: usize = 128;
const HEIGHT: usize = 64;
/// Pixel rows of both coefficients.
const COEFFICIENTS: std::ops::Range<usize> = 16..35;
/// Size of a terminal with room for all text, but not for large digits.
const TERMINAL: (u16, u16) = (72, 30);

type Screen = Framebuffer<
    BinaryColor,
    RawU1,
    BigEndian,
    WIDTH,
    HEIGHT,
    { buffer_size::<BinaryColor>(WIDTH, HEIGHT) },
>;

/// The display's picture, one line per row of pixels; `#` is lit.
#[must_use]
pub fn picture(view: &View) -> Vec<String> {
    let mut screen = Screen::new();
    let Ok(()) = Picture::default().draw(&mut screen, view);
    let is_lit = |x, y| screen.pixel(Point::new(x, y)) == Some(BinaryColor::On);
    let row = |y| (0..WIDTH as i32).map(|x| if is_lit(x, y) { '#' } else { '.' }).collect();
    (0..HEIGHT as i32).map(row).collect()
}

/// The last report on the console.
#[must_use]
pub fn last_report(console: &str) -> Option<Report> {
    let report = |line| match line {
        Ok(Line::Report(report)) => Some(report),
        _ => None,
    };
    console.lines().rev().find_map(|text| report(Line::parse(text)))
}

/// Text of `floe live` for the console's output, with single spaces.
#[must_use]
pub fn live_words(console: &str) -> String {
    let screen = live::shown(console, TERMINAL).join("\n");
    screen.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Mean and ± of both coefficients in the display's form: `mu_s 1.2401 +- 0.0035`.
#[must_use]
pub fn coefficients(report: &Report) -> [String; 2] {
    let [_, mu_s, mu, ..] = rows(&view(*report)).map(|row| row.to_string());
    [mu_s, mu]
}

fn view(report: Report) -> View {
    View {
        force_n: None,
        rate_n_per_s: None,
        weighed: None,
        unix_ms: None,
        report: Some(report),
        phase: Phase::Unknown,
        provisional: None,
        health: Health::default(),
        card: CardState::Ready,
    }
}

/// Checks that both coefficients on a picture of the display and in `floe live` are those of the
/// console's last report, to the last digit shown. Returns them.
///
/// # Errors
/// The coefficients that differ.
pub fn agree(console: &str, photograph: &[String]) -> Result<[String; 2], String> {
    let report = last_report(console).ok_or("no result was said")?;
    let drawn = picture(&view(report));
    if photograph.get(COEFFICIENTS) != drawn.get(COEFFICIENTS) {
        let [shown, said] = [photograph, &drawn[..]].map(|it| it.join("\n"));
        return Err(format!("the display shows\n{shown}\nand not\n{said}"));
    }
    let (said, words) = (coefficients(&report), live_words(console));
    for row in &said {
        let shown = live_row(row, report.events).ok_or("no ± was said")?;
        if !words.contains(&shown) {
            return Err(format!("floe live does not show {shown}: {words}"));
        }
    }
    Ok(said)
}

/// The form of a display's row in `floe live`.
fn live_row(row: &str, events: u32) -> Option<String> {
    let (name, value) = row.split_once(' ')?;
    let (mean, std) = value.trim().split_once(" +- ")?;
    Some(format!("{name}, mean {mean} ± {std} ({events} events)"))
}
