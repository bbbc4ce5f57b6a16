//! Pictures of the display for the documentation (`docs/display/`), drawn by the display's own
//! code. `FLOE_GOLDEN=write` writes them again.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

use crate::weighing::{Load, Swing};
use embedded_graphics::framebuffer::{Framebuffer, buffer_size};
use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::pixelcolor::raw::{BigEndian, RawU1};
use floe_core::{Cause, Change, Coefficient, Estimate, Phase, Pipeline, Provisional, Report};
use floe_core::{Config, SampleTime};

use super::Picture;
use super::tests::nothing;
use crate::app::View;
use crate::line::{Health, Weighed};
use crate::measuring::Hindrance;
use crate::store::CardState;

const WIDTH: usize = 128;
const HEIGHT: usize = 64;

type Screen = Framebuffer<
    BinaryColor,
    RawU1,
    BigEndian,
    WIDTH,
    HEIGHT,
    { buffer_size::<BinaryColor>(WIDTH, HEIGHT) },
>;

/// The picture on black; neighbouring lit pixels of a row form one bar.
fn svg(screen: &Screen) -> String {
    let lit = |x: usize, y: usize| screen.pixel(Point::new(x as i32, y as i32));
    let mut bars = String::new();
    for y in 0..HEIGHT {
        let row: Vec<_> = (0..WIDTH).map(|x| lit(x, y) == Some(BinaryColor::On)).collect();
        let mut x = 0;
        for lit in row.chunk_by(|a, b| a == b) {
            if lit[0] {
                let _ = write!(bars, "M{x} {y}h{}v1h-{}z", lit.len(), lit.len());
            }
            x += lit.len();
        }
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-4 -4 136 72\" width=\"408\" \
         height=\"216\">\n<rect x=\"-4\" y=\"-4\" width=\"136\" height=\"72\" rx=\"3\" \
         fill=\"#0a0e14\"/>\n<path fill=\"#8fd3ff\" d=\"{bars}\"/>\n</svg>\n"
    )
}

fn report(change: Option<Change>) -> Report {
    let config = Config { weight_n: 630.0, ..Config::default() };
    let none = Pipeline::new(&config).expect("a weight").report();
    let estimate = |mean, std_error| {
        Some(Estimate {
            mean,
            std_error: Some(std_error),
            freedom: 32.0,
            systematic_std: 0.0,
            common_std: 0.0,
            spread: None,
            events: 33,
        })
    };
    let (mu_s, mu) = (estimate(1.2403, 0.0007), estimate(0.7801, 0.0004));
    Report { events: 33, mu_s, mu, change, ..none }
}

/// Name of each picture and the view that it shows.
fn views() -> [(&'static str, View); 9] {
    let idle = View { force_n: Some(0.3), ..nothing() };
    let set = View { unix_ms: Some(1_803_982_507_000), ..idle };
    let swing = Some(Swing { period_s: 2.01, amplitude_rad: 0.0873, excess: 1.2 });
    let load = Ok(Load { value: 630.02, std: 0.05, swing });
    let weighing = |load| View {
        force_n: Some(631.4),
        weighed: Some(Weighed { duration_s: 40.0, load }),
        ..set
    };
    let pulling = View { report: Some(report(None)), ..set };
    let sticks =
        View { force_n: Some(612.5), rate_n_per_s: Some(361.0), phase: Phase::Stick, ..pulling };
    let coefficient = |value| Coefficient::random(value, 0.01);
    let provisional = Provisional { mu_s: coefficient(1.239), mu: Some(coefficient(0.781)) };
    let slips = View {
        force_n: Some(402.8),
        rate_n_per_s: Some(-4180.0),
        phase: Phase::Slip,
        provisional: Some(provisional),
        ..pulling
    };
    let onset = SampleTime { index: 964, fraction: 0.4 };
    let change = Change {
        event: 33,
        onset,
        cause: Cause::Mass,
        weight_ratio: 0.653,
        weight_ratio_std: 0.019,
    };
    let broke = View { report: Some(report(Some(change))), ..sticks };
    let no_card = Health { store_failures: 12, overruns: 3, ..Health::default() };
    [
        ("idle-no-clock", idle),
        ("idle", set),
        ("weighing", weighing(load)),
        ("weighing-drifts", weighing(Err(Hindrance::Drifts))),
        ("first-stick", View { report: None, ..sticks }),
        ("sticks", sticks),
        ("slips", slips),
        ("block-broke", broke),
        ("no-card", View { health: no_card, card: CardState::NoCard, ..sticks }),
    ]
}

#[test]
fn the_pictures_of_the_documentation_are_the_displays() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/display");
    let write = env::var("FLOE_GOLDEN").is_ok_and(|value| value == "write");
    for (name, view) in views() {
        let mut screen = Screen::new();
        let Ok(()) = Picture::default().draw(&mut screen, &view);
        let (path, picture) = (folder.join(format!("{name}.svg")), svg(&screen));
        if write {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, &picture).unwrap();
        }
        let kept = fs::read_to_string(&path).unwrap_or_default();
        assert!(picture == kept, "{}: FLOE_GOLDEN=write writes it", path.display());
    }
}

#[test]
fn a_picture_over_another_is_as_one_over_nothing() {
    for (_, before) in views() {
        for (name, view) in views() {
            let (mut fresh, mut drawn_over) = (Screen::new(), Screen::new());
            let mut picture = Picture::default();
            let Ok(()) = Picture::default().draw(&mut fresh, &view);
            let Ok(()) = picture.draw(&mut drawn_over, &before);
            let Ok(()) = picture.draw(&mut drawn_over, &view);
            assert!(drawn_over == fresh, "{name}");
        }
    }
}
