//! What is said while something is measured.

use super::Span;
use crate::line::{Decimal, Text};
use crate::settings::Settings;
use crate::text::{Fixed, join};
use crate::weighing::{Load, Rest};

/// Weights that disagree by less, as a part, say more of the weights than of the cell.
const AGREE: f32 = 2e-3;
/// A known weight below this part of the range gives the span of its corner only.
const FEW: f32 = 0.05;
/// A zero that moves by more than this part of the range has something hanging on it.
const LOADED: f32 = 0.02;
/// The span of a cell does not double.
const USUAL: core::ops::Range<f32> = 0.5..2.0;

/// The zero, and whether something hangs there.
pub(super) fn tare(rest: &Rest, settings: &Settings) -> Text {
    let calibration = &settings.config.calibration;
    let moved_n = (rest.mean - calibration.tare_counts as f32) / calibration.counts_per_n;
    let warning = if moved_n.abs() > LOADED * settings.range_n() {
        "; DOES ANYTHING HANG THERE?"
    } else {
        ""
    };
    join(&[
        &"zero ",
        &Fixed(rest.mean, 1),
        &" +- ",
        &Fixed(rest.std, 1),
        &" codes, scatter ",
        &Fixed(rest.scatter, 1),
        &", moves by ",
        &Fixed(moved_n, 2),
        &" N",
        &warning,
        &": accept, or abort",
    ])
}

/// The span, and what is odd about it.
pub(super) fn span(span: Span, load: &Load, settings: &Settings) -> Text {
    let Span { counts_per_n, std, residual_n, largest_n } = span;
    let before = settings.config.calibration.counts_per_n;
    let warning = if counts_per_n < 0.0 {
        "; REVERSED: the reading falls under load"
    } else if residual_n > AGREE * largest_n {
        "; THE WEIGHTS DISAGREE"
    } else if !USUAL.contains(&(counts_per_n / before)) {
        "; NOT THE SAME CELL as before?"
    } else if largest_n < FEW * settings.range_n() {
        "; LITTLE OF THE RANGE: hang more"
    } else {
        ""
    };
    let swing_deg = load.swing.map_or(0.0, |swing| swing.amplitude_rad.to_degrees());
    join(&[
        &"span ",
        &Decimal(counts_per_n),
        &" +- ",
        &Fixed(std, 4),
        &" codes per N, off by ",
        &Fixed(residual_n, 3),
        &" N, swing ",
        &Fixed(swing_deg, 1),
        &" deg",
        &warning,
        &": accept, abort, or hang another and calibrate N",
    ])
}
