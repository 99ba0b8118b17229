//! The `mve` command.

fn main() {}
