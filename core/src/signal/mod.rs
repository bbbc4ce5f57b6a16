//! From converter codes to clean forces: calibration, spikes, decimation, derivative, and
//! the window of the last samples.

pub mod calibrate;
pub(crate) mod decimate;
pub mod derivative;
pub(crate) mod spike;
pub mod window;
