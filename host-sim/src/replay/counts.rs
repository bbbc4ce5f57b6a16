//! How many events of a log have coefficients, and why the others have none.

use floe_core::Reason;

use super::result::EventSummary;

/// Numbers of events.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    /// Why events have no coefficient, and how many.
    refused: Vec<(String, u64)>,
    /// Events with a coefficient, and those of them with an omega of their own.
    read: [u64; 2],
}

impl Counts {
    /// Counts an event.
    pub(super) fn add(&mut self, event: &EventSummary) {
        if event.mu_s.or(event.mu).is_some() {
            self.read[0] += 1;
            self.read[1] += u64::from(event.omega_rad_per_s.is_some());
            return;
        }
        let Some(reason) = &event.reason else { return };
        match self.refused.iter_mut().find(|(known, _)| known == reason) {
            Some((_, count)) => *count += 1,
            None => self.refused.push((reason.clone(), 1)),
        }
    }

    /// Why events have no coefficient, the most frequent reason first: `3 not counted: a gap`.
    pub fn refused(&self) -> impl Iterator<Item = String> {
        let mut refused: Vec<_> = self.refused.iter().collect();
        refused.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        refused.into_iter().map(|(reason, count)| format!("{count} not counted: {reason}"))
    }

    /// Whether half of the events with a coefficient have an omega: fewer are those with long fits.
    #[must_use]
    pub fn determine_omega(&self) -> bool {
        let [read, with_omega] = self.read;
        2 * with_omega >= read
    }

    /// How many events have no coefficient for this reason.
    #[must_use]
    pub fn refused_for(&self, reason: Reason) -> u64 {
        let reason = reason.to_string();
        self.refused.iter().find(|(known, _)| *known == reason).map_or(0, |it| it.1)
    }
}
