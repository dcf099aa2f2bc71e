//! Pages of a database.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use bytes::Bytes;

use crate::error::LogError;
use crate::input::Input;

/// Bytes in front of the tree on the first page.
pub(super) const HEADER: usize = 100;

/// The pages of a file.
pub(super) struct Pages {
    source: Source,
    size: usize,
    /// Bytes of a page without those that extensions reserve.
    usable: usize,
    count: u32,
    /// The number of pages in the header; none if it is not valid.
    stated: Option<u32>,
}

enum Source {
    File(File),
    Memory(Bytes),
}

impl Pages {
    pub(super) fn open(input: &Input) -> Result<Self, LogError> {
        let header = input.prefix(HEADER as u64)?;
        let damaged = |why: &str| LogError::Damaged(format!("the SQLite database {why}"));
        if header.len() < HEADER {
            return Err(damaged("ends within its header"));
        }
        let size = match u16::from_be_bytes([header[16], header[17]]) {
            1 => 1 << 16,
            size => usize::from(size),
        };
        if !size.is_power_of_two() || size < 512 {
            return Err(damaged(&format!(
                "has pages of {size} bytes; expected a power of 2 from 512 to 65536"
            )));
        }
        let usable = size.saturating_sub(usize::from(header[20]));
        if usable < 480 {
            return Err(damaged(&format!("has {usable} usable bytes in a page; expected 480")));
        }
        if matches!(header[59], 2 | 3) {
            return Err(damaged("has text in UTF-16; expected UTF-8"));
        }
        let (source, length) = match input {
            Input::File(path) => {
                let file = File::open(path)?;
                let length = file.metadata()?.len();
                (Source::File(file), length)
            }
            Input::Memory(bytes) => (Source::Memory(bytes.clone()), bytes.len() as u64),
        };
        let count = u32::try_from(length / size as u64).unwrap_or(u32::MAX);
        // The number of pages is valid if the last writer knew it.
        let stated = (header[24..28] == header[92..96])
            .then(|| u32::from_be_bytes([header[28], header[29], header[30], header[31]]));
        Ok(Pages { source, size, usable, count, stated })
    }

    pub(super) fn is_truncated(&self) -> bool {
        self.stated.is_some_and(|stated| stated > self.count)
    }

    /// The number of whole pages.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    pub(super) fn usable(&self) -> usize {
        self.usable
    }

    /// Reads a page, from 1 on; false if the file does not have it.
    pub(super) fn read(&mut self, page: u32, bytes: &mut Vec<u8>) -> io::Result<bool> {
        if page == 0 || page > self.count {
            return Ok(false);
        }
        let from = u64::from(page - 1) * self.size as u64;
        bytes.clear();
        match &mut self.source {
            Source::File(file) => {
                file.seek(SeekFrom::Start(from))?;
                file.take(self.size as u64).read_to_end(bytes)?;
            }
            Source::Memory(all) => {
                let from = usize::try_from(from).unwrap_or(usize::MAX);
                let all = all.get(from..).unwrap_or_default();
                bytes.extend_from_slice(&all[..self.size.min(all.len())]);
            }
        }
        // The file may have become shorter.
        Ok(bytes.len() == self.size)
    }

    /// Appends the overflow pages of a record up to its length; false if they end early.
    pub(super) fn overflow(
        &mut self,
        first: u32,
        length: u64,
        payload: &mut Vec<u8>,
        left: &mut u64,
    ) -> io::Result<bool> {
        let (mut next, mut bytes) = (first, Vec::new());
        while (payload.len() as u64) < length {
            if *left == 0 || !self.read(next, &mut bytes)? {
                return Ok(false);
            }
            *left -= 1;
            let (number, rest) = bytes.split_at(4);
            next = u32::from_be_bytes([number[0], number[1], number[2], number[3]]);
            let wanted = (length - payload.len() as u64).min(self.usable as u64 - 4) as usize;
            payload.extend_from_slice(&rest[..wanted]);
        }
        Ok(true)
    }
}
