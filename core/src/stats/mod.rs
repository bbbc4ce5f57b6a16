//! Statistical tools that several modules use.

pub(crate) mod fading_trend;
pub(crate) mod in_a_row;
pub(crate) mod lattice;
pub(crate) mod line;
pub(crate) mod normal_equations;
pub(crate) mod prior;
pub(crate) mod quantile;
pub(crate) mod quantity;
pub(crate) mod running_mean;
pub(crate) mod significance;
pub(crate) mod student;
