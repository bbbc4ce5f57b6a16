//! A register-level model of the TI ADS122C04 (I²C) and ADS122U04 (serial).
//!
//! It follows the data sheets SBAS751B and SBAS752B only, so that it can reveal errors of the
//! firmware's driver. Modelled are commands, registers and their defaults, conversion times,
//! single-shot and continuous conversion, conversion counter, inverted data, temperature sensor,
//! shorted inputs, monitors of reference and supply, and burn-out currents. Not modelled are the
//! CRC-16 option, excitation currents, general-purpose pins and automatic data output.
//!
//! ```text
//!  load cell ──► Device ──► Serial (U04) ──► bytes in time
//!                  ▲    └─► I2c (C04)   ──► embedded-hal transactions
//!               Trouble
//! ```

mod device;
mod i2c;
mod line;
mod load_cell;
mod serial;
mod trouble;

pub use device::{Device, Variant};
pub use i2c::{I2cChip, NoAnswer};
pub use line::{Clock, SerialLine};
pub use load_cell::LoadCell;
pub use serial::SerialChip;
pub use trouble::{Schedule, Trouble};
