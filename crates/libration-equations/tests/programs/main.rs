//! Tests of systems from text, and of their programs.

mod catalogue;
mod expressions;
mod implicit_steps;
mod tasks;
