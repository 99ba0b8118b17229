//! The runtime from outside: maps, plans, runs and programs over small modules.

mod commands;
mod kinds;
mod maps;
mod memory;
mod modes;
mod nested_files;
mod plan;
mod program;
mod run;
mod stored;
mod swap;
