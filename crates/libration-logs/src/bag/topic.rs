//! Topics of a bag.

use super::decoder::Decoder;
use super::message_stream::Message;
use crate::signal::ClockChoice;

/// A topic.
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) message_type: String,
    pub(super) decoder: Decoder,
    pub(super) count: usize,
    pub(super) signals: Vec<String>,
    /// Number of messages with another publish time than log time.
    pub(super) published: usize,
    /// The earliest and the latest log time in ns.
    pub(super) first: i64,
    pub(super) last: i64,
    /// Whether the first message has a time in its header.
    pub(super) has_header: bool,
}

impl Topic {
    pub(super) fn new(name: String, message_type: String, decoder: Decoder) -> Self {
        Topic {
            name,
            message_type,
            decoder,
            count: 0,
            signals: Vec::new(),
            published: 0,
            first: i64::MAX,
            last: i64::MIN,
            has_header: false,
        }
    }

    pub(super) fn add(&mut self, message: &Message<'_>) {
        if self.count == 0 {
            let names = self.decoder.signals(message.data);
            self.signals = names.into_iter().map(|name| format!("{}.{name}", self.name)).collect();
            self.has_header = self.decoder.header_time(message.data).is_some();
        }
        self.count += 1;
        self.first = self.first.min(message.log);
        self.last = self.last.max(message.log);
        self.published += usize::from(message.publish != message.log && message.publish != 0);
    }

    pub(super) fn clocks(&self) -> Vec<ClockChoice> {
        let mut clocks = vec![ClockChoice::Log];
        clocks.extend((self.published > 0).then_some(ClockChoice::Publish));
        clocks.extend(self.has_header.then_some(ClockChoice::Header));
        clocks
    }
}
