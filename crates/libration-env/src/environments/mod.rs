//! Environments chosen when the program runs: a [`Recipe`] of names and numbers, and the [`Batch`] that is made of it.
//!
//! What they do is compiled here once, for data sets and for whoever knows no types.

mod actor;
mod batch;
mod plant;
mod recipe;
mod task;
mod world;

pub use actor::{Acting, Actor};
pub use batch::Batch;
pub use plant::Lone;
pub use recipe::{Noise, Recipe};
pub use task::Task;
pub use world::{Compiled, Visit};
