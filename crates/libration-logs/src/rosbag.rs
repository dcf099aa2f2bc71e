//! Bags of ROS 1, version 2.0.
//!
//! The format is that of <http://wiki.ros.org/Bags/Format/2.0>: records with a header of named fields and data. Connections and
//! messages are in chunks. Chunks are uncompressed, frames of LZ4, or streams of bzip2.

use std::collections::HashMap;
use std::io::{self, Read};

use bzip2::read::BzDecoder;
use lz4_flex::frame::FrameDecoder;

use crate::bag::{Channel, Decoder, Event, Message, MessageStream};
use crate::error::LogError;
use crate::input::Input;
use crate::ros::{RosDecoder, Wire};
use crate::unpack_budget::UnpackBudget;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// Largest header in bytes.
const LONGEST_HEADER: u64 = 1 << 20;
/// Largest message in bytes.
const LONGEST: u64 = 1 << 28;
/// Most connections.
const MOST: usize = 1 << 16;

/// A file.
pub(crate) struct Rosbag {
    input: Input,
}

impl Rosbag {
    pub(crate) fn new(input: Input) -> Self {
        Rosbag { input }
    }
}

impl MessageStream for Rosbag {
    fn format(&self) -> String {
        "ROS 1 bag".to_owned()
    }

    fn read(&self, visit: &mut dyn FnMut(Event<'_>) -> bool) -> Result<Vec<String>, LogError> {
        let mut file = self.input.reader()?;
        let mut magic = Vec::new();
        (&mut file).take(MAGIC.len() as u64).read_to_end(&mut magic)?;
        let budget = UnpackBudget::of(&self.input)?;
        let mut reading = Reading::new(visit);
        let mut notes = Vec::new();
        let mut damaged = 0_usize;
        let mut unknown = 0_usize;
        let truncated = loop {
            let header = match Header::read(&mut file) {
                Ok(Some(header)) => header,
                Ok(None) => break false,
                Err(_) => break true,
            };
            let mut body = (&mut file).take(header.length);
            match (header.op, header.field("compression")) {
                (CHUNK, Some(b"none") | None) => {
                    damaged += usize::from(!reading.records(&mut body))
                }
                (CHUNK, Some(b"lz4")) => {
                    let mut unpacked = budget.reader(FrameDecoder::new(&mut body));
                    damaged += usize::from(!reading.records(&mut unpacked));
                }
                (CHUNK, Some(b"bz2")) => {
                    // A few bytes of bzip2 can be many zeros, so that the header limits them.
                    let size = header.field("size").and_then(|bytes| bytes.first_chunk());
                    let size = size.map_or(0, |bytes| u64::from(u32::from_le_bytes(*bytes)));
                    let unpacked = budget.reader(BzDecoder::new(&mut body));
                    damaged += usize::from(!reading.records(&mut unpacked.take(size)));
                }
                (CHUNK, Some(_)) => unknown += 1,
                _ => damaged += usize::from(reading.record(&header, &mut body).is_err()),
            }
            if reading.stopped {
                return Ok(Vec::new());
            }
            budget.check()?;
            let left = body.limit();
            if io::copy(&mut (&mut file).take(left), &mut io::sink()).ok() != Some(left) {
                break true;
            }
        };
        if truncated {
            let messages = reading.messages;
            notes.push(format!(
                "the end of the file is missing: read up to there, {messages} messages"
            ));
        }
        if unknown > 0 {
            notes.push(format!(
                "{unknown} chunks have an unknown compression: ignored; help: rosbag decompress"
            ));
        }
        if damaged > 0 {
            notes.push(format!("{damaged} records or chunks are damaged: read as far as they go"));
        }
        Ok(notes)
    }
}

/// The header of a record, and the length of its data.
struct Header {
    op: u8,
    bytes: Vec<u8>,
    length: u64,
}

impl Header {
    /// Reads a header; none at the end.
    fn read(input: &mut impl Read) -> io::Result<Option<Self>> {
        let Some(bytes) = read_sized(input)? else { return Ok(None) };
        let mut length = [0; 4];
        input.read_exact(&mut length)?;
        let length = u64::from(u32::from_le_bytes(length));
        let mut header = Header { op: 0, bytes, length };
        header.op = header.field("op").and_then(|op| op.first().copied()).unwrap_or(0);
        Ok(Some(header))
    }

    fn field(&self, name: &str) -> Option<&[u8]> {
        field(&self.bytes, name)
    }
}

/// Reads a length of four bytes and as many bytes as it says; none at the end.
fn read_sized(input: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut length = [0; 4];
    if input.read(&mut length[..1])? == 0 {
        return Ok(None);
    }
    input.read_exact(&mut length[1..])?;
    let length = u64::from(u32::from_le_bytes(length));
    let mut bytes = Vec::new();
    input.take(length.min(LONGEST_HEADER)).read_to_end(&mut bytes)?;
    match bytes.len() as u64 == length {
        true => Ok(Some(bytes)),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

/// The value of a field in `length name=value` one after the other.
fn field<'a>(mut bytes: &'a [u8], name: &str) -> Option<&'a [u8]> {
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let (field, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let at = field.iter().position(|byte| *byte == b'=')?;
        if &field[..at] == name.as_bytes() {
            return Some(&field[at + 1..]);
        }
        bytes = rest;
    }
    None
}

/// Records while they are read.
struct Reading<'a> {
    visit: &'a mut dyn FnMut(Event<'_>) -> bool,
    known: HashMap<u32, ()>,
    data: Vec<u8>,
    messages: usize,
    stopped: bool,
}

impl<'a> Reading<'a> {
    fn new(visit: &'a mut dyn FnMut(Event<'_>) -> bool) -> Self {
        Reading { visit, known: HashMap::new(), data: Vec::new(), messages: 0, stopped: false }
    }

    /// Reads the records of a chunk; false if one is damaged.
    fn records(&mut self, input: &mut impl Read) -> bool {
        loop {
            let header = match Header::read(input) {
                Ok(Some(header)) => header,
                Ok(None) => return true,
                Err(_) => return false,
            };
            let mut body = input.take(header.length);
            if self.record(&header, &mut body).is_err() {
                return false;
            }
            let left = body.limit();
            if self.stopped || io::copy(&mut input.take(left), &mut io::sink()).ok() != Some(left) {
                return self.stopped;
            }
        }
    }

    fn record(&mut self, header: &Header, body: &mut impl Read) -> io::Result<()> {
        let damaged = || io::Error::from(io::ErrorKind::InvalidData);
        if !matches!(header.op, MESSAGE | CONNECTION) {
            return Ok(());
        }
        let number = |name: &str| {
            let four = header.field(name).and_then(|bytes| bytes.first_chunk());
            four.map(|bytes| u32::from_le_bytes(*bytes)).ok_or_else(damaged)
        };
        if header.length > LONGEST {
            return Err(damaged());
        }
        let id = number("conn")?;
        self.data.clear();
        body.take(header.length).read_to_end(&mut self.data)?;
        if (self.data.len() as u64) < header.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        if header.op == CONNECTION {
            if self.known.len() < MOST && self.known.insert(id, ()).is_none() {
                let channel = channel(id, header, &self.data).ok_or_else(damaged)?;
                self.stopped = !(self.visit)(Event::Channel(channel));
            }
            return Ok(());
        }
        let time = header.field("time").and_then(|bytes| bytes.first_chunk::<8>());
        let [a, b, c, d, e, f, g, h] = *time.ok_or_else(damaged)?;
        let seconds = i64::from(u32::from_le_bytes([a, b, c, d]));
        let log = seconds * 1_000_000_000 + i64::from(u32::from_le_bytes([e, f, g, h]));
        self.messages += 1;
        let message = Message { channel: id, log, publish: log, data: &self.data };
        self.stopped = !(self.visit)(Event::Message(message));
        Ok(())
    }
}

/// The channel of a connection.
fn channel(id: u32, header: &Header, data: &[u8]) -> Option<Channel> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    // Some recorders write the topic in the data only.
    let topic = text(header.field("topic").or_else(|| field(data, "topic"))?);
    let message_type = text(field(data, "type")?);
    let definition = text(field(data, "message_definition").unwrap_or_default());
    let decoder = RosDecoder::of_text(&message_type, &definition, Wire::Packed);
    let decoder = decoder.map_or_else(Decoder::Opaque, Decoder::Ros);
    Some(Channel { id, topic, message_type, decoder })
}
