//! Direct writes, which bypass the page cache.
//!
//! Data that is written once and read later gains nothing from the cache; copying into it took three fifths of the time.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use memmap2::MmapMut;

use crate::regular_file::{create_file, create_with};

/// The alignment of offsets, lengths and memory.
const BLOCK: usize = 4096;
/// The size of the buffer for unaligned pieces, in bytes.
const GATHERED: usize = 1 << 20;
/// The largest number of bytes per system call.
const AT_ONCE: usize = 8 << 20;
/// The smallest file, in bytes, that is written directly.
const SHORT: usize = 1 << 18;

/// Creates a file of these pieces, one after the other, and waits until they are on the disk.
pub(crate) fn create(path: &Path, pieces: &[&[u8]]) -> io::Result<()> {
    let len: usize = pieces.iter().map(|piece| piece.len()).sum();
    let file = if len >= SHORT { open(path) } else { None };
    // Not every system and not every file system knows the way, and some say so late.
    match file.map(|file| direct(file, pieces, len)) {
        Some(Err(error)) if error.kind() == io::ErrorKind::InvalidInput => plain(path, pieces),
        Some(written) => written,
        None => plain(path, pieces),
    }
}

#[cfg(target_os = "linux")]
fn open(path: &Path) -> Option<File> {
    use std::os::unix::fs::OpenOptionsExt;
    let mut options = File::options();
    options.write(true).custom_flags(libc::O_DIRECT);
    create_with(path, &mut options).ok()
}

#[cfg(not(target_os = "linux"))]
fn open(_: &Path) -> Option<File> {
    None
}

fn plain(path: &Path, pieces: &[&[u8]]) -> io::Result<()> {
    let mut file = create_file(path)?;
    pieces.iter().try_for_each(|piece| file.write_all(piece))?;
    file.sync_data()
}

fn direct(mut file: File, pieces: &[&[u8]], len: usize) -> io::Result<()> {
    let mut gathered = MmapMut::map_anon(GATHERED)?;
    let mut filled = 0;
    for piece in pieces {
        let mut rest = *piece;
        while !rest.is_empty() {
            let whole = rest.len() / BLOCK * BLOCK;
            if filled == 0 && whole > 0 && rest.as_ptr().addr().is_multiple_of(BLOCK) {
                let (now, later) = rest.split_at(whole);
                now.chunks(AT_ONCE).try_for_each(|part| file.write_all(part))?;
                rest = later;
                continue;
            }
            let count = rest.len().min(GATHERED - filled);
            gathered[filled..filled + count].copy_from_slice(&rest[..count]);
            (filled, rest) = (filled + count, &rest[count..]);
            // As soon as what is gathered ends with a block, the next piece may go straight.
            if filled == GATHERED || (rest.is_empty() && filled.is_multiple_of(BLOCK)) {
                file.write_all(&gathered[..filled])?;
                filled = 0;
            }
        }
    }
    if filled > 0 {
        let padded = filled.next_multiple_of(BLOCK);
        gathered[filled..padded].fill(0);
        file.write_all(&gathered[..padded])?;
    }
    file.set_len(len as u64)?;
    file.sync_data()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_what_was_given_whatever_its_length_and_place() {
        let dir = tempfile::TempDir::new().unwrap();
        let path = dir.path().join("file");
        let numbers: Vec<u8> = (0..3_000_000_u64).map(|i| (i * i % 251) as u8).collect();
        let mut aligned = MmapMut::map_anon(1 << 20).unwrap();
        aligned.iter_mut().zip(&numbers).for_each(|(to, byte)| *to = *byte);
        for pieces in [
            vec![],
            vec![&numbers[..5]],
            vec![&numbers[..SHORT]],
            vec![&numbers[1..]],
            vec![&numbers[..4096], &aligned[..], &numbers[7..9]],
            vec![&numbers[..128], &aligned[..], &aligned[4096..]],
            vec![&aligned[..], &aligned[..100], &aligned[..], &numbers[..2_500_000]],
        ] {
            create(&path, &pieces).unwrap();
            assert!(std::fs::read(&path).unwrap() == pieces.concat());
        }
    }
}
