//! Definitions of messages as text.
//!
//! The text is that of *.msg files (<https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html>), each behind a line of
//! equals signs and `MSG: package/Type`.

use std::collections::HashMap;

use super::Step;

/// How a message is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wire {
    /// CDR: numbers are aligned, as in ROS 2.
    Cdr,
    /// Little-endian without gaps, as in ROS 1.
    Packed,
}

/// The structures of a message; the first is the message.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Definition {
    pub(super) structures: Vec<Structure>,
}

/// A structure.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Structure {
    /// The name: `package/Type`.
    pub(super) name: String,
    pub(super) fields: Vec<Field>,
}

/// A field.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) count: Count,
}

/// What a field consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
    Text,
    WideText,
    Structure(usize),
}

/// How many elements a field has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    Sequence,
}

/// Most structures of a message.
const MOST: usize = 1000;
const TIME: &str = "builtin_interfaces/Time";

/// The kind of a basic type.
pub(super) fn primitive(name: &str) -> Option<Kind> {
    Some(match name {
        "bool" | "byte" | "uint8" | "char" | "octet" | "boolean" => Kind::Unsigned(1),
        "int8" => Kind::Signed(1),
        "uint16" | "wchar" => Kind::Unsigned(2),
        "int16" | "short" => Kind::Signed(2),
        "uint32" => Kind::Unsigned(4),
        "int32" | "long" => Kind::Signed(4),
        "uint64" => Kind::Unsigned(8),
        "int64" => Kind::Signed(8),
        "float32" | "float" => Kind::Float(4),
        "float64" | "double" => Kind::Float(8),
        "string" => Kind::Text,
        "wstring" => Kind::WideText,
        _ => return None,
    })
}

/// The definition of the message `root` in a text.
pub(super) fn parse(root: &str, text: &str) -> Result<Definition, String> {
    let root = short(root);
    let mut texts: HashMap<String, Vec<&str>> = HashMap::new();
    let mut current = root.clone();
    for line in text.lines() {
        let line = line.trim();
        if let Some(name) = line.strip_prefix("MSG:") {
            current = short(name.trim());
        } else if line.len() < 20 || !line.bytes().all(|byte| byte == b'=') {
            texts.entry(current.clone()).or_default().push(line);
        }
        if texts.len() > MOST {
            return Err(format!("its definition has more than {MOST} types"));
        }
    }
    let mut definition = Definition::default();
    let mut index: HashMap<String, usize> = HashMap::new();
    let mut next = vec![root];
    index.insert(next[0].clone(), 0);
    while let Some(name) = next.get(definition.structures.len()).cloned() {
        let lines = texts.get(&name).cloned().unwrap_or_else(|| built_in(&name));
        if lines.is_empty() && !texts.contains_key(&name) {
            return Err(format!("its definition lacks the type `{name}`"));
        }
        let mut fields = Vec::new();
        for line in lines {
            let Some((kind, count, field)) = declaration(line)? else { continue };
            let kind = match primitive(kind) {
                Some(kind) => kind,
                None => {
                    let full = full_name(kind, &name, &texts);
                    let id = *index.entry(full.clone()).or_insert_with(|| {
                        next.push(full);
                        next.len() - 1
                    });
                    Kind::Structure(id)
                }
            };
            fields.push(Field { name: field.to_owned(), kind, count });
        }
        definition.structures.push(Structure { name, fields });
    }
    Ok(definition)
}

/// `package/Type` of `package/msg/Type` and `package::msg::Type`.
pub(super) fn short(name: &str) -> String {
    let name = name.replace("::", "/");
    match name.split('/').collect::<Vec<_>>().as_slice() {
        [package, "msg" | "srv" | "action", rest] => format!("{package}/{rest}"),
        _ => name,
    }
}

/// Types that every ROS has, and some definitions leave out.
fn built_in(name: &str) -> Vec<&'static str> {
    match name {
        TIME | "builtin_interfaces/Duration" => vec!["int32 sec", "uint32 nanosec"],
        // Those of ROS 1 are unsigned.
        "time" => vec!["uint32 sec", "uint32 nsec"],
        "duration" => vec!["int32 sec", "int32 nsec"],
        "std_msgs/Header" => vec!["builtin_interfaces/Time stamp", "string frame_id"],
        _ => Vec::new(),
    }
}

/// The full name of a type that the structure `within` mentions.
fn full_name(name: &str, within: &str, texts: &HashMap<String, Vec<&str>>) -> String {
    match name {
        "Header" => return "std_msgs/Header".to_owned(),
        "time" | "duration" => return name.to_owned(),
        _ => {}
    }
    if name.contains(['/', ':']) {
        return short(name);
    }
    let package = within.split('/').next().unwrap_or_default();
    let full = format!("{package}/{name}");
    let elsewhere = || texts.keys().find(|known| known.rsplit('/').next() == Some(name)).cloned();
    if texts.contains_key(&full) { full } else { elsewhere().unwrap_or(full) }
}

/// Type, number and name of a field; none in a line without one.
fn declaration(line: &str) -> Result<Option<(&str, Count, &str)>, String> {
    let bare = line.split('#').next().unwrap_or_default();
    let mut words = bare.split_whitespace();
    let (Some(kind), Some(name)) = (words.next(), words.next()) else { return Ok(None) };
    // A constant has an equals sign behind its name, a default value has none.
    let behind = words.next().unwrap_or_default();
    if name.contains('=') || behind.starts_with('=') || kind.starts_with('@') {
        return Ok(None);
    }
    let (kind, count) = match kind.split_once('[') {
        None => (kind, Count::One),
        Some((kind, inner)) => {
            let inner = inner.strip_suffix(']').ok_or_else(|| format!("`{line}` is no field"))?;
            let count = match inner {
                "" => Count::Sequence,
                bounded if bounded.starts_with("<=") => Count::Sequence,
                fixed => Count::Fixed(fixed.parse().map_err(|_| format!("`{line}` is no field"))?),
            };
            (kind, count)
        }
    };
    // Strings may be bounded: `string<=8`.
    Ok(Some((kind.split("<=").next().unwrap_or(kind), count, name)))
}

impl Definition {
    /// The steps of a name.
    pub(super) fn path(&self, name: &str) -> Option<Vec<Step>> {
        let mut steps = Vec::new();
        let mut structure = Some(0);
        for part in name.split('.') {
            let (field, element) = match part.split_once('[') {
                Some((field, rest)) => (field, Some(rest.strip_suffix(']')?.parse().ok()?)),
                None => (part, None),
            };
            let fields = &self.structures.get(structure?)?.fields;
            let index = fields.iter().position(|own| own.name == field)?;
            steps.push(Step::Field(index));
            match (fields[index].count, element) {
                (Count::One, None) => {}
                (Count::Fixed(_) | Count::Sequence, Some(element)) => {
                    steps.push(Step::Element(element));
                }
                _ => return None,
            }
            structure = match fields[index].kind {
                Kind::Structure(id) => Some(id),
                Kind::Text | Kind::WideText => return None,
                _ => None,
            };
        }
        structure.is_none().then_some(steps)
    }

    /// The steps to the time with which a message begins, or to that of the header with which it begins.
    pub(super) fn header_stamp(&self) -> Option<Vec<Step>> {
        let first = self.structures.first()?.fields.first()?;
        let (Kind::Structure(id), Count::One) = (first.kind, first.count) else { return None };
        let within = self.structures.get(id)?;
        match within.name.as_str() {
            TIME | "time" => Some(vec![Step::Field(0)]),
            "std_msgs/Header" => {
                let stamp = within.fields.iter().position(|field| field.name == "stamp")?;
                Some(vec![Step::Field(0), Step::Field(stamp)])
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_with_constants_defaults_and_bounds_is_parsed() {
        let text = "uint8 OK=0\nstring NAME = \"a # b\"\nHeader header\nint32 x 5 # five\nstring<=8[<=3] s\nPair[2] p\n\
                    ====================\nMSG: p/Pair\nfloat64 a";
        let found = parse("p/msg/Root", text).unwrap();
        let names: Vec<_> =
            found.structures.iter().map(|structure| structure.name.as_str()).collect();
        assert_eq!(names, ["p/Root", "std_msgs/Header", "p/Pair", TIME]);
        let fields: Vec<_> =
            found.structures[0].fields.iter().map(|f| (f.name.as_str(), f.kind, f.count)).collect();
        assert_eq!(
            fields,
            [
                ("header", Kind::Structure(1), Count::One),
                ("x", Kind::Signed(4), Count::One),
                ("s", Kind::Text, Count::Sequence),
                ("p", Kind::Structure(2), Count::Fixed(2)),
            ]
        );
        assert_eq!(
            found.path("p[1].a"),
            Some(vec![Step::Field(3), Step::Element(1), Step::Field(0)])
        );
        assert_eq!(found.path("p.a"), None);
        assert_eq!(found.header_stamp(), Some(vec![Step::Field(0), Step::Field(0)]));
    }

    #[test]
    fn a_type_that_is_missing_is_named() {
        assert!(parse("p/Root", "Other x").unwrap_err().contains("`p/Other`"));
    }
}
