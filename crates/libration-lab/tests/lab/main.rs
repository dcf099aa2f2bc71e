//! What the laboratory promises, in one program: every test binary links the laboratory and all that
//! it stands on, and none can look at a run that another has made. Only the browser has one of its
//! own, where no study takes the cores from it.

#![allow(clippy::unwrap_used)]

mod chapters;
mod clocks;
mod config;
mod config_fuzz;
mod default_run;
mod interrupted;
mod latency;
mod numbers;
mod other_reports;
mod own_system;
mod precision;
mod repeatability;
mod report;
mod rollout;
mod series;
mod settings;
mod shared_tables;
mod studies;
mod throughput;
mod verdicts;
