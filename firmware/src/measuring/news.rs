//! Messages during a measurement.

use super::Span;
use crate::line::{Decimal, Text};
use crate::settings::Settings;
use crate::text::{Fixed, join};
use crate::weighing::{Load, Rest};

/// Largest deviation of a weight from the line relative to the largest weight; more points to wrong
/// weights rather than the cell.
const AGREE: f32 = 2e-3;
/// Fraction of the range below which the largest weight causes a warning.
const FEW: f32 = 0.05;
/// Fraction of the range above which a change of the zero suggests a load on the hook.
const LOADED: f32 = 0.02;
/// Usual ratio of a new span to the previous one: the span of a cell does not double.
const USUAL: core::ops::Range<f32> = 0.5..2.0;

/// Message on the zero, with a warning if the hook seems loaded.
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

/// Message on the span, with a warning if it is implausible.
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
