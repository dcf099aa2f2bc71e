//! An output file that appears when it is complete.

use std::ffi::OsString;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

/// Largest number of links in a chain, as on Linux.
const MOST_LINKS: usize = 40;

/// The temporary files that exist.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all temporary files of this process, which ends.
pub(crate) fn remove_temporary_files() {
    for path in TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        // A leftover temporary file is harmless.
        let _ = fs::remove_file(path);
    }
}

/// A file with a temporary name in the same folder until it is complete.
///
/// A pipe or device is written directly. A replaced file keeps its permissions, owner and links: if it has several
/// hard links, or an owner whose files this user cannot create, the complete result is written into it instead. Its
/// space is reserved first, so that a full disk leaves the old contents unchanged.
#[derive(Debug)]
pub(crate) struct OutputFile {
    file: File,
    /// The temporary file and its final name.
    pending: Option<Pending>,
}

#[derive(Debug)]
struct Pending {
    temporary: PathBuf,
    target: PathBuf,
    /// The old file to fill, if a rename would lose a hard link or the owner.
    fill: Option<File>,
}

impl OutputFile {
    /// Opens the file that will become `path`.
    ///
    /// # Errors
    /// If `path` cannot be written, or is a folder.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        if let Some(file) = standard_stream(path)? {
            return Ok(OutputFile { file, pending: None });
        }
        let target = resolve(path)?;
        let mut old = None;
        if target.exists() {
            // A file that the user made read-only stays as it is.
            let file = OpenOptions::new().write(true).open(&target)?;
            let metadata = file.metadata()?;
            if !metadata.is_file() {
                return Ok(OutputFile { file, pending: None });
            }
            old = Some((file, metadata));
        }
        let name = target.file_name().ok_or(io::ErrorKind::IsADirectory)?;
        let mut temporary = OsString::from(".");
        temporary.push(name);
        temporary.push(format!(".{}.part", process::id()));
        let temporary = target.with_file_name(temporary);
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        if old.is_some() {
            // The final permissions may be stricter than the default.
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        }
        let file = options.open(&temporary)?;
        TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner).push(temporary.clone());
        let fill = old.filter(|(_, old)| !copy_permissions(&file, old)).map(|(old, _)| old);
        Ok(OutputFile { file, pending: Some(Pending { temporary, target, fill }) })
    }

    /// Gives the complete file its name.
    ///
    /// # Errors
    /// If the file system refuses; the temporary file is then gone, unless the old file is half filled.
    pub(crate) fn keep(mut self) -> io::Result<()> {
        self.file.flush()?;
        match &self.pending {
            Some(Pending { temporary, fill: Some(file), .. }) => {
                reserve(file, fs::metadata(temporary)?.len())?;
                if let Err(error) = fill_with(file, temporary) {
                    let whole =
                        format!("{error}; `{}` holds the complete result", temporary.display());
                    self.pending = None;
                    return Err(io::Error::new(error.kind(), whole));
                }
                // A leftover temporary file is harmless.
                let _ = fs::remove_file(temporary);
            }
            Some(Pending { temporary, target, fill: None }) => fs::rename(temporary, target)?,
            None => {}
        }
        self.pending = None;
        Ok(())
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if let Some(Pending { temporary, .. }) = &self.pending {
            // A leftover temporary file is harmless.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Returns standard output or standard error, if `path` is one of their names. Other programs may write to the same file
/// before and after, so it must not be replaced or truncated.
#[cfg(unix)]
fn standard_stream(path: &Path) -> io::Result<Option<File>> {
    use std::os::fd::AsFd;
    let is = |names: [&str; 3]| names.iter().any(|name| path == Path::new(name));
    let owned = if is(["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]) {
        io::stdout().as_fd().try_clone_to_owned()?
    } else if is(["/dev/stderr", "/dev/fd/2", "/proc/self/fd/2"]) {
        io::stderr().as_fd().try_clone_to_owned()?
    } else {
        return Ok(None);
    };
    Ok(Some(File::from(owned)))
}

#[cfg(not(unix))]
fn standard_stream(_: &Path) -> io::Result<Option<File>> {
    Ok(None)
}

/// Resolves the links of a path, also if the target does not exist.
fn resolve(path: &Path) -> io::Result<PathBuf> {
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    let mut target = path.to_owned();
    if target.exists() {
        // A pipe behind `/dev/stdout` has no other name.
        return Ok(target);
    }
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Copies owner and permissions of an old file. Returns whether the new file can replace it.
#[cfg(unix)]
fn copy_permissions(file: &File, old: &Metadata) -> bool {
    use std::os::unix::fs::{MetadataExt, fchown};
    let same = file.metadata().is_ok_and(|new| (new.uid(), new.gid()) == (old.uid(), old.gid()));
    old.nlink() == 1
        && (same || fchown(file, Some(old.uid()), Some(old.gid())).is_ok())
        && file.set_permissions(old.permissions()).is_ok()
}

/// Copies the permissions of an old file. Returns whether the new file can replace it.
#[cfg(not(unix))]
fn copy_permissions(file: &File, old: &Metadata) -> bool {
    file.set_permissions(old.permissions()).is_ok()
}

/// Makes a file at least as long as `len`, with zeros that take space on the disk.
///
/// # Errors
/// If the file system refuses; the file is then as it was.
fn reserve(mut file: &File, len: u64) -> io::Result<()> {
    let old = file.metadata()?.len();
    if len <= old {
        return Ok(());
    }
    file.seek(SeekFrom::Start(old))?;
    let zeros = io::copy(&mut io::repeat(0).take(len - old), &mut file);
    // Some file systems look for space only when they are asked to write at once.
    zeros.and_then(|_| file.sync_data()).inspect_err(|_| {
        // The old contents are whole, even where zeros stay after them.
        let _ = file.set_len(old);
    })
}

/// Makes the bytes of `from` those of a file.
fn fill_with(mut file: &File, from: &Path) -> io::Result<()> {
    file.rewind()?;
    let bytes = io::copy(&mut File::open(from)?, &mut file)?;
    file.set_len(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_filled_in_place_holds_the_result_whether_that_is_longer_or_shorter() {
        let folder = tempfile::tempdir().unwrap();
        let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
        for len in [0, 1, 999, 1000, 1001, 300_000] {
            fs::write(&old, [b'o'; 1000]).unwrap();
            let result: Vec<u8> = (0..len).map(|i| (i % 251) as u8).collect();
            fs::write(&new, &result).unwrap();
            let file = OpenOptions::new().write(true).open(&old).unwrap();
            reserve(&file, len).unwrap();
            let reserved = fs::read(&old).unwrap();
            assert_eq!(reserved.len() as u64, len.max(1000));
            assert!(reserved[..1000] == [b'o'; 1000], "{len}");
            fill_with(&file, &new).unwrap();
            assert!(fs::read(&old).unwrap() == result, "{len}");
        }
    }

    #[test]
    fn a_file_whose_space_cannot_be_reserved_keeps_its_contents() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old");
        fs::write(&path, "old").unwrap();
        // Whatever is written to it is refused.
        let file = OpenOptions::new().read(true).open(&path).unwrap();
        assert!(reserve(&file, 1 << 20).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }
}
