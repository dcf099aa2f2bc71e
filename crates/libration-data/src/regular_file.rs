//! Files in folders that somebody else may have written: a link may lead out of them, and a pipe or a device may never end.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::DataError;

/// Opens a regular file, or a link to one, for reading.
///
/// # Errors
/// If the system reports an error; [`ErrorKind::InvalidInput`] for a named pipe, a device or a socket, which is not opened.
pub fn open_regular(path: &Path) -> io::Result<File> {
    // Opening a device may have effects.
    ensure_regular(&fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    // What takes the place of the file meanwhile must not make the process wait.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let file = options.open(path)?;
    ensure_regular(&file.metadata()?)?;
    Ok(file)
}

fn ensure_regular(found: &fs::Metadata) -> io::Result<()> {
    if found.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder; expected a file"));
    }
    if !found.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"));
    }
    Ok(())
}

/// Lets a file be opened only where its own name is no link.
pub(crate) fn refuse_links(options: &mut OpenOptions) -> &mut OpenOptions {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(options, libc::O_NOFOLLOW | libc::O_NONBLOCK);
    options
}

/// Fails where a path is there and is no regular file; a link is none.
///
/// # Errors
/// [`ErrorKind::InvalidInput`], or as the system reports.
pub(crate) fn ensure_no_link(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => {
            let what = "it is a link; expected a regular file; help: remove the link";
            Err(io::Error::new(ErrorKind::InvalidInput, what))
        }
        Ok(found) => ensure_regular(&found),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Creates or empties a file for writing. What is there and is no regular file, such as a link, is removed first.
///
/// # Errors
/// If the system reports an error.
pub fn create_file(path: &Path) -> io::Result<File> {
    create_with(path, OpenOptions::new().write(true))
}

/// As [`create_file`], with further options.
///
/// # Errors
/// If the system reports an error.
pub(crate) fn create_with(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    remove_irregular(path)?;
    options.create(true).truncate(true).open(path)
}

/// Removes what is no regular file and no folder.
pub(crate) fn remove_irregular(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() && !found.is_dir() => fs::remove_file(path),
        _ => Ok(()),
    }
}

/// The first folder on the way from `folder` to a path relative to it that is a link, relative to `folder`.
pub(crate) fn linked_folder(folder: &Path, relative: &Path) -> Option<PathBuf> {
    let inner: Vec<&Path> = relative.ancestors().filter(|part| *part != Path::new("")).collect();
    let is_link =
        |part: &Path| fs::symlink_metadata(folder.join(part)).is_ok_and(|found| found.is_symlink());
    inner.into_iter().rev().find(|part| is_link(part)).map(Path::to_owned)
}

/// Fails where a folder on the way to a path relative to `folder` is a link.
///
/// # Errors
/// [`DataError::Io`] with the link.
pub(crate) fn ensure_inside(folder: &Path, relative: &Path) -> Result<(), DataError> {
    match linked_folder(folder, relative) {
        None => Ok(()),
        Some(link) => {
            let what = "it is a link; expected a folder; help: remove the link";
            let error = io::Error::new(ErrorKind::InvalidInput, what);
            Err(DataError::io("write through", &folder.join(link))(error))
        }
    }
}
