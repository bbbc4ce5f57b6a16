//! The field display: 128 × 64 pixels, readable with gloves on.

use core::ops::Range;

use embedded_graphics::Pixel;
use embedded_graphics::image::GetPixel;
use embedded_graphics::mono_font::ascii::FONT_6X10;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{DrawTarget, Point};

mod rows;

use crate::app::View;
pub use rows::{Row, rows};

/// Size of a letter, pixels.
const WIDTH: i32 = 6;
const HEIGHT: i32 = 10;

/// Position and magnification of a row of text, and the pixel lines of a letter that are drawn. The
/// first of the ten lines is empty in this font. The last of large letters would overlap the next
/// row, and is empty too without a comma or g.
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

/// The contents of the display; only differences from them are drawn and sent.
#[derive(Debug, Default)]
pub struct Picture {
    rows: [Row; 6],
    bar: i32,
}

impl Picture {
    /// Draws the changes from the current contents to a view; the first picture is drawn on an
    /// empty display.
    ///
    /// # Errors
    /// An error of the display.
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

/// Length of the bar for a rate of the force, pixels: one per half decade from 10 N/s, negative for
/// a falling force.
fn bar(rate_n_per_s: f32) -> i32 {
    const STEPS: [f32; MOST as usize] = [10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0, 10_000.0];
    let points = STEPS.iter().filter(|&&step| rate_n_per_s.abs() >= step).count() as i32;
    if rate_n_per_s > 0.0 { points } else { -points }
}

/// Largest length of the bar, pixels.
const MOST: i32 = 7;

/// Draws the bar up or down from the middle of the first row, at its right end.
fn draw_bar<D>(target: &mut D, points: i32) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    const LEFT: i32 = 123;
    const WIDE: i32 = 5;
    let lit = points.min(0)..points.max(0);
    for height in -MOST..MOST {
        let colour = BinaryColor::from(lit.contains(&height));
        for x in LEFT..LEFT + WIDE {
            draw_point(target, Point::new(x, MOST - 1 - height), colour)?;
        }
    }
    Ok(())
}

fn draw_point<D>(target: &mut D, point: Point, colour: BinaryColor) -> Result<(), D::Error>
where
    D: DrawTarget<Color = BinaryColor>,
{
    target.draw_iter(core::iter::once(Pixel(point, colour)))
}

/// Draws those letters of a row that differ from the letters shown.
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
    for y in zoom * lines.start..zoom * lines.end {
        for x in 0..zoom * WIDTH {
            let colour = BinaryColor::from(is_lit(letter, x / zoom, y / zoom));
            draw_point(target, Point::new(column * WIDTH * zoom + x, top + y), colour)?;
        }
    }
    Ok(())
}

/// Whether a pixel of a letter is lit.
fn is_lit(letter: u8, x: i32, y: i32) -> bool {
    // The font's image begins with the space and has 16 letters per line.
    let place = i32::from(letter) - i32::from(b' ');
    let point = Point::new(place % 16 * WIDTH + x, place / 16 * HEIGHT + y);
    FONT_6X10.image.pixel(point) == Some(BinaryColor::On)
}

#[cfg(test)]
mod pictures;
#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::Health;
    use crate::store::CardState;
    use embedded_graphics::Drawable;
    use embedded_graphics::mock_display::MockDisplay;
    use embedded_graphics::mono_font::MonoTextStyle;
    use embedded_graphics::text::{Baseline, Text};
    use floe_core::{Coefficient, Phase, Provisional};
    use heapless::String;

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

    /// The lit pixels of the display's left half.
    pub(super) fn picture(view: &View) -> Vec<Point> {
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
        // The omitted last line is empty for these letters.
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
}
