//! Where the bytes of a log are.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use bytes::Bytes;
use libration_data::read_bounded;

/// A file, or bytes in memory.
#[derive(Clone, Debug)]
pub(crate) enum Input {
    File(PathBuf),
    Memory(Bytes),
}

/// Most bytes of a pipe or a device, which are kept in memory.
const LONGEST_PIPE: u64 = 1 << 28;

impl Input {
    /// The file at a path. A pipe or a device can be read only once, so its bytes are kept in memory.
    pub(crate) fn of(path: &Path) -> io::Result<Self> {
        Ok(match fs::metadata(path)?.is_file() {
            true => Input::File(path.to_owned()),
            false => Input::Memory(read_bounded(path, LONGEST_PIPE)?.into()),
        })
    }

    /// The number of bytes.
    pub(crate) fn len(&self) -> io::Result<u64> {
        Ok(match self {
            Input::File(path) => fs::metadata(path)?.len(),
            Input::Memory(bytes) => bytes.len() as u64,
        })
    }

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
