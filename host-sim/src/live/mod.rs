//! The field display: shows a board's output as it arrives.
//!
//! ```text
//!  port ─► lines ─► state ─► screen (a terminal), or one plain or JSON line per event
//!   ▲                         │
//!   └────── commands ◄── keys ┘
//! ```
//!
//! Nothing is computed here: every number on the display is in one of the board's lines, whose form
//! is [`floe_firmware::line`].

mod ask;
mod band;
mod digits;
mod flow;
mod lines;
mod phase_plane;
mod place;
mod plain;
mod port;
mod save;
mod screen;
#[cfg(test)]
mod screens;
mod shown;
mod state;
mod terminal;
#[cfg(test)]
mod tests;
mod trace;
mod verdict;

pub use place::Place;
pub use plain::Form;
pub use port::Port;
pub use save::Save;
pub use shown::shown;

pub use plain::run as print_events;
pub use terminal::run as display;
