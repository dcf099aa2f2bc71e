//! Data files: exchange formats, data sets that are larger than memory, and state files.
//!
//! A [`Folder`] writes a data set chunk by chunk. Every chunk in its manifest is complete on the disk, with a checksum;
//! an interrupted run resumes after the last chunk. [`save_state`] writes a state to one file, and [`load_state`] restores it only if
//! its checksum matches.
//!
//! This crate knows no physics.

mod array_file;
mod bounded_read;
mod checksum;
mod direct_write;
mod durable_file;
mod error;
mod folder;
mod lock;
mod manifest;
mod npy;
mod parquet;
mod regular_file;
mod replay_file;
mod state_file;
mod table;
mod thread_work;
mod transfer;
mod verification;

pub use array_file::{ArrayValues, NamedArray, parse_npy, parse_npy_records, read_mat, read_npz};
pub use bounded_read::{read_bounded, read_regular, read_text_bounded, read_text_regular};
pub use checksum::checksum;
pub use durable_file::{write_direct, write_file};
pub use error::{DataError, TableError};
pub use folder::{Folder, NewFile, ensure_same_settings, write_files};
pub use lock::LockedFile;
pub use manifest::{Chunk, Manifest, Stored};
pub use npy::{npy_array, write_npy};
pub use parquet::{parquet_bytes, write_parquet};
pub use regular_file::{create_file, open_regular};
pub use replay_file::ReplayFile;
pub use state_file::{Durability, load_state, save_state};
pub use table::{Column, Table, Values};
pub use thread_work::run_on_threads;
pub use transfer::{Transfer, transfer_files};
pub use verification::{Comparison, Flaw, find_unlisted, verify};
