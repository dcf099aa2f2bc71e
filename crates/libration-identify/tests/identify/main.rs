//! Tests of identification, on loops that are simulated here by other means.

mod budgets;
mod coverage;
mod errors;
mod imperfections;
mod intervals_on_pages;
mod loops;
mod plants_with_levels;
mod robustness;
mod step_tests;
mod unstable;
