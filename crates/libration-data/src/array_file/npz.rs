//! Reading the archives of arrays that `numpy.savez` and `numpy.savez_compressed` write.
//!
//! The container is that of PKWARE's APPNOTE.TXT, sections 4.3.7, 4.3.12 and 4.3.16: entries that are stored or deflated, and a
//! directory at the end.

use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::byte_reader::ByteReader;
use super::npy::parse_npy;
use super::{NamedArray, push_new};

const END: &[u8] = b"PK\x05\x06";
const END_BYTES: usize = 22;
const DIRECTORY_ENTRY: &[u8] = b"PK\x01\x02";
const LOCAL_HEADER: &[u8] = b"PK\x03\x04";

/// The arrays of an archive `.npz`, in their order.
///
/// All arrays together have at most `limit` bytes.
///
/// # Errors
/// The error in words, with the name of the array: no archive, a damaged one, one that is too large, or an array that has neither
/// real numbers nor strings.
pub fn read_npz(bytes: &[u8], limit: usize) -> Result<Vec<NamedArray>, String> {
    let mut end = ByteReader::little_endian(find_end(bytes)?);
    end.take(10)?;
    let (count, _size, offset) = (end.u16()?, end.u32()?, end.u32()?);
    let mut directory = ByteReader::little_endian(bytes);
    directory.take(offset).map_err(|_| "its directory lies behind its end")?;
    let mut arrays = Vec::new();
    let mut left = limit;
    for _ in 0..count {
        let entry = Entry::parse(&mut directory).map_err(|why| format!("its directory: {why}"))?;
        let name = entry
            .name
            .strip_suffix(".npy")
            .ok_or_else(|| format!("it has the file `{}`; expected arrays `.npy`", entry.name))?;
        let wrong = |why: String| format!("array `{name}`: {why}");
        let content = entry.content(bytes, left).map_err(wrong)?;
        left -= content.len();
        let values = parse_npy(&content).map_err(wrong)?;
        push_new(&mut arrays, NamedArray { name: name.to_owned(), values })?;
    }
    Ok(arrays)
}

/// The record at the end of an archive, which a comment may follow.
fn find_end(bytes: &[u8]) -> Result<&[u8], String> {
    let fits = |at: &usize| {
        let record = &bytes[*at..];
        let comment = usize::from(u16::from_le_bytes([record[20], record[21]]));
        record.starts_with(END) && record.len() == END_BYTES + comment
    };
    let last = bytes.len().checked_sub(END_BYTES);
    let start = last.and_then(|last| (0..=last).rev().find(fits));
    let start = start.ok_or("it is not a complete .npz archive; expected a file of numpy.savez")?;
    Ok(&bytes[start..])
}

/// An entry of the directory.
struct Entry<'a> {
    name: &'a str,
    method: usize,
    encrypted: bool,
    checksum: usize,
    packed: usize,
    size: usize,
    offset: usize,
}

impl<'a> Entry<'a> {
    fn parse(directory: &mut ByteReader<'a>) -> Result<Self, String> {
        if directory.take(4)? != DIRECTORY_ENTRY {
            return Err("an entry does not begin as one".to_owned());
        }
        directory.take(4)?;
        let encrypted = directory.u16()? & 1 == 1;
        let method = directory.u16()?;
        directory.take(4)?;
        let (checksum, packed, size) = (directory.u32()?, directory.u32()?, directory.u32()?);
        let (name, extra, comment) = (directory.u16()?, directory.u16()?, directory.u16()?);
        directory.take(8)?;
        let offset = directory.u32()?;
        let name = std::str::from_utf8(directory.take(name)?).map_err(|_| "a name is no UTF-8")?;
        directory.take(extra + comment)?;
        Ok(Entry { name, method, encrypted, checksum, packed, size, offset })
    }

    /// The bytes of the entry, at most `limit`.
    fn content(&self, archive: &[u8], limit: usize) -> Result<Vec<u8>, String> {
        if self.size > limit {
            return Err(format!("it has {} bytes; expected at most {limit}", self.size));
        }
        let mut reader = ByteReader::little_endian(archive);
        reader.take(self.offset)?;
        if reader.take(4)? != LOCAL_HEADER {
            return Err("it does not begin as an entry of an archive".to_owned());
        }
        reader.take(22)?;
        let (name, extra) = (reader.u16()?, reader.u16()?);
        if reader.take(name)? != self.name.as_bytes() {
            return Err("it has another name in the directory".to_owned());
        }
        reader.take(extra)?;
        let packed = reader.take(self.packed)?;
        let content = match self.method {
            _ if self.encrypted => return Err("it is encrypted".to_owned()),
            0 => packed.to_vec(),
            8 => decompress_to_vec_with_limit(packed, self.size)
                .map_err(|_| "its compressed bytes are damaged")?,
            method => {
                return Err(format!("compression {method}; expected that of savez_compressed"));
            }
        };
        if content.len() != self.size || crc32(&content) as usize != self.checksum {
            return Err("its checksum does not match".to_owned());
        }
        Ok(content)
    }
}

/// The checksum of zip archives (ISO 3309), bit by bit: the files are small.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (0xEDB8_8320 * (sum & 1)))
    })
}
