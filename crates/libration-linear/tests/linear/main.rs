//! Tests of linear loops against whole period matrices, closed forms and published numbers.

#![allow(clippy::unwrap_used)]

mod joint_latency_windows;
mod known_numbers;
mod latency_windows;
mod redesign;
mod sampled_redesign;
