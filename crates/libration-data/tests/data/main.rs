//! Data files.

#![allow(clippy::unwrap_used)]

mod folder;
mod formats;
#[cfg(unix)]
mod kills;
mod replay_file;
mod spring;
mod state_file;
