//! Studies that set what theory predicts beside what a simulation measures.

pub mod figure;
