//! The card slot, with a card or empty, and the level of its data line.

use crate::rules::At;
use crate::sd_card::SdCard;
use crate::spi::Slave;

/// The card slot.
#[derive(Debug)]
pub struct Slot {
    /// The card, inserted or not.
    pub card: Option<SdCard>,
    /// Whether the card is inserted.
    pub present: bool,
    /// Chip select is low.
    pub selected: bool,
    /// The data line has a pull-up.
    pub pulled_up: bool,
    /// State of the noise on an open line.
    noise: u32,
}

impl Slot {
    /// The slot at the board's start.
    #[must_use]
    pub fn new(card: Option<SdCard>, present: bool) -> Self {
        Self { card, present, selected: false, pulled_up: false, noise: 1 }
    }

    /// Takes the card out.
    pub fn pull(&mut self, now_ns: u64) {
        self.present = false;
        if let Some(card) = &mut self.card {
            card.pull(now_ns);
        }
    }

    /// Sets the level of chip select.
    pub fn select(&mut self, selected: bool, at: &mut At<'_>) {
        let released = self.selected && !selected;
        self.selected = selected;
        if let (true, true, Some(card)) = (released, self.present, &mut self.card) {
            card.released(at);
        }
    }

    /// Handles a restart of the processor, after which its pins float.
    pub fn reset(&mut self) {
        (self.selected, self.pulled_up) = (false, false);
        if let Some(card) = &mut self.card {
            card.abort();
        }
    }

    fn open_line(&mut self) -> u8 {
        if self.pulled_up {
            return 0xFF;
        }
        self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.noise >> 24) as u8
    }
}

impl Slave for Slot {
    fn exchange(&mut self, byte: u8, clock_hz: f64, at: &mut At<'_>) -> u8 {
        match (&mut self.card, self.present) {
            (Some(card), true) => card.exchange(byte, self.selected, clock_hz, at),
            _ => self.open_line(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::tests::breaches;

    #[test]
    fn an_empty_slot_floats_without_a_pull_up() {
        let mut slot = Slot::new(None, true);
        let mut heard = Vec::new();
        breaches(0, |at| heard = (0..32).map(|_| slot.exchange(0xFF, 1e5, at)).collect());
        assert!(heard.iter().any(|byte| byte & 0x80 == 0));
        slot.pulled_up = true;
        breaches(0, |at| assert_eq!(slot.exchange(0, 1e5, at), 0xFF));
    }
}
