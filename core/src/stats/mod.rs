//! Small statistics that several rooms use.

pub mod fading_trend;
pub mod lattice;
pub mod line;
pub mod normal_equations;
pub mod prior;
pub mod quantile;
pub mod quantity;
pub mod student;
