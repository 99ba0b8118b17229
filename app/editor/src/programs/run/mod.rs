//! Checking and running a program: the head of the panel, and what its threads do.

pub mod bar;
pub mod check;
pub mod job;
pub mod pace;
