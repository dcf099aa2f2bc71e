//! Where the bytes of a log are.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::PathBuf;

use bytes::Bytes;
use libration_data::read_bounded;

/// A file, or bytes in memory.
#[derive(Clone, Debug)]
pub(crate) enum Input {
    File(PathBuf),
    Memory(Bytes),
}

impl Input {
    /// Reads from the beginning.
    pub(crate) fn reader(&self) -> io::Result<Box<dyn BufRead>> {
        Ok(match self {
            Input::File(path) => Box::new(BufReader::with_capacity(1 << 16, File::open(path)?)),
            Input::Memory(bytes) => Box::new(Cursor::new(bytes.clone())),
        })
    }

    /// The first bytes, at most `count`.
    pub(crate) fn prefix(&self, count: u64) -> io::Result<Vec<u8>> {
        let mut prefix = Vec::new();
        self.reader()?.take(count).read_to_end(&mut prefix)?;
        Ok(prefix)
    }

    /// All bytes, at most `limit`.
    pub(crate) fn bytes(&self, limit: u64) -> io::Result<Bytes> {
        match self {
            Input::File(path) => read_bounded(path, limit).map(Bytes::from),
            Input::Memory(bytes) => Ok(bytes.clone()),
        }
    }
}
