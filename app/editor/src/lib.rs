//! The window of mve: build a map by hand, watch it run, look at the result, run its program.

pub mod programs;
