//! Messages of ROS 1 and ROS 2: definitions as text, and numbers in the bytes.

mod common_types;
mod cursor;
mod definition;
mod idl;
mod walker;

pub(crate) use definition::{Definition, Wire};
use walker::Walker;

/// A step to a number: a field, or an element of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Field(usize),
    Element(usize),
}

/// Decodes messages of one type.
pub(crate) struct RosDecoder {
    definition: Definition,
    wire: Wire,
    stamp: Option<Stamp>,
}

/// Where a message has the time at which it was made.
enum Stamp {
    /// A structure of seconds and nanoseconds.
    Seconds(Vec<Step>),
    /// A number of microseconds.
    Microseconds(Vec<Step>),
}

impl RosDecoder {
    /// A decoder for the text of a definition (`ros1msg`, `ros2msg`).
    ///
    /// # Errors
    /// In words, if the text cannot be understood.
    pub(crate) fn of_text(root: &str, text: &str, wire: Wire) -> Result<Self, String> {
        Ok(Self::new(definition::parse(root, text)?, wire))
    }

    /// A decoder for a definition in OMG IDL (`ros2idl`).
    ///
    /// # Errors
    /// In words, if the text cannot be understood.
    pub(crate) fn of_idl(root: &str, text: &str) -> Result<Self, String> {
        Ok(Self::new(idl::parse(root, text)?, Wire::Cdr))
    }

    /// A decoder for a type of a common package of ROS 2 without a definition, perhaps only of its header; none if it is not known.
    pub(crate) fn of_common_type(root: &str) -> Option<Self> {
        let text = common_types::definition(root)?;
        Self::of_text(root, text, Wire::Cdr).ok()
    }

    fn new(definition: Definition, wire: Wire) -> Self {
        let stamp = definition.header_stamp().map(Stamp::Seconds);
        RosDecoder { definition, wire, stamp }
    }

    /// The same decoder with a field of microseconds as the time of a message, if it has the field.
    pub(crate) fn with_microseconds(mut self, field: &str) -> Self {
        self.stamp = self.definition.path(field).map(Stamp::Microseconds);
        self
    }

    /// The names of the numbers in a message, at most `most`.
    pub(crate) fn signals(&self, data: &[u8], most: usize) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(mut walker) = Walker::new(&self.definition, self.wire, data) {
            // The names up to the end of a truncated message are kept.
            let _ = walker.names(most, &mut names);
        }
        names
    }

    /// The steps of a name such as `twist.linear.x` or `position[3]`.
    pub(crate) fn path(&self, name: &str) -> Option<Vec<Step>> {
        self.definition.path(name)
    }

    /// The number at a path.
    pub(crate) fn value(&self, data: &[u8], path: &[Step]) -> Option<f64> {
        Walker::new(&self.definition, self.wire, data)?.value(path)
    }

    /// The time in ns of a message that begins with a header or a time, or has the field of microseconds.
    pub(crate) fn header_time(&self, data: &[u8]) -> Option<i64> {
        let mut path = match self.stamp.as_ref()? {
            Stamp::Seconds(path) => path.clone(),
            Stamp::Microseconds(path) => {
                return (self.value(data, path)? as i64).checked_mul(1000);
            }
        };
        let mut part = |index: usize| {
            path.push(Step::Field(index));
            let value = Walker::new(&self.definition, self.wire, data)?.value(&path);
            path.pop();
            // Both are 32-bit integers, which f64 holds.
            value.map(|value| value as i64)
        };
        let (seconds, nanoseconds) = (part(0)?, part(1)?);
        seconds.checked_mul(1_000_000_000)?.checked_add(nanoseconds)
    }
}
