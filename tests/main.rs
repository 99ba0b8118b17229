//! The tests that cross the crates of mve. One program, since each would be linked by itself; but
//! for `cancel`, which measures time and runs alone.

mod contracts;
mod cost_promises;
mod experiment;
mod filters;
mod fuzz;
mod maps;
mod metric_of_itself;
mod other_programs;
mod tidy;
