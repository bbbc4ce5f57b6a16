//! The last samples, by index.

/// Length of the window, sampling periods: a power of two, for a sample's slot is the low bits of
/// its index. 1 KiB of state; the longest slip is three quarters of it.
pub const WINDOW: usize = 256;

/// Ring of the newest forces; a period without a good sample reads as `None`.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct Window {
    /// One past the newest index.
    pub(crate) end: u32,
    /// The first index of all.
    first: u32,
    /// NaN where there is no good sample.
    forces_n: [f32; WINDOW],
}

impl Window {
    /// An empty window.
    pub(crate) fn new() -> Self {
        Self { forces_n: [f32::NAN; WINDOW], end: 0, first: 0 }
    }

    /// Takes a sample with an index past all earlier ones; does it follow the one before?
    #[inline(always)]
    pub(crate) fn push(&mut self, index: u32, force_n: f32) -> bool {
        let in_a_row = index == self.end;
        if !in_a_row {
            self.skip_to(index);
        }
        self.set(index, force_n);
        self.end = index + 1;
        in_a_row
    }

    /// Marks the periods that were skipped as missing.
    #[cold]
    fn skip_to(&mut self, index: u32) {
        if self.end == 0 {
            self.first = index;
        }
        for skipped in self.end.max(index.saturating_sub(WINDOW as u32))..index {
            self.set(skipped, f32::NAN);
        }
    }

    /// Force at an index, if it is in the window and was good.
    pub(crate) fn get(&self, index: u32) -> Option<f32> {
        let inside = self.end.wrapping_sub(index).wrapping_sub(1) < WINDOW as u32;
        let force_n = self.forces_n.get(slot(index)).copied();
        force_n.filter(|force_n| inside && !force_n.is_nan())
    }

    /// Forces from an index up to another one, in two parts where the ring begins anew; NaN is
    /// missing. Both indices have to lie within the window: beyond it the slots hold other samples.
    pub(crate) fn between(&self, from: u32, to: u32) -> [&[f32]; 2] {
        let (from_slot, to_slot) = (slot(from), slot(to));
        let part = |range| self.forces_n.get(range).unwrap_or_default();
        if from_slot <= to_slot {
            [part(from_slot..to_slot), &[]]
        } else {
            [part(from_slot..WINDOW), part(0..to_slot)]
        }
    }

    /// The index, or the oldest one in the window if that is later.
    #[inline(never)]
    pub(crate) fn first_from(&self, index: u32) -> u32 {
        index.max(self.first).max(self.end.saturating_sub(WINDOW as u32))
    }

    fn set(&mut self, index: u32, force_n: f32) {
        if let Some(entry) = self.forces_n.get_mut(slot(index)) {
            *entry = force_n;
        }
    }
}

fn slot(index: u32) -> usize {
    (index % WINDOW as u32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_the_samples_in_it_also_where_the_ring_begins_anew() {
        let mut window = Window::new();
        for index in (0..400).filter(|index| index % 7 != 3) {
            window.push(index, index as f32);
        }
        for (from, to) in [(150, 160), (200, 300), (255, 256), (256, 260), (208, 400), (390, 390)] {
            let mut one_by_one = (from..to).map(|index| window.get(index));
            for force_n in window.between(from, to).into_iter().flatten() {
                let good = Some(*force_n).filter(|it| !it.is_nan());
                assert_eq!(one_by_one.next(), Some(good), "{from} {to}");
            }
            assert_eq!(one_by_one.next(), None, "{from} {to}");
        }
    }

    #[test]
    fn keeps_the_newest_and_knows_what_is_missing() {
        let mut window = Window::new();
        assert_eq!(window.get(0), None);
        window.push(5, 1.0);
        window.push(8, 2.0);
        let seen: [Option<f32>; 5] = core::array::from_fn(|i| window.get(5 + i as u32));
        assert_eq!(seen, [Some(1.0), None, None, Some(2.0), None]);
        window.push(8 + WINDOW as u32, 3.0);
        assert_eq!(window.get(8), None, "out of the window");
        assert_eq!(window.get(9), None, "missing");
        window.push(u32::MAX - 1, 4.0);
        assert_eq!(window.get(u32::MAX - 1), Some(4.0));
        assert_eq!(window.get(8 + WINDOW as u32), None);
    }
}
