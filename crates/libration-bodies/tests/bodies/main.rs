//! Tests of bodies that attract each other.

#![allow(clippy::unwrap_used)]

mod common;
mod encounters;
mod motions;
mod orbits;
mod pair_potentials;
mod steps;
mod wisdom_holman;
