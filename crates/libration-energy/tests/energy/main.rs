//! Audits of traces by programs that share no code with this crate.

mod bad_input;
mod convergence;
mod coverage;
mod faults;
mod honest;
mod local_deviations;
mod molecular_dynamics;
mod programs;
mod slow_changes;
mod theory;
mod verdicts;
