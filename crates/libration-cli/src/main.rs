//! The `libration` command.

fn main() {}
