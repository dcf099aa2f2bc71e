//! Walks through the bytes of a message along its definition.

use super::Step;
use super::cursor::Cursor;
use super::definition::{Count, Definition, Field, Kind, Wire};

/// Structures within structures.
const DEEPEST: usize = 32;
/// Elements of an array that are listed.
const MOST_ELEMENTS: usize = 64;

/// Reads one message.
pub(super) struct Walker<'a> {
    definition: &'a Definition,
    cursor: Cursor<'a>,
    /// Fields that may still be visited: a hostile definition has no more work than bytes.
    budget: usize,
}

impl<'a> Walker<'a> {
    pub(super) fn new(definition: &'a Definition, wire: Wire, data: &'a [u8]) -> Option<Self> {
        let budget = data.len().saturating_mul(4).saturating_add(4096);
        Some(Walker { definition, cursor: Cursor::new(data, wire)?, budget })
    }

    /// The number at a path from the message.
    pub(super) fn value(&mut self, path: &[Step]) -> Option<f64> {
        self.value_in(0, path, 0)
    }

    fn value_in(&mut self, structure: usize, path: &[Step], depth: usize) -> Option<f64> {
        let definition = self.definition;
        let (&Step::Field(index), rest) = path.split_first()? else { return None };
        let fields = &definition.structures.get(structure)?.fields;
        for field in fields.get(..index)? {
            self.skip_field(field, depth)?;
        }
        let field = fields.get(index)?;
        let (count, rest) = (self.count(field)?, rest);
        let rest = match (field.count, rest.split_first()) {
            (Count::One, _) => rest,
            (_, Some((&Step::Element(element), rest))) if element < count => {
                self.skip_elements(field.kind, element, depth)?;
                rest
            }
            _ => return None,
        };
        match field.kind {
            Kind::Structure(id) if depth < DEEPEST => self.value_in(id, rest, depth + 1),
            kind => self.number(kind),
        }
    }

    /// Appends the names of all numbers, at most `most`; none if the message is too short.
    pub(super) fn names(&mut self, most: usize, names: &mut Vec<String>) -> Option<()> {
        self.names_in(0, "", most, names, 0)
    }

    fn names_in(
        &mut self,
        structure: usize,
        prefix: &str,
        most: usize,
        names: &mut Vec<String>,
        depth: usize,
    ) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        let definition = self.definition;
        for field in &definition.structures.get(structure)?.fields {
            self.spend(1)?;
            let count = self.count(field)?;
            let listed = count.min(MOST_ELEMENTS);
            for i in 0..listed {
                let name = match field.count {
                    Count::One => format!("{prefix}{}", field.name),
                    _ => format!("{prefix}{}[{i}]", field.name),
                };
                match field.kind {
                    Kind::Structure(id) => {
                        self.names_in(id, &format!("{name}."), most, names, depth + 1)?;
                    }
                    Kind::Text | Kind::WideText => self.skip_elements(field.kind, 1, depth)?,
                    kind => {
                        self.number(kind)?;
                        if names.len() >= most {
                            return None;
                        }
                        names.push(name);
                    }
                }
            }
            self.skip_elements(field.kind, count - listed, depth)?;
        }
        Some(())
    }

    /// The number of elements of a field, which begins here: never more than bytes are left.
    fn count(&mut self, field: &Field) -> Option<usize> {
        let count = match field.count {
            Count::One => return Some(1),
            Count::Fixed(count) => count,
            Count::Sequence => self.cursor.length()?,
        };
        (count <= self.cursor.left()).then_some(count)
    }

    fn skip_field(&mut self, field: &Field, depth: usize) -> Option<()> {
        self.spend(1)?;
        let count = self.count(field)?;
        self.skip_elements(field.kind, count, depth)
    }

    fn skip_elements(&mut self, kind: Kind, count: usize, depth: usize) -> Option<()> {
        match kind {
            _ if count == 0 => Some(()),
            Kind::Float(size) | Kind::Signed(size) | Kind::Unsigned(size) => {
                self.cursor.align(size)?;
                self.cursor.skip(size.checked_mul(count)?)
            }
            Kind::Text | Kind::WideText => {
                for _ in 0..count {
                    let length = self.cursor.length()?;
                    // How many bytes a wide character has depends on the vendor of the middleware.
                    if kind == Kind::WideText && length > 0 {
                        return None;
                    }
                    self.cursor.skip(length)?;
                }
                Some(())
            }
            Kind::Structure(_) if depth >= DEEPEST => None,
            Kind::Structure(id) => {
                let definition = self.definition;
                for _ in 0..count {
                    self.spend(1)?;
                    for field in &definition.structures.get(id)?.fields {
                        self.skip_field(field, depth + 1)?;
                    }
                }
                Some(())
            }
        }
    }

    fn number(&mut self, kind: Kind) -> Option<f64> {
        let bits = |own: &mut Self, size| own.cursor.bits(size);
        Some(match kind {
            Kind::Float(4) => f64::from(f32::from_bits(bits(self, 4)? as u32)),
            Kind::Float(_) => f64::from_bits(bits(self, 8)?),
            Kind::Unsigned(size) => bits(self, size)? as f64,
            Kind::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                ((bits(self, size)? << unused) as i64 >> unused) as f64
            }
            Kind::Text | Kind::WideText | Kind::Structure(_) => return None,
        })
    }

    fn spend(&mut self, work: usize) -> Option<()> {
        self.budget = self.budget.checked_sub(work)?;
        Some(())
    }
}
