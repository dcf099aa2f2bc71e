//! Streams of messages.

use super::Decoder;
use crate::error::LogError;

/// A file that is read from its beginning as often as needed.
pub(crate) trait MessageStream: Send {
    /// The name of the format.
    fn format(&self) -> String;

    /// Calls `visit` for each channel and message in file order until it returns false; returns remarks about damage.
    ///
    /// A channel comes before its messages.
    fn read(&self, visit: &mut dyn FnMut(Event<'_>) -> bool) -> Result<Vec<String>, LogError>;
}

/// What a stream consists of.
pub(crate) enum Event<'a> {
    Channel(Channel),
    Message(Message<'a>),
}

/// Messages of one type on one topic from one sender.
pub(crate) struct Channel {
    pub(crate) id: u32,
    pub(crate) topic: String,
    pub(crate) message_type: String,
    pub(crate) decoder: Decoder,
}

/// A message.
pub(crate) struct Message<'a> {
    pub(crate) channel: u32,
    /// In ns.
    pub(crate) log: i64,
    /// In ns.
    pub(crate) publish: i64,
    pub(crate) data: &'a [u8],
}
