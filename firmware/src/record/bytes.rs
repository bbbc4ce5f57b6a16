//! Little-endian numbers at consecutive positions in a sector.

use super::Sector;

/// Writes at an advancing position; beyond the end nothing is written.
pub(super) struct Writer<'a> {
    pub bytes: &'a mut Sector,
    pub at: usize,
}

impl Writer<'_> {
    pub fn put<const N: usize>(&mut self, value: [u8; N]) {
        if let Some(place) = self.bytes.get_mut(self.at..self.at + N) {
            place.copy_from_slice(&value);
        }
        self.at += N;
    }

    pub fn put_u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    pub fn put_f32(&mut self, value: f32) {
        self.put(value.to_le_bytes());
    }

    /// Writes `None` as all ones.
    pub fn put_some_u32(&mut self, value: Option<u32>) {
        self.put_u32(value.unwrap_or(u32::MAX));
    }

    /// Writes `None` as all ones, which is a NaN.
    pub fn put_some_f32(&mut self, value: Option<f32>) {
        self.put_some_u32(value.map(f32::to_bits));
    }

    pub fn put_some_u64(&mut self, value: Option<u64>) {
        self.put(value.unwrap_or(u64::MAX).to_le_bytes());
    }

    /// Writes the index of a value in the list of all values.
    pub fn put_choice<T: PartialEq>(&mut self, all: &[(T, &str)], value: Option<T>) {
        let place = all.iter().position(|(one, _)| Some(one) == value.as_ref());
        self.put([place.map_or(u8::MAX, |place| place as u8)]);
    }
}

/// Reads at an advancing position. Beyond the end it reads ones, the encoding of an unknown value.
pub(super) struct Reader<'a> {
    pub bytes: &'a Sector,
    pub at: usize,
    pub end: usize,
}

impl Reader<'_> {
    pub fn take<const N: usize>(&mut self) -> [u8; N] {
        let there = self.at + N <= self.end;
        let bytes = self.bytes.get(self.at..self.at + N).filter(|_| there);
        self.at += N;
        bytes.and_then(|b| b.try_into().ok()).unwrap_or([u8::MAX; N])
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    pub fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub fn some_u32(&mut self) -> Option<u32> {
        Some(self.u32()).filter(|&value| value != u32::MAX)
    }

    /// Reads into a place, which avoids many copies.
    #[inline(never)]
    pub fn some_f32(&mut self, place: &mut Option<f32>) {
        *place = Some(self.f32()).filter(|value| !value.is_nan());
    }

    pub fn some_u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take())).filter(|&value| value != u64::MAX)
    }

    pub fn choice<T: Copy>(&mut self, all: &[(T, &str)]) -> Option<T> {
        let [place] = self.take();
        all.get(usize::from(place)).map(|&(one, _)| one)
    }
}
