//! Folders of data sets, written chunk by chunk.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::fs;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use crate::bounded_read::read_rest;
use crate::durable_file::{named, remove_parts, sync_folder};
use crate::lock::LockedFile;
use crate::manifest::{LIMIT, NAME};
use crate::regular_file::ensure_inside;
use crate::{Chunk, DataError, Manifest, Stored, run_on_threads, write_file};

/// Files that are written at once: to wait for the disk takes as long for one as for all of them.
pub(crate) const AT_ONCE: usize = 16;

/// A folder of a data set, locked for this process.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    manifest: Manifest,
    /// The manifest's file, which is locked.
    log: LockedFile,
}

/// A new file of a chunk: its path and its bytes.
#[derive(Clone, Debug)]
pub struct NewFile<'a> {
    /// The path relative to the folder.
    pub path: PathBuf,
    /// The contents, piece by piece.
    pub pieces: Vec<&'a [u8]>,
}

impl Folder {
    /// Opens a folder for a data set of these settings. With `resume` it may hold an interrupted data set, whose chunks in the
    /// manifest stay; [`verify()`](crate::verify()) checks their files.
    ///
    /// # Errors
    /// If another process has it open, or it holds other files, another data set, or a data set without `resume`. The folder is then
    /// unchanged.
    pub fn open(
        path: &Path,
        settings: &Map<String, Value>,
        resume: bool,
    ) -> Result<Self, DataError> {
        fs::create_dir_all(path).map_err(DataError::io("create", path))?;
        let name = path.join(NAME);
        if !name.exists() {
            // Before anything is made of it.
            let entries = fs::read_dir(path).map_err(DataError::io("read", path))?;
            // Another process may have made the manifest meanwhile.
            let mut names = entries.flatten().map(|entry| entry.file_name());
            if let Some(found) = names.find(|found| found != NAME) {
                let found = found.to_string_lossy().into_owned();
                return Err(DataError::ForeignFile { folder: path.to_owned(), found });
            }
        }
        let log = LockedFile::open(&name).map_err(|error| match error {
            DataError::Locked(_) => DataError::Locked(path.to_owned()),
            error => error,
        })?;
        let text = read_rest(&log, LIMIT).map_err(DataError::io("read", &name))?;
        let (found, len) = Manifest::parse(&text, &name)?;
        let path = path.to_owned();
        let Some(manifest) = found else {
            // A first line that was cut off is the beginning of ours, or not ours to overwrite.
            let line = Value::Object(settings.clone()).to_string();
            if !line.as_bytes().starts_with(&text) {
                return Err(DataError::ForeignFile {
                    folder: path,
                    found: format!("another {NAME}"),
                });
            }
            let manifest = Manifest { settings: settings.clone(), chunks: Vec::new() };
            let mut folder = Folder { path, manifest, log };
            folder.cut(0)?;
            folder.append(&[Value::Object(settings.clone())])?;
            // The folder may be new as well.
            sync_folder(&folder.path)?;
            folder.path.parent().map_or(Ok(()), |parent| sync_folder(named(parent)))?;
            return Ok(folder);
        };
        if !resume {
            return Err(DataError::Exists(path));
        }
        ensure_same_settings(&path, &manifest.settings, settings)?;
        let mut folder = Folder { path, manifest, log };
        folder.cut(len as u64)?;
        remove_parts(&folder.path)?;
        Ok(folder)
    }

    /// The manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a chunk. When this returns, it is on the disk, and in the manifest.
    ///
    /// # Errors
    /// If the system reports an error, such as a full disk; earlier chunks are unchanged.
    pub fn commit(
        &mut self,
        chunk: &str,
        holds: Map<String, Value>,
        files: &[NewFile<'_>],
    ) -> Result<(), DataError> {
        let stored = write_files(&self.path, files)?;
        self.record(chunk, holds, stored)
    }

    /// Records in the manifest a chunk whose files are [written](write_files).
    ///
    /// # Errors
    /// If the system reports an error, such as a full disk; earlier chunks are unchanged.
    pub fn record(
        &mut self,
        chunk: &str,
        holds: Map<String, Value>,
        files: Vec<Stored>,
    ) -> Result<(), DataError> {
        self.record_all(&[Chunk { chunk: chunk.to_owned(), holds, files }])
    }

    /// Records in the manifest chunks whose files are on the disk.
    ///
    /// # Errors
    /// As for [`record`](Self::record).
    pub fn record_all(&mut self, chunks: &[Chunk]) -> Result<(), DataError> {
        let lines = chunks.iter().map(serde_json::to_value).collect::<Result<Vec<_>, _>>();
        let failed =
            |error: serde_json::Error| DataError::io("write", &self.path.join(NAME))(error.into());
        self.append(&lines.map_err(failed)?)?;
        self.manifest.chunks.extend_from_slice(chunks);
        Ok(())
    }

    /// Appends lines to the manifest.
    fn append(&mut self, lines: &[Value]) -> Result<(), DataError> {
        let name = self.path.join(NAME);
        let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
        let written = (&*self.log).write_all(text.as_bytes()).and_then(|()| self.log.sync_data());
        written.map_err(DataError::io("write", &name))
    }

    /// Truncates the manifest to its complete lines.
    fn cut(&mut self, len: u64) -> Result<(), DataError> {
        let name = self.path.join(NAME);
        let cut = self.log.set_len(len).and_then(|()| (&*self.log).seek(SeekFrom::End(0)));
        cut.map(|_| ()).map_err(DataError::io("write", &name))
    }
}

/// Writes the files of a chunk into a folder. When this returns, they are on the disk.
///
/// # Errors
/// If the system reports an error, such as a full disk.
pub fn write_files(folder: &Path, files: &[NewFile<'_>]) -> Result<Vec<Stored>, DataError> {
    let folders = NewFolders::create(folder, files.iter().map(|file| &*file.path))?;
    let at_once = files.len().min(AT_ONCE);
    let one = |i: usize| -> Result<Stored, DataError> {
        let path = files[i].path.clone();
        let (blake3, bytes) = write_file(&folder.join(&path), &files[i].pieces)?;
        Ok(Stored { path, bytes, blake3 })
    };
    let stored = run_on_threads(at_once, files.len(), one);
    let stored = stored.into_iter().collect::<Result<_, _>>()?;
    folders.sync(at_once)?;
    Ok(stored)
}

/// Every folder that has something new in it, the innermost first.
pub(crate) struct NewFolders(Vec<PathBuf>);

impl NewFolders {
    /// Creates the folders of files whose paths are relative to `folder`.
    pub(crate) fn create<'a>(
        folder: &Path,
        files: impl Iterator<Item = &'a Path>,
    ) -> Result<Self, DataError> {
        let parents: BTreeSet<_> =
            files.flat_map(|file| file.ancestors().skip(1)).map(Reverse).collect();
        // A link would lead out of the folder.
        parents.iter().try_for_each(|Reverse(inner)| ensure_inside(folder, inner))?;
        let folders: Vec<_> =
            parents.into_iter().map(|Reverse(inner)| folder.join(inner)).collect();
        for folder in folders.iter().rev() {
            fs::create_dir_all(folder).map_err(DataError::io("create", folder))?;
        }
        Ok(NewFolders(folders))
    }

    /// Waits until the names in them are on the disk.
    pub(crate) fn sync(&self, threads: usize) -> Result<(), DataError> {
        let synced = run_on_threads(threads, self.0.len(), |i| sync_folder(&self.0[i]));
        synced.into_iter().collect()
    }
}

/// Compares the settings of a data set with the required ones.
///
/// # Errors
/// [`DataError::Other`] with the first setting that differs.
pub fn ensure_same_settings(
    folder: &Path,
    found: &Map<String, Value>,
    wanted: &Map<String, Value>,
) -> Result<(), DataError> {
    let Some((name, found, wanted)) = other("", found, wanted) else { return Ok(()) };
    Err(DataError::Other { folder: folder.to_owned(), name, found, wanted })
}

/// The first key that is not the same, with all keys above it, and its values.
fn other(
    above: &str,
    found: &Map<String, Value>,
    wanted: &Map<String, Value>,
) -> Option<(String, String, String)> {
    let text = |value: Option<&Value>| value.map_or("missing".to_owned(), Value::to_string);
    wanted.keys().chain(found.keys()).find_map(|key| {
        let name = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
        match (found.get(key), wanted.get(key)) {
            (Some(Value::Object(a)), Some(Value::Object(b))) => other(&name, a, b),
            (a, b) => (a != b).then(|| (name, text(a), text(b))),
        }
    })
}
