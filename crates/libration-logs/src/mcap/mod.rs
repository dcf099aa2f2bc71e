//! MCAP, the container of ROS 2.
//!
//! The format is that of <https://mcap.dev/spec>: records with a code and a length, some of them in chunks that are compressed.
//! The file is read from its beginning, so that a file without its end is read as far as it goes.

mod chunk;
mod record;

use std::io::Read;

use record::{Channels, Record, discard, read_header};

use crate::bag::{Event, Message, MessageStream};
use crate::error::LogError;
use crate::input::Input;
use crate::unpack_budget::UnpackBudget;

/// A file.
pub(crate) struct Mcap {
    input: Input,
}

/// Bytes in front of the first record.
const MAGIC: usize = 8;

impl Mcap {
    pub(crate) fn new(input: Input) -> Self {
        Mcap { input }
    }
}

impl MessageStream for Mcap {
    fn format(&self) -> String {
        "MCAP".to_owned()
    }

    fn read(&self, visit: &mut dyn FnMut(Event<'_>) -> bool) -> Result<Vec<String>, LogError> {
        let mut file = self.input.reader()?;
        file.read_exact(&mut [0; MAGIC])?;
        let mut reading = Reading { channels: Channels::default(), visit, stopped: false };
        let budget = UnpackBudget::of(&self.input)?;
        let mut damage = Damage::default();
        let mut messages = 0;
        loop {
            let (code, length) = match read_header(&mut file) {
                Ok(Some(header)) => header,
                Ok(None) | Err(_) => {
                    damage.truncated = true;
                    break;
                }
            };
            if code == record::DATA_END {
                break;
            }
            if code == record::CHUNK {
                let mut body = (&mut file).take(length);
                damage.count(chunk::read(&mut body, &budget, &mut reading, &mut messages));
                let left = body.limit();
                if reading.stopped {
                    return Ok(Vec::new());
                }
                budget.check()?;
                damage.truncated = discard(&mut file, left).is_err();
            } else {
                let mut body = (&mut file).take(length);
                let outcome = reading.record(code, length, &mut body, &mut messages);
                let left = body.limit();
                if reading.stopped {
                    return Ok(Vec::new());
                }
                damage.records += usize::from(outcome.is_err());
                damage.truncated = discard(&mut file, left).is_err();
            }
            if damage.truncated {
                break;
            }
        }
        Ok(damage.notes(messages).into_iter().chain(reading.channels.notes()).collect())
    }
}

/// Records while they are read.
pub(super) struct Reading<'a> {
    channels: Channels,
    visit: &'a mut dyn FnMut(Event<'_>) -> bool,
    /// Whether the visitor wants no more.
    pub(super) stopped: bool,
}

impl Reading<'_> {
    /// Reads the body of a record.
    pub(super) fn record(
        &mut self,
        code: u8,
        length: u64,
        body: &mut impl Read,
        messages: &mut usize,
    ) -> Result<(), String> {
        match self.channels.parse(code, length, body)? {
            Record::Channel(channel) => self.stopped = !(self.visit)(Event::Channel(channel)),
            Record::Message { channel, log, publish } => {
                *messages += 1;
                let data = self.channels.data();
                let message = Message { channel, log, publish, data };
                self.stopped = !(self.visit)(Event::Message(message));
            }
            Record::Other => {}
        }
        Ok(())
    }
}

/// How a chunk ends.
pub(super) enum ChunkEnd {
    Whole,
    /// Its checksum does not match.
    OtherChecksum,
    Damaged(String),
}

/// Damage of a file.
#[derive(Default)]
struct Damage {
    truncated: bool,
    records: usize,
    chunks: usize,
    checksums: usize,
    first: Option<String>,
}

impl Damage {
    fn count(&mut self, end: ChunkEnd) {
        match end {
            ChunkEnd::Whole => {}
            ChunkEnd::OtherChecksum => self.checksums += 1,
            ChunkEnd::Damaged(why) => {
                self.chunks += 1;
                self.first.get_or_insert(why);
            }
        }
    }

    fn notes(self, messages: usize) -> Vec<String> {
        let mut notes = Vec::new();
        if self.truncated {
            notes.push(format!(
                "the end of the file is missing: read up to there, {messages} messages"
            ));
        }
        if self.chunks > 0 {
            let why = self.first.unwrap_or_default();
            notes.push(format!(
                "{} chunks are incomplete ({why}): read as far as they go",
                self.chunks
            ));
        }
        if self.checksums > 0 {
            notes.push(format!("the checksums of {} chunks do not match", self.checksums));
        }
        if self.records > 0 {
            notes.push(format!("{} records are damaged: ignored", self.records));
        }
        notes
    }
}
