//! Bags of ROS 2 in SQLite, the storage `sqlite3` of `rosbag2`: topics and messages in two tables.
//!
//! Versions before 4 of the schema have no definitions of messages: those of common packages are known, and stamps of some others.

use std::collections::HashMap;

use crate::bag::{Channel, Decoder, Event, Message, MessageStream};
use crate::error::LogError;
use crate::input::Input;
use crate::ros::{RosDecoder, Wire};
use crate::sqlite::{Damage, Database, Record, TableInfo, Value};

pub(crate) use crate::sqlite::MAGIC;

/// Most topics.
const MOST_TOPICS: usize = 1 << 14;
/// Largest sum of all definitions in bytes.
const DEFINITIONS: usize = 1 << 26;
/// The first bytes of a message that `rosbag2` compresses.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// Bytes of a write-ahead log without changes.
const EMPTY_LOG: u64 = 32;

/// A file.
pub(crate) struct Rosbag2 {
    input: Input,
}

/// Definitions by type: their encoding and text.
type Definitions = HashMap<String, (String, String)>;

impl Rosbag2 {
    pub(crate) fn new(input: Input) -> Self {
        Rosbag2 { input }
    }

    /// A note if the recorder has left changes in a file beside the database.
    fn unmerged(&self) -> Option<String> {
        let Input::File(path) = &self.input else { return None };
        let beside = |ending: &str, empty: u64| {
            let mut name = path.clone().into_os_string();
            name.push(ending);
            std::fs::metadata(&name).is_ok_and(|found| found.len() > empty)
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if beside("-wal", EMPTY_LOG) {
            return Some(format!(
                "warning: messages may be missing: `{name}-wal` has changes that are not in the file; help: sqlite3 {name} 'PRAGMA wal_checkpoint(TRUNCATE)'"
            ));
        }
        beside("-journal", 0).then(|| {
            format!(
                "warning: `{name}-journal` is left of an interrupted recording: messages may be missing or damaged; help: sqlite3 {name} 'PRAGMA integrity_check'"
            )
        })
    }
}

impl MessageStream for Rosbag2 {
    fn format(&self) -> String {
        "ROS 2 bag in SQLite".to_owned()
    }

    fn read(&self, visit: &mut dyn FnMut(Event<'_>) -> bool) -> Result<Vec<String>, LogError> {
        let mut database = Database::open(&self.input)?;
        let mut notes: Vec<String> = self.unmerged().into_iter().collect();
        let (tables, mut damage) = database.tables()?;
        let find = |name: &str| tables.iter().find(|table| table.name == name);
        let (Some(topics), Some(messages)) = (find("topics"), find("messages")) else {
            let note = notes.first().map_or_else(String::new, |note| format!("; {note}"));
            return Err(LogError::Damaged(format!(
                "the SQLite database has no tables `topics` and `messages`; expected those of a ROS 2 bag{note}"
            )));
        };
        if let Some(table) = [topics, messages].into_iter().find(|table| table.is_without_rowid) {
            return Err(LogError::Damaged(format!(
                "the table `{}` is WITHOUT ROWID, which is not supported; expected a table as `ros2 bag record` creates it",
                table.name
            )));
        }
        let definitions = match find("message_definitions") {
            Some(table) => definitions(&mut database, table, &mut damage)?,
            None => Definitions::new(),
        };
        let mut channels = HashMap::new();
        let mut stopped = false;
        let [name, kind, format] = columns(topics, ["name", "type", "serialization_format"])?;
        let found = database.visit(topics.root, &mut |rowid, record| {
            let text = |column| record.value(column).and_then(Value::text);
            let (Some(topic), Some(message_type)) = (text(name), text(kind)) else { return true };
            let id = channels.len() as u32;
            channels.insert(number(topics, "id", rowid, record), id);
            let decoder = decoder(&message_type, &text(format).unwrap_or_default(), &definitions);
            stopped = !visit(Event::Channel(Channel { id, topic, message_type, decoder }));
            !stopped && channels.len() < MOST_TOPICS
        })?;
        damage.add(found);
        let [topic, timestamp, data] = columns(messages, ["topic_id", "timestamp", "data"])?;
        let mut compressed = 0_usize;
        let [mut incomplete, mut textual, mut complete] = [0_usize; 3];
        let found = match stopped {
            true => Damage::default(),
            false => database.visit(messages.root, &mut |_, record| {
                let integer = |column| record.value(column).and_then(Value::integer);
                let (Some(id), Some(log), Some(Value::Blob(data))) =
                    (integer(topic), integer(timestamp), record.value(data))
                else {
                    let is_other = |column| {
                        matches!(record.value(column), Some(Value::Text(_) | Value::Float(_)))
                    };
                    match is_other(topic) || is_other(timestamp) {
                        true => textual += 1,
                        false => incomplete += 1,
                    }
                    return true;
                };
                complete += 1;
                compressed += usize::from(data.starts_with(&ZSTD));
                let channel = channels.get(&id).copied().unwrap_or(u32::MAX);
                stopped = !visit(Event::Message(Message { channel, log, publish: log, data }));
                !stopped
            })?,
        };
        if stopped {
            return Ok(Vec::new());
        }
        damage.add(found);
        if textual > complete {
            return Err(LogError::Damaged(format!(
                "the column `timestamp` or `topic_id` of {textual} messages has text or decimals, which is not supported; expected whole numbers, the time in ns"
            )));
        }
        if textual > 0 {
            notes.push(format!(
                "{textual} messages have text or decimals as `timestamp` or `topic_id`: ignored"
            ));
        }
        if database.is_truncated() {
            notes.push("the end of the file is missing: read up to there".to_owned());
        }
        if damage.count + incomplete > 0 {
            let count = damage.count + incomplete;
            notes.push(format!("{count} pages or records are damaged: ignored"));
        }
        if damage.long > 0 {
            notes.push(format!("{} records are longer than 256 MiB: ignored", damage.long));
        }
        if compressed > 0 {
            notes.push(format!(
                "{compressed} messages are compressed with zstd: only their log times are read"
            ));
        }
        if definitions.is_empty() && complete > 0 {
            notes.push(
                "the file has no definitions of messages: only fields of common types are read"
                    .to_owned(),
            );
        }
        Ok(notes)
    }
}

/// The indices of columns.
fn columns<const N: usize>(table: &TableInfo, names: [&str; N]) -> Result<[usize; N], LogError> {
    let mut indices = [0; N];
    for (index, name) in indices.iter_mut().zip(names) {
        *index = table.column(name).ok_or_else(|| {
            LogError::Damaged(format!("the table `{}` has no column `{name}`", table.name))
        })?;
    }
    Ok(indices)
}

/// An integer of a row. A column that is the number of the row is stored as null.
fn number(table: &TableInfo, name: &str, rowid: i64, record: &Record<'_>) -> i64 {
    let value = table.column(name).and_then(|column| record.value(column));
    value.and_then(Value::integer).unwrap_or(rowid)
}

/// The definitions of messages.
fn definitions(
    database: &mut Database,
    table: &TableInfo,
    damage: &mut Damage,
) -> Result<Definitions, LogError> {
    let names = ["topic_type", "encoding", "encoded_message_definition"];
    let [kind, encoding, text] = columns(table, names)?;
    let (mut all, mut bytes) = (Definitions::new(), 0);
    let found = database.visit(table.root, &mut |_, record| {
        let get = |column| record.value(column).and_then(Value::text);
        if let (Some(kind), Some(encoding), Some(text)) = (get(kind), get(encoding), get(text)) {
            bytes += text.len();
            if bytes <= DEFINITIONS {
                all.insert(kind, (encoding, text));
            }
        }
        bytes <= DEFINITIONS && all.len() < MOST_TOPICS
    })?;
    damage.add(found);
    Ok(all)
}

/// The decoder of messages of a type.
fn decoder(message_type: &str, format: &str, definitions: &Definitions) -> Decoder {
    let made = match definitions.get(message_type) {
        _ if format != "cdr" => Err(format!("its messages are `{format}`, which is not decoded")),
        Some((encoding, text)) if encoding == "ros2msg" => {
            RosDecoder::of_text(message_type, text, Wire::Cdr)
        }
        Some((encoding, text)) if encoding == "ros2idl" => RosDecoder::of_idl(message_type, text),
        _ => RosDecoder::of_common_type(message_type).ok_or_else(|| {
            format!("the file has no definition of `{message_type}`; help: ros2 bag convert to MCAP adds it")
        }),
    };
    made.map_or_else(Decoder::Opaque, Decoder::Ros)
}
