//! Tables: named columns with units and number types.

use std::borrow::Cow;

use half::{bf16, f16};

use crate::TableError;

/// Columns of equal length, owned or borrowed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table<'a> {
    columns: Vec<Column<'a>>,
}

/// One column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column<'a> {
    /// Name, unique in the table.
    pub name: Cow<'a, str>,
    /// Unit of the values; `1` if there is none.
    pub unit: Cow<'a, str>,
    /// The values.
    pub values: Values<'a>,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values<'a> {
    /// Flags: 0 or 1.
    Bool(Cow<'a, [u8]>),
    /// Counts, as of environments.
    U32(Cow<'a, [u32]>),
    /// Counts, as of steps.
    U64(Cow<'a, [u64]>),
    /// Double precision.
    F64(Cow<'a, [f64]>),
    /// Single precision.
    F32(Cow<'a, [f32]>),
    /// IEEE half precision.
    F16(Cow<'a, [f16]>),
    /// The upper half of an `f32`. Files hold it as `f32`, which is exact.
    Bf16(Cow<'a, [bf16]>),
    /// Lists of equal length, not nested.
    Lists(usize, Box<Values<'a>>),
}

impl Values<'_> {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Values::Bool(x) => x.len(),
            Values::U32(x) => x.len(),
            Values::U64(x) => x.len(),
            Values::F64(x) => x.len(),
            Values::F32(x) => x.len(),
            Values::F16(x) => x.len(),
            Values::Bf16(x) => x.len(),
            Values::Lists(each, of) => of.len() / each.max(&1),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of a value.
    pub(crate) fn width(&self) -> usize {
        match self {
            Values::Bool(_) => 1,
            Values::F16(_) | Values::Bf16(_) => 2,
            Values::U32(_) | Values::F32(_) => 4,
            Values::U64(_) | Values::F64(_) => 8,
            Values::Lists(each, of) => each * of.width(),
        }
    }
}

impl<'a> Table<'a> {
    /// The table of these columns.
    ///
    /// # Errors
    /// [`TableError::Ragged`] if they differ in length.
    pub fn new(columns: Vec<Column<'a>>) -> Result<Self, TableError> {
        let expected = columns.first().map_or(0, |c| c.values.len());
        match columns.iter().find(|c| c.values.len() != expected) {
            Some(c) => {
                let (column, found) = (c.name.to_string(), c.values.len());
                Err(TableError::Ragged { column, expected, found })
            }
            None => Ok(Table { columns }),
        }
    }

    /// The columns, from left to right, to be taken.
    pub fn into_columns(self) -> Vec<Column<'a>> {
        self.columns
    }

    /// The columns from left to right.
    pub fn columns(&self) -> &[Column<'a>] {
        &self.columns
    }

    /// The values of the column `name`, if there is one.
    pub fn column(&self, name: &str) -> Option<&Values<'a>> {
        self.columns.iter().find(|c| c.name == name).map(|c| &c.values)
    }

    /// Bytes of all values.
    pub fn bytes(&self) -> usize {
        self.columns.iter().map(|c| c.values.len() * c.values.width()).sum()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }
}
