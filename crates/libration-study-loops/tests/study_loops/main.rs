//! Tests of the numbers that studies of loops derive from others.

#![allow(clippy::unwrap_used)]

#[path = "../../src/hierarchy/crossing.rs"]
mod crossing;
#[path = "../../src/latency/mean_growth.rs"]
mod mean_growth;
// The number of standard errors is for verdicts alone.
#[expect(dead_code)]
#[path = "../../src/sample.rs"]
mod sample;
#[path = "../../src/latency/stability_edge.rs"]
mod stability_edge;
