//! Stamps whose last digit is close to the sampling period: 103 or 98 samples a second with two
//! decimals.

use super::fine::digit_s;
use super::rows::Row;
use super::timing::{Shared, Timing, median};

/// The timing of stamps that advance by their last digit and regularly repeat or skip one, with
/// different readings. Mistakes are not so regular. `None` for all other stamps, and for a given
/// rate that does not agree with them.
#[allow(clippy::float_cmp)] // a stamp that is repeated is repeated exactly
pub(super) fn beating(
    rows: &[Row],
    given_hz: Option<f64>,
    step_s: f64,
    unit_s: f64,
) -> Option<Timing> {
    const NEAR: f64 = 1e-3;
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let mut places = [
        places(rows, |a, b| a.time_s == b.time_s && a.reading != b.reading),
        places(rows, |a, b| b.time_s - a.time_s > 1.5 * step_s),
    ];
    places.sort_by_key(Vec::len);
    let [others, usual] = places;
    let is_digit = (digit_s(&times, unit_s) / step_s - 1.0).abs() < NEAR;
    let is_one_kind = 4 * others.len() <= usual.len();
    let Beat { rows, rate_hz: own_hz } =
        Beat::of(&usual, &others, &times).filter(|_| is_digit && is_one_kind)?;
    let rate_hz = given_hz.unwrap_or(own_hz);
    let first = times.iter().zip(0_u32..).take(rows);
    let starts_s: f64 = first.map(|(time_s, row)| time_s - f64::from(row) / rate_hz).sum();
    let shared = Some(Shared { step: step_s * rate_hz, centre: 0.0 });
    let is_own = (rate_hz / own_hz - 1.0).abs() < NEAR;
    is_own.then_some(Timing { rate_hz, start_s: starts_s / rows as f64, shared })
}

/// Indices at which two consecutive rows satisfy a condition.
fn places(rows: &[Row], is_such: impl Fn(&Row, &Row) -> bool) -> Vec<usize> {
    let such = |w: &[Row]| matches!(w, [a, b] if is_such(a, b));
    rows.windows(2).enumerate().filter(|(_, w)| such(w)).map(|(at, _)| at).collect()
}

/// Rows between places at nearly equal distances, and the resulting rate.
struct Beat {
    rows: usize,
    rate_hz: f64,
}

impl Beat {
    /// A span with one of `others` has lost a sample and is not used.
    fn of(places: &[usize], others: &[usize], times: &[f64]) -> Option<Self> {
        /// Fewest places, and fewest rows between them.
        const ENOUGH: usize = 9;
        const FEWEST: f64 = 20.0;
        /// Largest relative deviation from the usual distance.
        const SAME: f64 = 0.1;
        let spans = places.windows(2).filter_map(|w| {
            let (first, last) = (*w.first()?, *w.last()?);
            let is_whole = !others.iter().any(|other| (first..last).contains(other));
            is_whole.then_some(((last - first) as f64, times.get(last)? - times.get(first)?))
        });
        let usual = median(spans.clone().map(|(rows, _)| rows).collect())?;
        let even: Vec<(f64, f64)> =
            spans.filter(|(rows, _)| (rows / usual - 1.0).abs() <= SAME).collect();
        let are_even = places.len() >= ENOUGH && 4 * even.len() >= 3 * (places.len() - 1);
        let (rows, span_s) = even.iter().fold((0.0, 0.0), |sum, it| (sum.0 + it.0, sum.1 + it.1));
        let rate_hz: f64 = rows / span_s;
        // The number of rows is uncertain by one at either end.
        let is_whole = (rate_hz / rate_hz.round() - 1.0).abs() < 2.0 / (usual * rows);
        let rate_hz = if is_whole { rate_hz.round() } else { rate_hz };
        (are_even && usual >= FEWEST).then_some(Self { rows: usual as usize, rate_hz })
    }
}
