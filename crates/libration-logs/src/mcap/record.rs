//! Records of MCAP.

use std::collections::HashMap;
use std::io::{self, ErrorKind, Read};

use crate::bag::{Channel, Decoder};
use crate::ros::{RosDecoder, Wire};

const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
pub(super) const CHUNK: u8 = 6;
pub(super) const DATA_END: u8 = 15;

/// Largest message, schema or channel in bytes.
const LIMIT: u64 = 1 << 28;
/// Largest sum of all schemas in bytes, and of all names of topics.
const SCHEMAS: usize = 1 << 26;
/// Largest schema that is parsed in bytes.
const LONGEST_SCHEMA: usize = 1 << 22;
/// Largest sum of all schemas that are parsed in bytes: each channel parses its own.
const PARSED: usize = 1 << 28;

/// The code and the length of the next record; none at the end.
pub(super) fn read_header(input: &mut impl Read) -> io::Result<Option<(u8, u64)>> {
    let mut code = [0];
    if input.read(&mut code)? == 0 {
        return Ok(None);
    }
    let mut length = [0; 8];
    input.read_exact(&mut length)?;
    Ok(Some((code[0], u64::from_le_bytes(length))))
}

/// Reads and forgets `count` bytes.
pub(super) fn discard(input: &mut impl Read, count: u64) -> io::Result<()> {
    match io::copy(&mut input.take(count), &mut io::sink())? == count {
        true => Ok(()),
        false => Err(ErrorKind::UnexpectedEof.into()),
    }
}

/// A record.
pub(super) enum Record {
    Channel(Channel),
    /// Its bytes are in [`Channels::data`].
    Message {
        channel: u32,
        log: i64,
        publish: i64,
    },
    Other,
}

struct Schema {
    name: String,
    encoding: String,
    text: Vec<u8>,
}

/// The schemas and the channels up to here, and the bytes of the record.
#[derive(Default)]
pub(super) struct Channels {
    schemas: HashMap<u16, Schema>,
    schema_bytes: usize,
    known: HashMap<u16, (u16, String)>,
    bytes: Vec<u8>,
    data_from: usize,
    topic_bytes: usize,
    parsed_bytes: usize,
    /// Number of messages that are too long.
    long: usize,
}

impl Channels {
    /// The bytes of the message that was parsed last.
    pub(super) fn data(&self) -> &[u8] {
        self.bytes.get(self.data_from..).unwrap_or_default()
    }

    pub(super) fn notes(&self) -> Option<String> {
        (self.long > 0)
            .then(|| format!("{} records are longer than {LIMIT} bytes: ignored", self.long))
    }

    /// Parses a record of `length` bytes.
    pub(super) fn parse(
        &mut self,
        code: u8,
        length: u64,
        body: &mut impl Read,
    ) -> Result<Record, String> {
        if !matches!(code, SCHEMA | CHANNEL | MESSAGE) {
            return Ok(Record::Other);
        }
        if length > LIMIT {
            self.long += 1;
            return Ok(Record::Other);
        }
        self.bytes.clear();
        // The buffer grows with what is there, not with what the length says.
        let read = body.take(length).read_to_end(&mut self.bytes).map_err(|e| e.to_string())?;
        if (read as u64) < length {
            return Err("a record ends early".to_owned());
        }
        let mut fields = Fields { rest: &self.bytes };
        let short = || "a record is too short".to_owned();
        match code {
            SCHEMA => {
                let schema = fields.schema().ok_or_else(short)?;
                self.keep_schema(schema);
                Ok(Record::Other)
            }
            CHANNEL => {
                let (id, schema, topic, encoding) = fields.channel().ok_or_else(short)?;
                Ok(self.keep_channel(id, schema, topic, &encoding))
            }
            _ => {
                let message = fields.message().ok_or_else(short)?;
                self.data_from = self.bytes.len() - fields.rest.len();
                let (channel, log, publish) = message;
                Ok(Record::Message { channel: u32::from(channel), log, publish })
            }
        }
    }

    fn keep_schema(&mut self, (id, schema): (u16, Schema)) {
        // The first of an id counts, as the specification says; chunks repeat it.
        if id != 0
            && !self.schemas.contains_key(&id)
            && self.schema_bytes + schema.text.len() <= SCHEMAS
        {
            self.schema_bytes += schema.text.len();
            self.schemas.insert(id, schema);
        }
    }

    fn keep_channel(&mut self, id: u16, schema: u16, topic: String, encoding: &str) -> Record {
        // Chunks repeat channels.
        let key = (schema, topic.clone());
        if self.known.get(&id) == Some(&key) {
            return Record::Other;
        }
        self.topic_bytes += topic.len();
        if self.topic_bytes > SCHEMAS {
            return Record::Other;
        }
        self.known.insert(id, key);
        let schema = self.schemas.get(&schema);
        let length = schema.map_or(0, |schema| schema.text.len());
        self.parsed_bytes = self.parsed_bytes.saturating_add(length);
        let message_type = schema.map_or_else(|| encoding.to_owned(), |schema| schema.name.clone());
        let decoder = match length > LONGEST_SCHEMA || self.parsed_bytes > PARSED {
            true => Decoder::Opaque("its schema is too long to be parsed".to_owned()),
            false => decoder(encoding, schema),
        };
        Record::Channel(Channel { id: u32::from(id), topic, message_type, decoder })
    }
}

/// The decoder of messages with an encoding and a schema.
fn decoder(encoding: &str, schema: Option<&Schema>) -> Decoder {
    let text = |schema: &Schema| String::from_utf8_lossy(&schema.text).into_owned();
    let made = match (encoding, schema) {
        ("json", _) => return Decoder::Json,
        ("cdr", Some(schema)) if schema.encoding == "ros2msg" => {
            RosDecoder::of_text(&schema.name, &text(schema), Wire::Cdr)
        }
        ("cdr", Some(schema)) if schema.encoding == "ros2idl" => {
            RosDecoder::of_idl(&schema.name, &text(schema))
        }
        ("ros1", Some(schema)) if schema.encoding == "ros1msg" => {
            RosDecoder::of_text(&schema.name, &text(schema), Wire::Packed)
        }
        (_, Some(schema)) => Err(format!(
            "its messages are `{encoding}` by schema `{}`, which is not decoded",
            schema.encoding
        )),
        (_, None) => Err(format!("its messages are `{encoding}` without a schema")),
    };
    made.map_or_else(Decoder::Opaque, Decoder::Ros)
}

/// The fields of a record.
struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    fn u16(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes(self.take(2)?.try_into().ok()?))
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = u32::from_le_bytes(self.take(4)?.try_into().ok()?);
        self.take(length as usize)
    }

    fn text(&mut self) -> Option<String> {
        Some(String::from_utf8_lossy(self.bytes()?).into_owned())
    }

    /// Nanoseconds; those after the year 2262 are the last that fits.
    fn time(&mut self) -> Option<i64> {
        let time = u64::from_le_bytes(self.take(8)?.try_into().ok()?);
        Some(i64::try_from(time).unwrap_or(i64::MAX))
    }

    fn schema(&mut self) -> Option<(u16, Schema)> {
        let id = self.u16()?;
        let (name, encoding) = (self.text()?, self.text()?);
        Some((id, Schema { name, encoding, text: self.bytes()?.to_vec() }))
    }

    fn channel(&mut self) -> Option<(u16, u16, String, String)> {
        Some((self.u16()?, self.u16()?, self.text()?, self.text()?))
    }

    fn message(&mut self) -> Option<(u16, i64, i64)> {
        let channel = self.u16()?;
        self.take(4)?;
        Some((channel, self.time()?, self.time()?))
    }
}
