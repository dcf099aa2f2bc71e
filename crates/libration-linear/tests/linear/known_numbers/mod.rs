//! Numbers that others published or computed.

#![allow(clippy::unwrap_used)]

mod fractional_hold;
mod jitterbug;
mod state_space;
