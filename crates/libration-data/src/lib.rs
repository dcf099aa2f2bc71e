//! Numbers in files: formats that others read, data sets that are larger than memory, and states from which to go on.
//!
//! A [`Folder`] takes one chunk of a data set after the other. Whatever is in its manifest is on the disk, whole, with a checksum;
//! whoever is stopped goes on after the last chunk. A state is [kept](keep) in one file, and [taken up](take_up) only if all of it is
//! as it was.
//!
//! Nothing here knows of physics.

mod bounded;
mod checksum;
mod direct;
mod durable;
mod error;
mod folder;
mod lock;
mod manifest;
mod mapped;
mod npy;
mod parquet;
mod state;
mod table;
mod threads;
mod verify;

pub use bounded::{read_bounded, read_text_bounded};
pub use checksum::checksum;
pub use durable::{write_file, write_past};
pub use error::{DataError, TableError};
pub use folder::{FileOf, Folder, same, store};
pub use lock::open_locked;
pub use manifest::{Chunk, Manifest, Stored};
pub use mapped::ReplayFile;
pub use npy::{npy_array, write_npy};
pub use parquet::{parquet_bytes, write_parquet};
pub use state::{keep, take_up};
pub use table::{Column, Table, Values};
pub use threads::on_threads;
pub use verify::{Flaw, unlisted, verify};
