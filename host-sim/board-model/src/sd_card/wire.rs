//! Blocks and checksums in the form sent over the wire.

use super::START_BLOCK;

/// A data block with start token and checksum.
pub(super) fn framed(bytes: &[u8]) -> Vec<u8> {
    let sum = crc16(bytes).to_be_bytes();
    [START_BLOCK].iter().chain(bytes).chain(&sum).copied().collect()
}

pub(super) fn crc7(bytes: &[u8]) -> u8 {
    let bits = bytes.iter().flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1));
    bits.fold(0, |sum, bit| {
        let shifted = (sum << 1) & 0x7F;
        if (sum >> 6) ^ bit != 0 { shifted ^ 0x09 } else { shifted }
    })
}

pub(super) fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum, &byte| {
        (0..8).fold(sum ^ u16::from(byte) << 8, |sum, _| {
            if sum & 0x8000 != 0 { sum << 1 ^ 0x1021 } else { sum << 1 }
        })
    })
}
