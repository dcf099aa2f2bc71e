//! Reading files up to a limit: a device or a pipe may have no end.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::regular_file::open_regular;

/// All bytes of a file that has at most `limit` of them.
///
/// # Errors
/// If the system reports an error; [`ErrorKind::FileTooLarge`] if the file is longer.
pub fn read_bounded(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    read_rest(&File::open(path)?, limit)
}

/// All bytes of a regular file that has at most `limit` of them.
///
/// # Errors
/// As for [`read_bounded`] and [`open_regular`].
pub fn read_regular(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    read_rest(&open_regular(path)?, limit)
}

/// The text of a file that has at most `limit` bytes.
///
/// # Errors
/// As for [`read_bounded`]; [`ErrorKind::InvalidData`] if the text is not UTF-8.
pub fn read_text_bounded(path: &Path, limit: u64) -> io::Result<String> {
    text_of(read_bounded(path, limit)?)
}

/// The text of a regular file that has at most `limit` bytes.
///
/// # Errors
/// As for [`read_text_bounded`] and [`open_regular`].
pub fn read_text_regular(path: &Path, limit: u64) -> io::Result<String> {
    text_of(read_regular(path, limit)?)
}

fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    let text = String::from_utf8(bytes);
    text.map_err(|error| io::Error::new(ErrorKind::InvalidData, error.utf8_error()))
}

/// All bytes that are left in a file, if these are at most `limit`.
///
/// # Errors
/// As for [`read_bounded`].
pub(crate) fn read_rest(file: &File, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Only a regular file has a length, and is refused before it is read.
    let mut longer = file.metadata()?.len() > limit;
    if !longer {
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
        longer = bytes.len() as u64 > limit;
    }
    if longer {
        let text = format!("it is too long; expected at most {}", size(limit));
        return Err(io::Error::new(ErrorKind::FileTooLarge, text));
    }
    Ok(bytes)
}

/// A number of bytes in the largest unit that divides it.
fn size(bytes: u64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
    let whole = units.into_iter().find(|&(shift, _)| bytes.trailing_zeros() >= shift && bytes > 0);
    whole.map_or_else(
        || format!("{bytes} bytes"),
        |(shift, unit)| format!("{} {unit}", bytes >> shift),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_just_the_limit_is_read_and_a_longer_one_refused_with_the_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        std::fs::write(&path, [b'x'; 2048]).unwrap();
        assert_eq!(read_bounded(&path, 2048).unwrap().len(), 2048);
        let error = read_bounded(&path, 2047).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("at most 2047 bytes"), "{error}");
        let error = read_text_bounded(&path, 1024).unwrap_err();
        assert!(error.to_string().contains("at most 1 KiB"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_without_an_end_is_refused() {
        let error = read_bounded(Path::new("/dev/zero"), 3 << 20).unwrap_err();
        assert!(error.to_string().contains("at most 3 MiB"), "{error}");
    }
}
