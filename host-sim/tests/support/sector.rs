//! Sectors of a card with deliberate changes.

use floe_firmware::record::Sector;

/// Sets the checksum of a sector to match its content.
pub fn seal(sector: &mut Sector) {
    let mut sum = u32::MAX;
    for &byte in &sector[..508] {
        sum ^= u32::from(byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg());
        }
    }
    sector[508..].copy_from_slice(&(!sum).to_le_bytes());
}
