//! The program as a user meets it. One binary: each would link all that the program stands on.

#![allow(clippy::unwrap_used)]

mod advise;
mod analyze;
mod bench;
mod clocks;
#[cfg(unix)]
mod interrupt;
#[cfg(unix)]
mod kills;
mod lab;
mod readers;
mod rollout;
mod simulate;
mod timing;
mod verify;
