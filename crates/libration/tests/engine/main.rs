//! Numbers, steps, systems, ensembles and what theory says of them, in one program: each by itself would be compiled against all
//! of the engine again.

#![allow(clippy::unwrap_used)]

mod analysis;
mod catalog;
mod dimensions;
mod elementary;
mod ensemble;
mod exact;
mod golden;
mod half;
mod numpy_parity;
mod observers;
mod simulation;
mod timing;
mod timing_extremes;
