//! The report of a replay: one self-contained HTML file.
//!
//! ```text
//!  Step, every sample ─► Recorder ─┐
//!                                  ├─► render ─► result, figures, table
//!  ReplayResult ───────────────────┘
//! ```
//!
//! Figures are SVG, each for a wide and for a narrow screen; colours follow the reader's light or
//! dark setting. The size of the file is bounded, whatever the length of the log.

mod budget;
mod campaign;
mod clips;
mod closer;
mod context;
mod convergence;
mod correlation;
mod envelope;
mod figure;
mod fit;
mod history;
mod number;
mod page;
mod phase_plane;
mod plot;
mod policy;
mod provenance;
mod recorder;
mod residuals;
mod running;
#[cfg(test)]
mod sample_log;
mod scale;
mod shading;
mod summary;
mod svg;
mod table;
#[cfg(test)]
mod tests;
mod zoom;

pub use campaign::render_campaign;
pub use provenance::Provenance;
pub use recorder::Recorder;

use crate::replay::result::ReplayResult;

/// The page for a result and the samples of its `recorder`.
#[must_use]
pub fn render(result: &ReplayResult, recorder: &Recorder, provenance: &Provenance) -> String {
    page::page(&context::Context::new(result, recorder), provenance)
}

/// The figures as SVG files: name and content.
#[must_use]
pub fn figures(result: &ReplayResult, recorder: &Recorder) -> Vec<(String, String)> {
    page::drawings(&context::Context::new(result, recorder))
}
