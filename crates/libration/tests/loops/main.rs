//! Simulated loops against theory and against a plain loop of one trajectory.

#![allow(clippy::unwrap_used)]

mod any_clock;
mod any_delay;
mod bits;
mod clocks;
mod controllers;
mod cost;
mod delays;
mod growth;
mod invalid_values;
mod moments;
mod noise;
mod single_loop;
