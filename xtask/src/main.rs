//! Everything that continuous integration does.

fn main() {}
