//! Motion, stability and loops of one system for a page that changes while one drags: the engine in a browser.
//!
//! Each function takes a [`Setting`] and returns an [`Answer`] within a frame; states have the bits that the engine has elsewhere.
//! `cargo xtask live` compiles the crate to WebAssembly for the pages of `libration-report`.
//!
//! This crate does no input or output, reads no clock and prints nothing.

#[cfg(target_arch = "wasm32")]
mod abi;
mod answer;
mod control_loop;
mod growth;
mod linear_system;
mod loop_growth;
mod loop_view;
mod motion;
mod request;
mod setting;
mod stability_map;
mod subject;

pub use answer::Answer;
pub use request::answer;
pub use setting::{Control, Setting, SettingError};
pub use stability_map::{MapAxis, map_row};
pub use subject::MOST_DEGREES;
