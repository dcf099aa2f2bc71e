//! ULog, the log of PX4.
//!
//! The format is that of <https://docs.px4.io/main/en/dev_log/ulog_file_format.html>: messages with a size and a letter. Formats (`F`)
//! describe the bytes of data (`D`), which subscriptions (`A`) name.

use std::collections::HashMap;
use std::io::{self, Read};

use crate::bag::{Channel, Decoder, Event, Message, MessageStream};
use crate::error::LogError;
use crate::input::Input;
use crate::ros::{RosDecoder, Step, Wire};

/// The first bytes of a file.
pub(crate) const MAGIC: [u8; 7] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35];

/// Bytes in front of the first message.
const HEADER: usize = 16;
/// Most formats, and most subscriptions.
const MOST: usize = 1 << 14;

/// A file.
pub(crate) struct Ulog {
    input: Input,
}

impl Ulog {
    pub(crate) fn new(input: Input) -> Self {
        Ulog { input }
    }
}

impl MessageStream for Ulog {
    fn format(&self) -> String {
        "ULog".to_owned()
    }

    fn read(&self, visit: &mut dyn FnMut(Event<'_>) -> bool) -> Result<Vec<String>, LogError> {
        let mut file = self.input.reader()?;
        file.read_exact(&mut [0; HEADER])?;
        let mut state = State::default();
        let mut body = Vec::new();
        loop {
            match read_message(&mut file, &mut body) {
                Ok(Some(letter)) => {
                    if !state.message(letter, &body, visit) {
                        return Ok(Vec::new());
                    }
                }
                Ok(None) => break,
                Err(_) => {
                    state.truncated = true;
                    break;
                }
            }
        }
        Ok(state.notes())
    }
}

/// Reads a message of at most 64 kB, and returns its letter; none at the end.
fn read_message(file: &mut impl Read, body: &mut Vec<u8>) -> io::Result<Option<u8>> {
    let mut head = [0; 3];
    if file.read(&mut head[..1])? == 0 {
        return Ok(None);
    }
    file.read_exact(&mut head[1..])?;
    body.resize(usize::from(u16::from_le_bytes([head[0], head[1]])), 0);
    file.read_exact(body)?;
    Ok(Some(head[2]))
}

/// What a file has said up to here.
#[derive(Default)]
struct State {
    formats: HashMap<String, String>,
    /// The place of the time stamp of each subscription.
    subscriptions: HashMap<u16, Option<(RosDecoder, Vec<Step>)>>,
    messages: usize,
    dropouts: usize,
    /// In ms.
    dropped: u64,
    damaged: usize,
    truncated: bool,
}

impl State {
    /// Reads a message; false if the visitor wants no more.
    fn message(
        &mut self,
        letter: u8,
        body: &[u8],
        visit: &mut dyn FnMut(Event<'_>) -> bool,
    ) -> bool {
        match letter {
            b'F' => self.format(body),
            b'A' => {
                let Some(channel) = self.subscription(body) else {
                    self.damaged += 1;
                    return true;
                };
                return visit(Event::Channel(channel));
            }
            b'D' => {
                let Some((id, data)) = body.split_first_chunk() else { return true };
                let id = u16::from_le_bytes(*id);
                let Some(Some((decoder, stamp))) = self.subscriptions.get(&id) else {
                    self.damaged += 1;
                    return true;
                };
                let Some(log) = decoder.value(data, stamp).map(nanoseconds) else {
                    self.damaged += 1;
                    return true;
                };
                self.messages += 1;
                return visit(Event::Message(Message {
                    channel: u32::from(id),
                    log,
                    publish: log,
                    data,
                }));
            }
            b'O' => {
                self.dropouts += 1;
                let duration = body.first_chunk().map_or(0, |two| u16::from_le_bytes(*two));
                self.dropped += u64::from(duration);
            }
            _ => {}
        }
        true
    }

    /// Keeps a format: `name:type field;type[3] field;`.
    fn format(&mut self, body: &[u8]) {
        let text = String::from_utf8_lossy(body);
        if let Some((name, fields)) = text.split_once(':').filter(|_| self.formats.len() < MOST) {
            self.formats.insert(name.to_owned(), definition(fields));
        }
    }

    fn subscription(&mut self, body: &[u8]) -> Option<Channel> {
        let (&[instance, low, high], name) = body.split_first_chunk()?;
        let id = u16::from_le_bytes([low, high]);
        let name = std::str::from_utf8(name).ok()?;
        let text = self.text(name)?;
        let decoder = || RosDecoder::of_text(name, &text, Wire::Packed).ok();
        let stamp = decoder().and_then(|decoder| {
            let path = decoder.path("timestamp")?;
            Some((decoder, path))
        });
        if self.subscriptions.len() >= MOST {
            return None;
        }
        self.subscriptions.insert(id, stamp);
        let decoder = decoder()?.with_microseconds("timestamp_sample");
        let topic = if instance == 0 { name.to_owned() } else { format!("{name}/{instance}") };
        Some(Channel {
            id: u32::from(id),
            topic,
            message_type: name.to_owned(),
            decoder: Decoder::Ros(decoder),
        })
    }

    /// The definition of a format with those that it mentions.
    fn text(&self, name: &str) -> Option<String> {
        const LINE: &str = "====================\nMSG: ";
        let mut text = self.formats.get(name)?.clone();
        let mut mentioned = vec![name.to_owned()];
        let mut next = 0;
        while let Some(own) = mentioned.get(next).and_then(|own| self.formats.get(own)) {
            for kind in own.lines().filter_map(|line| line.split([' ', '[']).next()) {
                if self.formats.contains_key(kind) && !mentioned.iter().any(|other| other == kind) {
                    text += &format!("{LINE}{kind}\n{}", self.formats[kind]);
                    mentioned.push(kind.to_owned());
                }
            }
            next += 1;
        }
        Some(text)
    }

    fn notes(self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.truncated {
            let messages = self.messages;
            notes.push(format!(
                "the end of the file is missing: read up to there, {messages} messages"
            ));
        }
        if self.dropouts > 0 {
            notes.push(format!(
                "the logger lost data {} times, {} ms in total",
                self.dropouts, self.dropped
            ));
        }
        if self.damaged > 0 {
            notes.push(format!("{} messages are damaged: ignored", self.damaged));
        }
        notes
    }
}

/// Microseconds as nanoseconds; a conversion to an integer saturates.
fn nanoseconds(microseconds: f64) -> i64 {
    (microseconds as i64).saturating_mul(1000)
}

/// The fields of a format as lines of a definition.
fn definition(fields: &str) -> String {
    let mut text = String::new();
    for field in fields.split(';') {
        let Some((kind, name)) = field.trim().split_once(' ') else { continue };
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, format!("[{count}")),
            None => (kind, String::new()),
        };
        let kind = match kind {
            "float" => "float32",
            "double" => "float64",
            "char" => "uint8",
            other => other.strip_suffix("_t").unwrap_or(other),
        };
        text += &format!("{kind}{count} {name}\n");
    }
    text
}
