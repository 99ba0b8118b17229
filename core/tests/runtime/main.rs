//! The runtime from outside: maps, plans, runs and programs over small modules.

mod modes;
mod plan;
mod program;
mod run;
mod swap;
