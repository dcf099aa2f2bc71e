//! Bags: messages on topics, read one after the other.
//!
//! A bag is read as a stream, once for its list of topics and again for each request. No more than a message is in memory, besides what
//! is asked for.

mod decoder;
mod message_stream;
mod topic;

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

pub(crate) use decoder::Decoder;
use decoder::SignalPath;
pub(crate) use message_stream::{Channel, Event, Message, MessageStream};

use topic::Topic;

use crate::error::LogError;
use crate::signal::{ClockChoice, Series, SignalInfo, TopicInfo};
use crate::source::Source;

/// Most values of a series, and most messages of a topic: 2 GiB of numbers.
const MOST: usize = 1 << 27;
/// Most channels of a bag.
const MOST_CHANNELS: usize = 1 << 14;

/// The stamps of a topic by each clock, in ns.
type Stamps = [Vec<Option<i64>>; 3];

/// Topics whose stamps are kept.
const KEPT: usize = 2;

/// A bag.
pub(crate) struct Bag<S> {
    stream: S,
    topics: Vec<Topic>,
    /// The topic of each channel.
    of_channel: HashMap<u32, usize>,
    notes: Vec<String>,
    /// The log time of the first message, in ns.
    origin: i64,
    /// The stamps of the topics that were read last.
    cache: Mutex<Vec<(usize, Arc<Stamps>)>>,
}

impl<S: MessageStream> Bag<S> {
    /// Reads the topics of a stream.
    pub(crate) fn open(stream: S) -> Result<Self, LogError> {
        let mut topics: Vec<Topic> = Vec::new();
        let mut of_channel = HashMap::new();
        let mut by_name: BTreeMap<(String, String), usize> = BTreeMap::new();
        let (mut origin, mut latest, mut backward, mut messages) =
            (None, i64::MIN, 0_usize, 0_usize);
        let mut unknown = 0_usize;
        let mut too_many = None;
        let mut notes = stream.read(&mut |event| match event {
            Event::Channel(channel) => {
                if of_channel.len() >= MOST_CHANNELS {
                    too_many = Some(of_channel.len() as u64 + 1);
                    return false;
                }
                let key = (channel.topic.clone(), channel.message_type.clone());
                let index = *by_name.entry(key).or_insert_with(|| {
                    let is_second = topics.iter().any(|topic| topic.name == channel.topic);
                    let name = match is_second {
                        true => format!("{}:{}", channel.topic, channel.message_type),
                        false => channel.topic,
                    };
                    topics.push(Topic::new(name, channel.message_type, channel.decoder));
                    topics.len() - 1
                });
                of_channel.insert(channel.id, index);
                true
            }
            Event::Message(message) => {
                messages += 1;
                origin.get_or_insert(message.log);
                backward += usize::from(message.log < latest);
                latest = latest.max(message.log);
                match of_channel.get(&message.channel) {
                    Some(&index) => topics[index].add(&message),
                    None => unknown += 1,
                }
                true
            }
        })?;
        if let Some(value) = too_many {
            let limit = MOST_CHANNELS as u64;
            return Err(LogError::TooLarge { what: "number of channels", value, limit });
        }
        if messages == 0 {
            let why = std::iter::once("it has no messages".to_owned()).chain(notes);
            return Err(LogError::Damaged(why.collect::<Vec<_>>().join("; ")));
        }
        if backward > 0 {
            notes.push(format!("{backward} of {messages} messages are logged out of order"));
        }
        if unknown > 0 {
            notes.push(format!("{unknown} messages have an unknown channel: ignored"));
        }
        Ok(Bag {
            stream,
            topics,
            of_channel,
            notes,
            origin: origin.unwrap_or(0),
            cache: Mutex::default(),
        })
    }

    fn topic(&self, name: &str) -> Result<usize, LogError> {
        // Some write a topic without the slash.
        let fits = |topic: &Topic| topic.name == name || topic.name.strip_prefix('/') == Some(name);
        self.topics.iter().position(fits).ok_or_else(|| LogError::Unknown {
            what: "topic",
            name: name.to_owned(),
            known: self.topics.iter().map(|topic| topic.name.clone()).collect(),
        })
    }

    /// The topic and the path of a signal.
    fn signal(&self, name: &str) -> Result<(usize, SignalPath), LogError> {
        let unknown = || LogError::Unknown {
            what: "signal",
            name: name.to_owned(),
            known: self.topics.iter().flat_map(|topic| topic.signals.iter().cloned()).collect(),
        };
        // A topic may have dots, so the longest that fits is taken.
        let fits = |(index, topic): (usize, &Topic)| {
            let bare = topic.name.strip_prefix('/').unwrap_or(&topic.name);
            let rest =
                name.strip_prefix(topic.name.as_str()).or_else(|| name.strip_prefix(bare))?;
            Some((topic.name.len(), index, rest.strip_prefix('.')?))
        };
        let topics = self.topics.iter().enumerate();
        let (_, index, rest) = topics.filter_map(fits).max().ok_or_else(unknown)?;
        let path = self.topics[index].decoder.path(rest).ok_or_else(unknown)?;
        Ok((index, path))
    }

    /// Calls `visit` for each message of a topic; it returns whether to go on.
    fn visit(
        &self,
        topic: usize,
        mut visit: impl FnMut(&Message<'_>) -> bool,
    ) -> Result<(), LogError> {
        self.stream.read(&mut |event| match event {
            Event::Message(message) if self.of_channel.get(&message.channel) == Some(&topic) => {
                visit(&message)
            }
            _ => true,
        })?;
        Ok(())
    }

    fn time(&self, topic: usize, clock: ClockChoice, message: &Message<'_>) -> Option<i64> {
        match clock {
            ClockChoice::Log => Some(message.log),
            ClockChoice::Publish => Some(message.publish),
            // A stamp of zero is one that the sender has not set.
            ClockChoice::Header => {
                self.topics[topic].decoder.header_time(message.data).filter(|&time| time != 0)
            }
        }
    }

    /// The stamps of a topic, which are read once.
    fn stamps_of(&self, topic: usize) -> Result<Arc<Stamps>, LogError> {
        let kept = || self.cache.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, stamps)) = kept().iter().find(|(own, _)| *own == topic) {
            return Ok(stamps.clone());
        }
        let mut stamps = Stamps::default();
        self.visit(topic, |message| {
            for (clock, own) in ClockChoice::ALL.into_iter().zip(&mut stamps) {
                own.push(self.time(topic, clock, message));
            }
            stamps[0].len() < MOST
        })?;
        within_limit(stamps[0].len())?;
        let stamps = Arc::new(stamps);
        let mut cache = kept();
        cache.truncate(KEPT - 1);
        cache.insert(0, (topic, stamps.clone()));
        Ok(stamps)
    }

    fn check_clock(&self, topic: usize, clock: ClockChoice) -> Result<(), LogError> {
        let own = &self.topics[topic];
        let has = own.clocks().contains(&clock);
        let reason = match clock {
            _ if has => return Ok(()),
            ClockChoice::Header => own.decoder.why_no_header(&own.message_type),
            _ => "its publish times are its log times".to_owned(),
        };
        let clock = if clock == ClockChoice::Header { "header stamps" } else { "publish times" };
        Err(LogError::NoClock { topic: own.name.clone(), clock, reason })
    }

    /// The zero of a clock: that of the log, unless the clock counts from another epoch.
    fn zero(&self, first: i64) -> i64 {
        const DAY: u64 = 86_400_000_000_000;
        if first.abs_diff(self.origin) < DAY { self.origin } else { first }
    }
}

/// A difference in ns as seconds.
pub(crate) fn seconds_between(from: i64, to: i64) -> f64 {
    (i128::from(to) - i128::from(from)) as f64 / 1e9
}

impl<S: MessageStream> Source for Bag<S> {
    fn format(&self) -> String {
        self.stream.format()
    }

    fn signals(&self) -> Vec<SignalInfo> {
        let of = |topic: &Topic| {
            let count = topic.count;
            let info = move |name: &String| SignalInfo { name: name.clone(), count, unit: None };
            topic.signals.iter().map(info).collect::<Vec<_>>()
        };
        self.topics.iter().flat_map(of).collect()
    }

    fn topics(&self) -> Vec<TopicInfo> {
        let info = |topic: &Topic| TopicInfo {
            name: topic.name.clone(),
            message_type: topic.message_type.clone(),
            count: topic.count,
            clocks: topic.clocks(),
            span: seconds_between(topic.first, topic.last),
        };
        self.topics.iter().map(info).collect()
    }

    fn series(&self, name: &str, clock: ClockChoice) -> Result<Series, LogError> {
        let (topic, path) = self.signal(name)?;
        self.check_clock(topic, clock)?;
        let mut series = Series::default();
        let mut zero = None;
        self.visit(topic, |message| {
            let value = self.topics[topic].decoder.value(message.data, &path);
            if let (Some(time), Some(value)) = (self.time(topic, clock, message), value) {
                let zero = *zero.get_or_insert_with(|| self.zero(time));
                series.time.push(seconds_between(zero, time));
                series.values.push(value);
            }
            series.values.len() < MOST
        })?;
        within_limit(series.values.len())?;
        match series.values.is_empty() {
            true => Err(LogError::Unknown {
                what: "signal",
                name: name.to_owned(),
                known: self.topics[topic].signals.clone(),
            }),
            false => Ok(series),
        }
    }

    fn stamps(&self, topic: &str, clock: ClockChoice) -> Result<Vec<f64>, LogError> {
        let stamps = self.exact_stamps(topic, clock)?;
        let zero = stamps.iter().flatten().next().map_or(0, |&first| self.zero(first));
        Ok(stamps.into_iter().flatten().map(|time| seconds_between(zero, time)).collect())
    }

    fn exact_stamps(&self, topic: &str, clock: ClockChoice) -> Result<Vec<Option<i64>>, LogError> {
        let topic = self.topic(topic)?;
        self.check_clock(topic, clock)?;
        let stamps = self.stamps_of(topic)?;
        let index = ClockChoice::ALL.iter().position(|own| *own == clock).unwrap_or(0);
        Ok(stamps[index].clone())
    }

    fn is_bag(&self) -> bool {
        true
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

fn within_limit(count: usize) -> Result<(), LogError> {
    let limit = MOST as u64 - 1;
    match count >= MOST {
        true => Err(LogError::TooLarge { what: "number of messages", value: MOST as u64, limit }),
        false => Ok(()),
    }
}
