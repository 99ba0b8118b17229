//! The `mve` command from outside: what it prints, writes and ends with. One program, since each
//! would be linked by itself.

mod common;
mod kill;
mod program;
mod report;
mod run;
mod tools;
