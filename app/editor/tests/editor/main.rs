//! The window from outside: documents, the panel of programs, and a hand at the whole window. One
//! program, since each would link all that draws.

#[cfg(unix)]
mod commands;
mod document;
#[allow(dead_code)] // The example that draws the pictures of README uses the rest.
mod hand;
mod looking;
mod maps;
mod monkey;
mod nodes;
mod programs;
mod sheet;
mod snapshots;
mod truth;
mod window;
