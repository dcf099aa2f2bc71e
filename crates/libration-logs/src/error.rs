//! Errors of logs.

use std::io;

use thiserror::Error;

use crate::nearest_name::nearest;

/// Error of reading a log.
#[derive(Debug, Error)]
pub enum LogError {
    /// The system reports an error.
    #[error("the file cannot be read: {0}")]
    Io(#[from] io::Error),
    /// No format has such first bytes.
    #[error("the format is unknown; expected {expected}")]
    UnknownFormat {
        /// The formats.
        expected: &'static str,
    },
    /// The file is damaged from its beginning on, or has nothing to read.
    #[error("{0}")]
    Damaged(String),
    /// The file has more than a reader keeps in memory.
    #[error("the {what} is {value}; expected at most {limit}")]
    TooLarge {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: u64,
        /// The largest allowed value.
        limit: u64,
    },
    /// The file is compressed, and unpacks to far more than recordings do.
    #[error(
        "the file unpacks to more than {most} bytes; expected at most {times} times its own size"
    )]
    Unpacked {
        /// The largest allowed number of unpacked bytes.
        most: u64,
        /// The same as a multiple of the file.
        times: u64,
    },
    /// The file has no such signal, topic or column of time.
    #[error("{}", unknown(what, name, known))]
    Unknown {
        /// The noun: `signal`, `topic` or `column`.
        what: &'static str,
        /// The name.
        name: String,
        /// The names in the file.
        known: Vec<String>,
    },
    /// The messages of the topic have no such clock.
    #[error("topic `{topic}` has no {clock}; {reason}")]
    NoClock {
        /// The topic.
        topic: String,
        /// The clock.
        clock: &'static str,
        /// The reason.
        reason: String,
    },
}

/// Names that an error lists.
const MOST: usize = 12;

fn unknown(what: &str, name: &str, known: &[String]) -> String {
    let mut text = format!("the file has no {what} `{name}`");
    if known.is_empty() {
        return text + &format!(" and no other {what}");
    }
    let listed = |names: &[&str]| {
        names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let near = nearest(name, known.iter().map(String::as_str), 3);
    let first: Vec<&str> = known.iter().take(MOST).map(String::as_str).collect();
    let more = if known.len() > MOST {
        format!(" and {} more", known.len() - MOST)
    } else {
        String::new()
    };
    text += &format!("; expected one of {}{more}", listed(&first));
    if !near.is_empty() {
        text += &format!("; help: the nearest names are {}", listed(&near));
    }
    text
}
