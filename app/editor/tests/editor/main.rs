//! The window from outside: documents, the panel of programs, and a hand at the whole window. One
//! program, since each would link all that draws.

mod document;
mod hand;
mod monkey;
mod programs;
mod snapshots;
mod window;
