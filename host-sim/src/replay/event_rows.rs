//! Every event of a replay as a row of CSV: `--events`.

use std::io::{self, Write};

use super::events::Events;

/// Writes all events below a line of column names.
///
/// # Errors
/// `out` cannot be written, or the events cannot be read.
pub fn write(events: &Events, out: &mut impl Write) -> io::Result<()> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(out);
    writer.write_record(COLUMNS)?;
    events.for_each(|mut event| {
        // An interval that is missing takes two empty cells.
        for interval in [&mut event.mu_s_ci95, &mut event.mu_ci95] {
            interval.get_or_insert([f64::NAN; 2]);
        }
        Ok(writer.serialize(event)?)
    })?;
    writer.flush()
}

/// The fields of an event in their order, so that a file without events has a
/// header too.
const COLUMNS: [&str; 31] = [
    "index",
    "onset_s",
    "stop_s",
    "static_force_n",
    "dynamic_force_n",
    "peak_force_n",
    "restick_force_n",
    "mu_s",
    "mu_s_std",
    "mu",
    "mu_std",
    "stick_s",
    "slip_s",
    "loading_rate_n_per_s",
    "omega_rad_per_s",
    "slack",
    "quality",
    "reason",
    "mu_s_systematic_std",
    "mu_systematic_std",
    "mu_s_combined_std",
    "mu_combined_std",
    "mu_s_ci95_low",
    "mu_s_ci95_high",
    "mu_ci95_low",
    "mu_ci95_high",
    "slip_length_m",
    "energy_j",
    "onset_time",
    "slip_length_m_std",
    "energy_j_std",
];
