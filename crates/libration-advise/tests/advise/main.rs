//! Tests of advice for loops and simulations.

#![allow(clippy::unwrap_used)]

mod budgets;
mod cascade_reference;
mod case;
mod deadline_misses;
mod edges;
mod linear_reference;
mod linearised_plant;
mod measured_clock;
mod page;
mod page_verdicts;
mod redesign_reference;
mod requests;
mod steps;
