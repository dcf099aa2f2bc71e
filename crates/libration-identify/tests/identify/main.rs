//! Tests of identification, on loops that are simulated here by other means.

mod coverage;
mod errors;
mod imperfections;
mod loops;
mod robustness;
mod unstable;
