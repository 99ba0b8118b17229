//! The `mve-editor` command.

fn main() {}
