//! Definitions of messages in OMG IDL, as `ros2idl` has them.
//!
//! The part of IDL 4.2 that `rosidl` writes: modules, structures, typedefs of arrays, sequences, constants and annotations.

use std::collections::HashMap;

use super::definition::{Count, Definition, Field, Kind, Structure, primitive, short};

/// Most words of a definition.
const MOST: usize = 1 << 18;
/// Typedefs of typedefs.
const DEEPEST: usize = 16;

/// A field before the names of types are known.
struct Raw {
    name: String,
    kind: String,
    count: Count,
}

/// The definition of the message `root` in a text.
pub(super) fn parse(root: &str, text: &str) -> Result<Definition, String> {
    let words = words(text)?;
    let mut parser = Parser {
        words: &words,
        at: 0,
        modules: Vec::new(),
        structures: HashMap::new(),
        typedefs: HashMap::new(),
    };
    parser.read()?;
    let Parser { structures, typedefs, .. } = parser;
    let mut definition = Definition::default();
    let mut next = vec![short(root)];
    while let Some(name) = next.get(definition.structures.len()).cloned() {
        let raw = structures
            .get(&name)
            .ok_or_else(|| format!("its definition lacks the type `{name}`"))?;
        let mut fields = Vec::new();
        for field in raw {
            let (mut kind, mut count) = (field.kind.clone(), field.count);
            for _ in 0..DEEPEST {
                let Some((to, many)) = typedefs.get(&kind) else { break };
                kind = to.clone();
                count = if *many == Count::One { count } else { *many };
            }
            let kind = match primitive(&kind) {
                Some(kind) => kind,
                None => Kind::Structure(
                    next.iter().position(|known| *known == kind).unwrap_or_else(|| {
                        next.push(kind);
                        next.len() - 1
                    }),
                ),
            };
            fields.push(Field { name: field.name.clone(), kind, count });
        }
        definition.structures.push(Structure { name, fields });
    }
    Ok(definition)
}

/// The words and signs of a text, without comments, annotations' texts and directives.
fn words(text: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = match first {
            _ if rest.starts_with("//")
                || first == '#'
                || rest.starts_with("====")
                || rest.starts_with("IDL:") =>
            {
                rest.find('\n').unwrap_or(rest.len())
            }
            _ if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |at| at + 2),
            '"' => rest[1..].find('"').map_or(rest.len(), |at| at + 2),
            c if c.is_alphanumeric() || c == '_' || c == ':' => {
                let end =
                    rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':' || c == '.'));
                let end = end.unwrap_or(rest.len());
                words.push(rest[..end].to_owned());
                end
            }
            c => {
                if !c.is_whitespace() {
                    words.push(c.to_string());
                }
                c.len_utf8()
            }
        };
        rest = &rest[length.max(1)..];
        if words.len() > MOST {
            return Err(format!("its definition has more than {MOST} words"));
        }
    }
    Ok(words)
}

struct Parser<'a> {
    words: &'a [String],
    at: usize,
    modules: Vec<String>,
    structures: HashMap<String, Vec<Raw>>,
    typedefs: HashMap<String, (String, Count)>,
}

impl Parser<'_> {
    fn next(&mut self) -> Option<&str> {
        let word = self.words.get(self.at)?;
        self.at += 1;
        Some(word)
    }

    fn peek(&self) -> &str {
        self.words.get(self.at).map_or("", String::as_str)
    }

    fn read(&mut self) -> Result<(), String> {
        while let Some(word) = self.next() {
            match word {
                "module" => {
                    let name = self.next().unwrap_or_default().to_owned();
                    self.modules.push(name);
                    self.next();
                }
                "}" => {
                    self.modules.pop();
                }
                "struct" => self.structure()?,
                "typedef" => {
                    let raw = self.declaration()?;
                    let name = self.scoped(&raw.name);
                    self.typedefs.insert(name, (raw.kind, raw.count));
                }
                "const" | "enum" | "union" => self.skip_to_semicolon(),
                "@" => self.annotation(),
                _ => {}
            }
        }
        Ok(())
    }

    fn structure(&mut self) -> Result<(), String> {
        let name = self.next().unwrap_or_default().to_owned();
        self.next();
        let mut fields = Vec::new();
        while !matches!(self.peek(), "}" | "") {
            if self.peek() == "@" {
                self.next();
                self.annotation();
                continue;
            }
            fields.push(self.declaration()?);
        }
        self.next();
        self.structures.insert(self.scoped(&name), fields);
        Ok(())
    }

    /// A type, a name and a number of elements, up to the semicolon.
    fn declaration(&mut self) -> Result<Raw, String> {
        let (kind, sequence) = self.kind();
        let name = self.next().unwrap_or_default().to_owned();
        let mut count = if sequence { Count::Sequence } else { Count::One };
        while self.peek() == "[" {
            self.next();
            let number = self.next().unwrap_or_default();
            let number =
                number.parse().map_err(|_| format!("field `{name}` has `{number}` elements"))?;
            if count != Count::One {
                return Err(format!("field `{name}` is an array of arrays"));
            }
            count = Count::Fixed(number);
            self.next();
        }
        if self.peek() != ";" {
            return Err(format!("field `{name}` has no semicolon behind it"));
        }
        self.next();
        Ok(Raw { name, kind, count })
    }

    /// A type, and whether it is a sequence of these.
    fn kind(&mut self) -> (String, bool) {
        let mut word = self.next().unwrap_or_default().to_owned();
        let sequence = word == "sequence";
        if sequence {
            self.next();
            word = self.next().unwrap_or_default().to_owned();
        }
        let kind = match word.as_str() {
            "unsigned" => {
                match (self.next().unwrap_or_default().to_owned().as_str(), self.peek()) {
                    ("long", "long") => {
                        self.next();
                        "uint64".to_owned()
                    }
                    ("long", _) => "uint32".to_owned(),
                    _ => "uint16".to_owned(),
                }
            }
            "long" if self.peek() == "long" => {
                self.next();
                "int64".to_owned()
            }
            name if primitive(name).is_some() => word,
            name if name.contains("::") => short(name),
            name => self.scoped(name),
        };
        // The bound of a string or a sequence.
        let mut open = usize::from(sequence);
        loop {
            match self.peek() {
                "<" => open += 1,
                ">" => open = open.saturating_sub(1),
                _ if open > 0 && self.at < self.words.len() => {}
                _ => break,
            }
            self.next();
        }
        (kind, sequence)
    }

    fn scoped(&self, name: &str) -> String {
        let modules = self.modules.iter().map(String::as_str).chain([name]);
        short(&modules.collect::<Vec<_>>().join("/"))
    }

    fn annotation(&mut self) {
        self.next();
        if self.peek() != "(" {
            return;
        }
        let mut open = 0_usize;
        while let Some(word) = self.next() {
            match word {
                "(" => open += 1,
                ")" => open -= 1,
                _ => {}
            }
            if open == 0 {
                return;
            }
        }
    }

    fn skip_to_semicolon(&mut self) {
        while self.next().is_some_and(|word| word != ";") {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::Step;
    use super::*;

    #[test]
    fn what_rosidl_writes_is_parsed() {
        let text = r#"
// generated
#include "builtin_interfaces/msg/Time.idl"
module p {
  module msg {
    typedef double double__9[9];
    module Root_Constants { const uint8 OK = 0; };
    @verbatim (language="comment", text="a ; } b")
    struct Root {
      @default (value=TRUE)
      boolean on;
      builtin_interfaces::msg::Time stamp;
      double__9 matrix;
      sequence<unsigned long long, 4> many;
      string<8> s;
    };
  };
};
================================================================================
IDL: builtin_interfaces/msg/Time
module builtin_interfaces { module msg { struct Time { int32 sec; uint32 nanosec; }; }; };
"#;
        let found = parse("p/msg/Root", text).unwrap();
        let fields: Vec<_> =
            found.structures[0].fields.iter().map(|f| (f.name.as_str(), f.kind, f.count)).collect();
        assert_eq!(
            fields,
            [
                ("on", Kind::Unsigned(1), Count::One),
                ("stamp", Kind::Structure(1), Count::One),
                ("matrix", Kind::Float(8), Count::Fixed(9)),
                ("many", Kind::Unsigned(8), Count::Sequence),
                ("s", Kind::Text, Count::One),
            ]
        );
        assert_eq!(found.path("matrix[8]"), Some(vec![Step::Field(2), Step::Element(8)]));
    }
}
