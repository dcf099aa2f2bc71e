//! Tests of advice for loops and simulations.

#![allow(clippy::unwrap_used)]

mod budgets;
mod case;
mod edges;
mod linear_reference;
mod page;
mod requests;
mod steps;
