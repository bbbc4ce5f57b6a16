//! Every job around the project.
fn main() {}
