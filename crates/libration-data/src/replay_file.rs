//! Replay buffers in files.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use bytemuck::Pod;
use libration::Float;
use libration::replay::{Capacity, ReplayBuffer, ReplayError};
use memmap2::MmapMut;

use crate::DataError;
use crate::durable_file::make;
use crate::lock::LockedFile;
use crate::regular_file::create_with;

/// A replay buffer in a memory-mapped file, locked for this process. If the process dies, completed insertions are kept. After a
/// loss of power, only a buffer that was [flushed](Self::flush) after its last change is intact, because the system writes pages
/// in any order.
#[derive(Debug)]
pub struct ReplayFile<T> {
    replay: ReplayBuffer<T>,
    path: PathBuf,
    /// Locked as long as it is open.
    _file: LockedFile,
}

impl<T: Float + Pod> ReplayFile<T> {
    /// Creates an empty buffer in a new file, of transitions with these numbers of observations and actions, and allocates all its
    /// disk space: a full disk would end the process later.
    ///
    /// # Errors
    /// [`DataError::Io`] if the file exists or the disk is full; [`DataError::Replay`].
    pub fn create(path: &Path, sizes: [usize; 2], capacity: Capacity) -> Result<Self, DataError> {
        let [observations, actions] = sizes;
        let bytes = capacity.bytes(observations, actions, size_of::<T>()).map_err(refused(path))?;
        if path.exists() {
            let error = io::Error::from(io::ErrorKind::AlreadyExists);
            return Err(DataError::io("create", path)(error));
        }
        let (file, replay) = make(path, |part| {
            let file = create_with(part, OpenOptions::new().read(true).write(true))?;
            let file = LockedFile::try_lock(file)?;
            fill(&file, bytes)?;
            let map = map(&file)?;
            let replay = ReplayBuffer::create(map, sizes, capacity).map_err(io::Error::other)?;
            replay.map().flush()?;
            Ok((file, replay))
        })?;
        Ok(ReplayFile { replay, path: path.to_owned(), _file: file })
    }

    /// Opens a file that an earlier process wrote with the same numbers of observations and actions.
    ///
    /// # Errors
    /// [`DataError::Io`], [`DataError::Locked`] if another process has it, [`DataError::Replay`] if it is none, has other numbers or is damaged.
    pub fn open(path: &Path, sizes: [usize; 2]) -> Result<Self, DataError> {
        let file = OpenOptions::new().read(true).write(true).open(path);
        let file = file.map_err(DataError::io("open", path))?;
        let file = LockedFile::lock(file, path)?;
        let map = map(&file).map_err(DataError::io("map", path))?;
        let replay = ReplayBuffer::open(map, sizes).map_err(refused(path))?;
        Ok(ReplayFile { replay, path: path.to_owned(), _file: file })
    }

    /// Waits until all insertions are on the disk.
    ///
    /// # Errors
    /// If the system reports an error.
    pub fn flush(&self) -> Result<(), DataError> {
        self.replay.map().flush().map_err(DataError::io("write", &self.path))
    }
}

impl<T> Deref for ReplayFile<T> {
    type Target = ReplayBuffer<T>;

    fn deref(&self) -> &ReplayBuffer<T> {
        &self.replay
    }
}

impl<T> DerefMut for ReplayFile<T> {
    fn deref_mut(&mut self) -> &mut ReplayBuffer<T> {
        &mut self.replay
    }
}

fn refused(path: &Path) -> impl FnOnce(ReplayError) -> DataError {
    let path = path.to_owned();
    move |source| DataError::Replay { path, source }
}

/// Writes `bytes` zeros and waits until they are on the disk.
fn fill(mut file: &File, bytes: usize) -> io::Result<()> {
    let zeros = [0; 1 << 16];
    let mut left = bytes;
    while left > 0 {
        let count = left.min(zeros.len());
        file.write_all(&zeros[..count])?;
        left -= count;
    }
    file.sync_all()
}

/// The file as memory.
#[allow(unsafe_code)]
fn map(file: &File) -> io::Result<MmapMut> {
    // SAFETY: the memory must not change but through this map, nor the file get shorter. It is locked, and every process that comes
    // through here asks for the lock first. One that ignores it can change numbers, of which every pattern of bits is one, or end
    // this process by making the file shorter.
    unsafe { MmapMut::map_mut(file) }
}
