//! Files that come from one folder into another.

use std::fs;
use std::io;
use std::path::Path;

use crate::bounded_read::read_regular;
use crate::folder::{AT_ONCE, NewFolders};
use crate::{DataError, Stored, checksum, run_on_threads, write_file};

/// How files come into another folder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// Each is read, compared with its checksum, and written.
    #[default]
    Copy,
    /// Each regular file gets a second name (a hard link) and is not read, where the file system can; others and links are copied.
    Link,
}

/// Brings files from one folder into another, under the same paths. When this returns, they are on the disk.
///
/// # Errors
/// If a file that is copied differs from what is known of it, or the system reports an error.
pub fn transfer_files(
    from: &Path,
    to: &Path,
    files: &[Stored],
    transfer: Transfer,
) -> Result<(), DataError> {
    let folders = NewFolders::create(to, files.iter().map(|file| &*file.path))?;
    let at_once = files.len().min(AT_ONCE);
    let done = run_on_threads(at_once, files.len(), |i| {
        let [old, new] = [from, to].map(|folder| folder.join(&files[i].path));
        match transfer {
            // A second name of a link would be a link, which leads elsewhere from another folder.
            Transfer::Link if is_regular(&old) && link(&old, &new).is_ok() => Ok(()),
            _ => copy(&old, &new, &files[i]),
        }
    });
    done.into_iter().collect::<Result<(), _>>()?;
    folders.sync(at_once)
}

fn is_regular(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_file())
}

/// Gives a file a second name, which an interrupted transfer may have given to another one.
fn link(old: &Path, new: &Path) -> io::Result<()> {
    match fs::hard_link(old, new) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            fs::remove_file(new)?;
            fs::hard_link(old, new)
        }
        linked => linked,
    }
}

fn copy(old: &Path, new: &Path, file: &Stored) -> Result<(), DataError> {
    let bytes = read_regular(old, file.bytes).map_err(DataError::io("read", old))?;
    let sum = checksum([&*bytes]);
    if sum != file.blake3 {
        let what = format!("it has the checksum {sum}; the manifest says {}", file.blake3);
        return Err(DataError::Damaged { path: old.to_owned(), what });
    }
    write_file(new, &[&bytes]).map(drop)
}
