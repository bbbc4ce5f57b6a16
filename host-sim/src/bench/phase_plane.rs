//! Manual reading of the phase plane: `Fs` where the trajectory leaves the stick line, `Fe` where
//! it returns, and the ellipse's centre half-way, `Fp = (Fs + Fe)/2`.

use super::loops::{Loop, LoopReading, OfLoops};

/// The method.
pub type PhasePlane = OfLoops<Ends>;

/// Reading of a loop by its two intersections with the stick line.
#[derive(Clone, Copy, Debug)]
pub struct Ends;

impl LoopReading for Ends {
    const NAME: &'static str = "phase plane";

    fn forces_n(found: &Loop) -> Option<(f64, f64)> {
        let (start, end) = found.ends()?;
        Some((start.force_n, 0.5 * (start.force_n + end.force_n)))
    }
}
