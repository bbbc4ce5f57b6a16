//! Whether the program only waits.

/// What the program asked last, if it has done nothing else since.
#[derive(Debug, Default)]
pub struct Patience(Option<(u32, u32)>);

impl Patience {
    /// Notes that this was read there; whether the same was the answer just before.
    /// Looks at the clock in between are not to be told.
    pub fn asks_again(&mut self, address: u32, answer: u32) -> bool {
        self.0.replace((address, answer)) == Some((address, answer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_asks_twice_and_hears_the_same_waits() {
        let mut patience = Patience::default();
        let asked = [(1, 0), (1, 0), (2, 0), (1, 0), (1, 4), (1, 4), (1, 4)];
        let waits = asked.map(|(address, answer)| patience.asks_again(address, answer));
        assert_eq!(waits, [false, true, false, false, false, true, true]);
    }
}
