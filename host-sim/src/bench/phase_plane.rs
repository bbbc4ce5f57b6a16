//! The phase plane as a person reads it: `Fs` where the trajectory leaves the stick
//! line, `Fe` where it comes back, the ellipse's centre half-way, `Fp = (Fs + Fe)/2`.

use super::loops::{Loop, LoopReading, OfLoops};

/// The method.
pub type PhasePlane = OfLoops<Ends>;

/// The loop's two ends on the stick line.
#[derive(Clone, Copy, Debug)]
pub struct Ends;

impl LoopReading for Ends {
    const NAME: &'static str = "phase plane";

    fn forces_n(found: &Loop) -> Option<(f64, f64)> {
        let (start, end) = found.ends()?;
        Some((start.force_n, 0.5 * (start.force_n + end.force_n)))
    }
}
