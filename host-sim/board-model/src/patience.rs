//! Detection of a program that polls.

/// Address and value of the program's last read.
#[derive(Debug, Default)]
pub struct Patience(Option<(u32, u32)>);

impl Patience {
    /// Records a read; returns whether the previous read had the same address and value. The caller
    /// leaves out reads of the clock.
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
