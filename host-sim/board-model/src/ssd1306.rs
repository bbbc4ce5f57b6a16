//! Display memory of the SSD1306, as in its data sheet (rev 1.1), and the visible picture.

/// Width of the display, pixels.
pub const WIDTH: usize = 128;
const PAGES: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// A control byte, which defines the meaning of the following bytes.
    Control,
    Command,
    Data,
}

/// The display.
#[derive(Debug)]
pub struct Ssd1306 {
    memory: [[u8; WIDTH]; PAGES],
    next: Next,
    /// A command and its arguments so far.
    command: Vec<u8>,
    /// Addressing mode: 0 horizontal, 2 by page.
    mode: u8,
    columns: (usize, usize),
    pages: (usize, usize),
    column: usize,
    page: usize,
    on: bool,
    charge_pump: bool,
    /// Number of whole pictures received.
    pub pictures: u32,
}

impl Default for Ssd1306 {
    fn default() -> Self {
        Self {
            memory: [[0; WIDTH]; PAGES],
            next: Next::Control,
            command: Vec::new(),
            mode: 2,
            columns: (0, WIDTH - 1),
            pages: (0, PAGES - 1),
            column: 0,
            page: 0,
            on: false,
            charge_pump: false,
            pictures: 0,
        }
    }
}

impl Ssd1306 {
    /// Handles a start condition, after which a control byte follows.
    pub fn start(&mut self) {
        self.next = Next::Control;
    }

    /// Receives a byte of a transfer.
    pub fn write(&mut self, byte: u8) {
        match self.next {
            // Co = 1 (a control byte for one byte only) is not modelled.
            Next::Control => {
                self.next = if byte & 0x40 != 0 { Next::Data } else { Next::Command };
            }
            Next::Command => self.take_command(byte),
            Next::Data => self.put(byte),
        }
    }

    fn put(&mut self, byte: u8) {
        if let Some(cell) = self.memory.get_mut(self.page).and_then(|p| p.get_mut(self.column)) {
            *cell = byte;
        }
        self.column += 1;
        if self.column > self.columns.1 {
            self.column = self.columns.0;
            if self.mode == 0 {
                self.page += 1;
            }
        }
        if self.page > self.pages.1 {
            self.page = self.pages.0;
            self.pictures += 1;
        }
    }

    fn take_command(&mut self, byte: u8) {
        self.command.push(byte);
        let arguments = match self.command[0] {
            0x21 | 0x22 => 2,
            0x20 | 0x81 | 0x8D | 0xA8 | 0xD3 | 0xD5 | 0xD9 | 0xDA | 0xDB => 1,
            _ => 0,
        };
        if self.command.len() <= arguments {
            return;
        }
        let at = |place: usize| usize::from(self.command.get(place).copied().unwrap_or(0));
        match self.command[0] {
            0x00..=0x0F => self.column = self.column & 0xF0 | at(0) & 0xF,
            0x10..=0x1F => self.column = self.column & 0xF | (at(0) & 0xF) << 4,
            0x20 => self.mode = at(1) as u8 & 0b11,
            0x21 => {
                self.columns = (at(1) & 0x7F, at(2) & 0x7F);
                self.column = self.columns.0;
            }
            0x22 => {
                self.pages = (at(1) & 7, at(2) & 7);
                self.page = self.pages.0;
            }
            0x8D => self.charge_pump = at(1) & 1 << 2 != 0,
            0xAE => self.on = false,
            0xAF => self.on = true,
            0xB0..=0xB7 => self.page = at(0) & 7,
            _ => {}
        }
        self.command.clear();
    }

    /// The visible picture, one line per row of pixels, `#` lit; empty while the display is off.
    #[must_use]
    pub fn picture(&self) -> Vec<String> {
        let lit = |x: usize, y: usize| {
            self.on && self.charge_pump && self.memory[y / 8][x] >> (y % 8) & 1 != 0
        };
        let row = |y| (0..WIDTH).map(|x| if lit(x, y) { '#' } else { '.' }).collect();
        (0..8 * PAGES).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(display: &mut Ssd1306, bytes: &[u8]) {
        display.start();
        bytes.iter().for_each(|&byte| display.write(byte));
    }

    #[test]
    fn a_window_is_filled_row_by_row() {
        let mut display = Ssd1306::default();
        send(&mut display, &[0, 0xAF, 0x8D, 0x14, 0x20, 0, 0x21, 126, 127, 0x22, 6, 7]);
        send(&mut display, &[0x40, 1, 0x80, 0xFF, 0]);
        let picture = display.picture();
        let lit = |x: usize, y: usize| picture[y].as_bytes()[x] == b'#';
        assert!(lit(126, 48) && lit(127, 55) && lit(126, 56) && lit(126, 63));
        let points: usize = picture.iter().map(|row| row.matches('#').count()).sum();
        assert_eq!((points, display.pictures), (10, 1));
    }

    #[test]
    fn it_is_dark_without_its_pump() {
        let mut display = Ssd1306::default();
        send(&mut display, &[0, 0xAF]);
        send(&mut display, &[0x40, 0xFF]);
        assert!(display.picture().iter().all(|row| !row.contains('#')));
    }
}
