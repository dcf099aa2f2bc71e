//! What the laboratory promises, in one program: every test binary links the laboratory and all that
//! it stands on, and none can look at a run that another has made. Only the browser has one of its
//! own, where no study takes the cores from it.

#![allow(clippy::unwrap_used)]

mod advise;
mod advise_budgets;
mod advise_case;
mod advise_edges;
mod advise_page;
mod advise_steps;
mod analyze;
mod clocks;
mod config;
mod config_fuzz;
mod dataset;
mod default_run;
mod export;
mod interrupted;
mod latency;
mod loop_growth;
mod numbers;
mod other_reports;
mod overflow;
mod own_system;
mod precision;
mod reference;
mod report;
mod rollout;
mod settings;
mod stability_windows;
mod studies;
mod throughput;
mod trajectory;
mod verdicts;
