//! Text of the display for a board's output, without a terminal.

use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};

use super::ask::Ask;
use super::lines::Lines;
use super::screen;
use super::state::State;

/// The rows of a display of `size` (columns, rows) that has received `console`.
#[must_use]
pub fn shown(console: &str, size: (u16, u16)) -> Vec<String> {
    let mut state = State::default();
    state.up(Duration::ZERO);
    // A console does not contain times. One line per second lets temporary states expire.
    let mut now = Duration::ZERO;
    for received in Lines::default().take(console.as_bytes()) {
        now += Duration::from_secs(1);
        state.take(&received, now);
    }
    let (columns, lines) = size;
    // This backend cannot fail.
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, lines));
    let ask = Ask::default();
    let Ok(_) = terminal.draw(|frame| screen::draw(frame, &state, &ask, "PORT", now));
    rows(terminal.backend().buffer())
}

/// The letters of a screen, row by row.
pub(super) fn rows(buffer: &Buffer) -> Vec<String> {
    let width = usize::from(buffer.area.width).max(1);
    let row =
        |cells: &[Cell]| cells.iter().map(Cell::symbol).collect::<String>().trim_end().to_string();
    buffer.content.chunks(width).map(row).collect()
}
