//! BLAKE3 checksums, as `b3sum FILE` computes them.

use std::io::{self, Read, Write};

use blake3::Hasher;
use libration::ensemble::has_global_threads;

/// Bytes that are read at once.
const PIECE: usize = 1 << 18;

/// BLAKE3 of the pieces of a file, in hexadecimal.
///
/// J. O'Connor, J.-P. Aumasson, S. Neves, Z. Wilcox-O'Hearn, *BLAKE3: one function, fast everywhere*, 2020. A single core sums faster
/// than a disk writes.
pub fn checksum<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut sum = Hasher::new();
    for piece in pieces {
        sum.update(piece);
    }
    sum.finalize().to_string()
}

/// The checksum and the length of a stream, read to its end.
pub(crate) fn checksum_of(mut from: impl Read) -> io::Result<(String, u64)> {
    let (mut sum, mut len, mut piece) = (Hasher::new(), 0, vec![0; PIECE]);
    loop {
        let count = match from.read(&mut piece) {
            Ok(0) => return Ok((sum.finalize().to_string(), len)),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        sum.update(&piece[..count]);
        len += count as u64;
    }
}

/// A writer that computes the checksum of its bytes; large pieces are summed on all threads.
#[derive(Debug)]
pub(crate) struct ChecksumWriter<W> {
    to: W,
    sum: Hasher,
}

impl<W> ChecksumWriter<W> {
    pub(crate) fn new(to: W) -> Self {
        ChecksumWriter { to, sum: Hasher::new() }
    }

    /// The checksum of all bytes written.
    pub(crate) fn sum(&self) -> String {
        self.sum.finalize().to_string()
    }

    pub(crate) fn into_inner(self) -> W {
        self.to
    }
}

impl<W: Write> Write for ChecksumWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.to.write(bytes)?;
        add(&mut self.sum, &bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// The checksum of what lies in one piece, on all threads if it is large.
pub(crate) fn checksum_at_once(bytes: &[u8]) -> String {
    let mut sum = Hasher::new();
    add(&mut sum, bytes);
    sum.finalize().to_string()
}

/// Bytes that are worth a thread.
const LARGE: usize = 1 << 20;

fn add(sum: &mut Hasher, bytes: &[u8]) {
    if bytes.len() < LARGE || !has_global_threads() {
        sum.update(bytes)
    } else {
        sum.update_rayon(bytes)
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_others() {
        // Of the empty input, as `b3sum` prints it.
        let nothing = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";
        assert_eq!(checksum([]), nothing);
        assert_eq!(checksum_of(&b""[..]).unwrap(), (nothing.to_owned(), 0));
        let abc = "6437b3ac38465133ffb63b75273a8db548c558465d79db03fd359c6cd5bd9d85";
        assert_eq!(checksum([&b"ab"[..], b"c"]), abc);
        assert_eq!(checksum_of(&b"abc"[..]).unwrap(), (abc.to_owned(), 3));
        assert_eq!(checksum_at_once(b"abc"), abc);
        let large = vec![7; 3 * LARGE];
        let mut written = ChecksumWriter::new(Vec::new());
        written.write_all(&large[..5]).unwrap();
        written.write_all(&large[5..]).unwrap();
        assert_eq!(written.sum(), checksum([&large[..]]));
        assert_eq!(checksum_at_once(&large), checksum([&large[..]]));
        assert!(written.into_inner() == large);
    }
}
