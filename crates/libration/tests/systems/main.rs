//! The systems against their exact solutions.

#![allow(clippy::unwrap_used)]

mod case;
mod convergence;
mod energy;
