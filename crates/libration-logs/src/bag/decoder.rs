//! Decoders of messages.

use crate::json_message;
use crate::ros::{RosDecoder, Step};

/// Decodes the messages of a channel.
pub(crate) enum Decoder {
    /// Messages of ROS.
    Ros(RosDecoder),
    /// JSON.
    Json,
    /// None, with the reason.
    Opaque(String),
}

/// Most signals of a topic that are listed.
const MAX_SIGNALS: usize = 2000;

/// The place of a number in a message.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SignalPath {
    Ros(Vec<Step>),
    Json(Vec<String>),
}

impl Decoder {
    /// The names of the numbers in a message.
    pub(crate) fn signals(&self, data: &[u8]) -> Vec<String> {
        match self {
            Decoder::Ros(decoder) => decoder.signals(data, MAX_SIGNALS),
            Decoder::Json => json_message::signals(data, MAX_SIGNALS),
            Decoder::Opaque(_) => Vec::new(),
        }
    }

    /// The path of a name such as `twist.linear.x` or `position[3]`.
    pub(crate) fn path(&self, name: &str) -> Option<SignalPath> {
        match self {
            Decoder::Ros(decoder) => decoder.path(name).map(SignalPath::Ros),
            Decoder::Json => json_message::path(name).map(SignalPath::Json),
            Decoder::Opaque(_) => None,
        }
    }

    /// The number at a path; none if the message is too short for it.
    pub(crate) fn value(&self, data: &[u8], path: &SignalPath) -> Option<f64> {
        match (self, path) {
            (Decoder::Ros(decoder), SignalPath::Ros(path)) => decoder.value(data, path),
            (Decoder::Json, SignalPath::Json(path)) => json_message::value(data, path),
            _ => None,
        }
    }

    /// The time in the header of a message, in ns.
    pub(crate) fn header_time(&self, data: &[u8]) -> Option<i64> {
        match self {
            Decoder::Ros(decoder) => decoder.header_time(data),
            Decoder::Json => json_message::header_time(data),
            Decoder::Opaque(_) => None,
        }
    }

    /// Why messages have no time in a header.
    pub(crate) fn why_no_header(&self, message_type: &str) -> String {
        match self {
            Decoder::Ros(_) => format!(
                "`{message_type}` has no header stamp: it does not begin with a header or a time"
            ),
            Decoder::Json => "its JSON has no header.stamp".to_owned(),
            Decoder::Opaque(reason) => reason.clone(),
        }
    }
}
