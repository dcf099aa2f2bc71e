//! Signals, topics and clocks of a log.

/// Which of the clocks of a bag gives the time of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ClockChoice {
    /// The time at which the recorder received the message.
    #[default]
    Log,
    /// The time at which the sender published it.
    Publish,
    /// The time in the header of the message.
    Header,
}

impl ClockChoice {
    /// All clocks.
    pub const ALL: [ClockChoice; 3] = [ClockChoice::Log, ClockChoice::Publish, ClockChoice::Header];

    /// The name of the clock.
    pub fn name(self) -> &'static str {
        match self {
            ClockChoice::Log => "log",
            ClockChoice::Publish => "publish",
            ClockChoice::Header => "header",
        }
    }
}

/// A signal of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalInfo {
    /// The name: a column, or `/topic.field`, `/topic.field.part`, `/topic.field[3]`.
    pub name: String,
    /// The number of values.
    pub count: usize,
    /// The unit, if the file has one.
    pub unit: Option<String>,
}

/// A topic of a log: messages of one kind, or a column of time stamps.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicInfo {
    /// The name.
    pub name: String,
    /// The type of its messages.
    pub message_type: String,
    /// The number of messages.
    pub count: usize,
    /// The clocks that its messages have.
    pub clocks: Vec<ClockChoice>,
    /// The time from the first message to the last one in s, by the log clock.
    pub span: f64,
}

/// A signal over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The times in s from the first stamp of the file, in file order.
    pub time: Vec<f64>,
    /// As many values.
    pub values: Vec<f64>,
}
