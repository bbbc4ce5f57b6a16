//! Records behaviour that the reference manual and the specifications forbid.

/// Largest number of different breaches kept.
const MOST: usize = 50;

/// Collects breaches; a run with a breach has failed.
#[derive(Debug, Default)]
pub struct Rules {
    breaches: Vec<(String, u64, u32)>,
}

impl Rules {
    /// Records a breach; a repetition is only counted.
    pub fn breach(&mut self, now_ns: u64, what: impl Into<String>) {
        let what = what.into();
        if let Some((.., count)) = self.breaches.iter_mut().find(|(known, ..)| *known == what) {
            *count += 1;
        } else if self.breaches.len() < MOST {
            self.breaches.push((what, now_ns, 1));
        }
    }

    /// Each breach as text: description, first time, number.
    #[must_use]
    pub fn said(&self) -> Vec<String> {
        let say = |(what, first_ns, count): &(String, u64, u32)| {
            format!("{what} (first at {:.6} s, {count} times)", *first_ns as f64 * 1e-9)
        };
        self.breaches.iter().map(say).collect()
    }
}

/// Context of an access or event: time, clocks, and the record of breaches.
#[derive(Debug)]
pub struct At<'a> {
    /// Emulated time, ns.
    pub now_ns: u64,
    /// The current clocks.
    pub clocks: Clocks,
    /// The record of breaches.
    pub rules: &'a mut Rules,
}

impl At<'_> {
    /// Records a breach at the current time.
    pub fn breach(&mut self, what: impl Into<String>) {
        self.rules.breach(self.now_ns, what);
    }
}

/// Clock frequencies of the peripherals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clocks {
    /// Frequency of the buses and their peripherals, Hz.
    pub pclk_hz: f64,
    /// The 16 MHz oscillator, Hz, if it runs.
    pub hsi_hz: Option<f64>,
    /// The crystal, Hz, if it runs.
    pub lse_hz: Option<f64>,
    /// Clock of LPTIM1, Hz, if it runs.
    pub lptim_hz: Option<f64>,
    /// Clock of the calendar, Hz, if it runs.
    pub rtc_hz: Option<f64>,
}

impl Clocks {
    /// Duration of a number of peripheral clock periods, ns, rounded up.
    #[must_use]
    pub fn pclk_ns(&self, periods: u32) -> u64 {
        (f64::from(periods) * 1e9 / self.pclk_hz).ceil() as u64
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Clocks of the board in normal use.
    pub(crate) const RUNNING: Clocks = Clocks {
        pclk_hz: 16e6,
        hsi_hz: None,
        lse_hz: Some(32_768.0),
        lptim_hz: Some(32_768.0),
        rtc_hz: Some(32_768.0),
    };

    /// Runs an operation at a time and returns the breaches that it caused.
    pub(crate) fn breaches(now_ns: u64, deed: impl FnOnce(&mut At<'_>)) -> Vec<String> {
        let mut rules = Rules::default();
        deed(&mut At { now_ns, clocks: RUNNING, rules: &mut rules });
        rules.breaches.into_iter().map(|(what, ..)| what).collect()
    }

    #[test]
    fn the_same_breach_is_counted() {
        let mut rules = Rules::default();
        rules.breach(1_500_000, "a");
        rules.breach(2, "b");
        rules.breach(3, "a");
        assert_eq!(
            rules.said(),
            ["a (first at 0.001500 s, 2 times)", "b (first at 0.000000 s, 1 times)"]
        );
    }
}
