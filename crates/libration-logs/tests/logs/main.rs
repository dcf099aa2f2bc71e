//! Logs that other programs wrote; `tools/make_log_files.py` and `tools/make_db3_files.py` run them.

#![allow(clippy::unwrap_used)]

mod bags;
mod mutations;
mod other_bags;
mod sqlite_bags;
mod tables;
mod unpacked;

use std::path::PathBuf;

use libration_logs::{ClockChoice, Log, ReadOptions};

fn path(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data")).join(name)
}

fn open(name: &str, clock: ClockChoice) -> Log {
    Log::open(&path(name), &ReadOptions { clock, ..ReadOptions::default() }).expect(name)
}
