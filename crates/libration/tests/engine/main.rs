//! Numbers, steps, systems, ensembles and their theory in one program: separate programs would each be linked against all
//! of the engine.

#![allow(clippy::unwrap_used)]

mod analysis;
mod block_machine;
mod catalog;
mod compiled_twins;
mod dimensions;
mod elementary;
mod elementary_functions;
mod ensemble;
mod exact;
mod expressions;
mod golden;
mod half;
mod numpy_parity;
mod observers;
mod random_expressions;
mod simulation;
mod step_function;
mod timing;
mod timing_extremes;
