//! Sectors of a card that were changed on purpose.

use floe_firmware::record::Sector;

/// Gives a sector the checksum of what it holds.
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
