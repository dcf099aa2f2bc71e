//! Audits of traces by programs that share no code with this crate.

mod bad_input;
mod coverage;
mod faults;
mod molecular_dynamics;
mod programs;
mod theory;
mod verdicts;
