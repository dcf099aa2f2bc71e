//! Chunks of MCAP: records that are compressed together.

use std::io::{self, BufReader, Read};

use crc32fast::Hasher;
use lz4_flex::frame::FrameDecoder;

use super::record::{discard, read_header};
use super::{ChunkEnd, Reading};
use crate::unpack_budget::UnpackBudget;

/// Logarithm of the longest window of Zstandard that is decompressed, in bytes: 128 MiB, as the library's own limit.
const WINDOW: u32 = 27;
/// Largest chunk in bytes, decompressed. It is decompressed as a stream, so this limits time.
const LIMIT: u64 = 1 << 36;

/// Reads the records of a chunk, whose body is the rest of `body`.
pub(super) fn read(
    body: &mut impl Read,
    budget: &UnpackBudget,
    reading: &mut Reading<'_>,
    messages: &mut usize,
) -> ChunkEnd {
    match Head::read(body) {
        Err(error) => ChunkEnd::Damaged(error.to_string()),
        Ok(head) => {
            let packed = body.take(head.packed);
            match head.compression.as_slice() {
                b"" => records(packed, &head, reading, messages),
                b"zstd" => {
                    // The library buffers what it decompresses.
                    let decoder =
                        zstd::stream::read::Decoder::new(packed).and_then(|mut decoder| {
                            decoder.window_log_max(WINDOW)?;
                            Ok(decoder)
                        });
                    match decoder {
                        Ok(decoder) => {
                            let unpacked = BufReader::new(budget.reader(decoder));
                            records(unpacked, &head, reading, messages)
                        }
                        Err(error) => ChunkEnd::Damaged(error.to_string()),
                    }
                }
                b"lz4" => {
                    let unpacked = budget.reader(FrameDecoder::new(packed));
                    records(unpacked, &head, reading, messages)
                }
                other => {
                    let name: String = String::from_utf8_lossy(other).chars().take(20).collect();
                    ChunkEnd::Damaged(format!("compression `{name}`; expected zstd, lz4 or none"))
                }
            }
        }
    }
}

/// The fields in front of the records.
struct Head {
    size: u64,
    checksum: u32,
    compression: Vec<u8>,
    packed: u64,
}

impl Head {
    fn read(body: &mut impl Read) -> io::Result<Self> {
        let mut fixed = [0; 32];
        body.read_exact(&mut fixed)?;
        let [.., a, b, c, d] = fixed;
        let length = u64::from(u32::from_le_bytes([a, b, c, d]));
        let mut compression = Vec::new();
        body.take(length.min(64)).read_to_end(&mut compression)?;
        discard(body, length - length.min(64))?;
        let mut packed = [0; 8];
        body.read_exact(&mut packed)?;
        let mut size = [0; 8];
        size.copy_from_slice(&fixed[16..24]);
        let checksum = u32::from_le_bytes([fixed[24], fixed[25], fixed[26], fixed[27]]);
        Ok(Head {
            size: u64::from_le_bytes(size),
            checksum,
            compression,
            packed: u64::from_le_bytes(packed),
        })
    }
}

/// Reads records up to the end of a chunk.
fn records(
    input: impl Read,
    head: &Head,
    reading: &mut Reading<'_>,
    messages: &mut usize,
) -> ChunkEnd {
    let mut input = Checked { input: input.take(head.size.min(LIMIT)), hasher: Hasher::new() };
    loop {
        let (code, length) = match read_header(&mut input) {
            Ok(Some(header)) => header,
            Ok(None) => break,
            Err(error) => return ChunkEnd::Damaged(error.to_string()),
        };
        let left = input.input.limit();
        if length > left {
            return ChunkEnd::Damaged("a record is longer than its chunk".to_owned());
        }
        if let Err(why) = reading.record(code, length, &mut input, messages) {
            return ChunkEnd::Damaged(why);
        }
        if reading.stopped {
            return ChunkEnd::Whole;
        }
        // What of the record was not read.
        let unread = length - (left - input.input.limit()).min(length);
        if let Err(error) = discard(&mut input, unread) {
            return ChunkEnd::Damaged(error.to_string());
        }
    }
    if input.input.limit() > 0 {
        return ChunkEnd::Damaged("it ends early".to_owned());
    }
    match head.checksum == 0 || head.checksum == input.hasher.finalize() {
        true => ChunkEnd::Whole,
        false => ChunkEnd::OtherChecksum,
    }
}

/// Computes the checksum of what is read.
struct Checked<R> {
    input: io::Take<R>,
    hasher: Hasher,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.hasher.update(&buffer[..count]);
        Ok(count)
    }
}
