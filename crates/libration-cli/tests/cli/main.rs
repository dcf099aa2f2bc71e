//! The program as a user meets it. One binary: each would link all that the program stands on.

#![allow(clippy::unwrap_used)]

mod actions;
mod adaptive;
mod advise;
mod analyze;
mod analyze_verdicts;
mod audit;
mod bench;
mod bodies;
mod bodies_hidden_change;
mod bodies_verdicts;
mod clocks;
mod closed_loop;
mod compare;
mod compare_evidence;
mod comparison;
mod deadline_misses;
mod doors;
mod durations;
mod equations;
mod exit_codes;
#[cfg(unix)]
mod first_hour;
mod forces;
#[cfg(unix)]
mod foreign_dataset;
#[cfg(unix)]
mod foreign_folder;
mod identify;
mod implicit;
#[cfg(unix)]
mod interrupt;
#[cfg(unix)]
mod join;
mod kills;
mod lab;
mod limits_of_stability;
mod linear;
mod linear_analysis;
mod linear_errors;
mod linear_filters;
mod linear_redesign;
mod linear_simulation;
mod linear_weights;
#[cfg(unix)]
mod log_warnings;
mod logs;
mod long_files;
mod loop_ranges;
mod loop_remedies;
mod loop_verdicts;
mod loops_from_starts;
mod manifest_contents;
#[cfg(target_os = "linux")]
mod memory;
mod operating_points;
mod plant_files;
mod presets;
mod probe;
#[cfg(unix)]
mod probe_programs;
mod readers;
#[cfg(unix)]
mod replaced_file;
mod report_check;
#[cfg(unix)]
mod report_folder;
mod rollout;
mod serve;
mod shared_config;
#[cfg(unix)]
mod short_answers;
mod simulate;
mod snapshots;
mod stability;
mod starts;
mod steps;
mod system_advice;
mod system_lab;
mod system_loops;
mod temperature;
#[cfg(unix)]
mod terminal_text;
mod timing;
mod unseen_parts;
mod verify;
