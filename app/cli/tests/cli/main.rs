//! The `mve` command from outside: what it prints, writes and ends with. One program, since each
//! would be linked by itself.

#[cfg(unix)]
mod commands;
mod common;
mod kill;
mod program;
mod rate;
mod report;
mod run;
mod tools;
