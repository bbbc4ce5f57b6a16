//! A recorded log through the core: `floe replay`.

pub mod result;
