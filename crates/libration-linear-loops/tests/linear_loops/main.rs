//! Tests of loops around linear plants.

#![allow(clippy::unwrap_used)]

// The plan alone asks for sizes.
#[expect(dead_code)]
#[path = "../../src/length_polynomials.rs"]
mod length_polynomials;
mod random_loops;
#[path = "../../src/row.rs"]
mod row;
