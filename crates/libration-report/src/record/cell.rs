//! Cells of tables.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

use crate::notation::{count, number};

/// A cell of a table. Numbers are stored as numbers and formatted by the page.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(untagged)]
pub enum Cell {
    /// A number, or its absence.
    Number(Quantity),
    /// Text, or a formula.
    Text(String),
}

/// An entry of a column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// A number with all digits, and the number of significant digits; none for that of the table.
    Real(f64, Option<usize>),
    /// A count.
    Count(u64),
    /// Intervals in rising order, and the number of digits of their ends.
    Intervals(Vec<[f64; 2]>, usize),
    /// No number, and the text in its place on the page.
    Absent(String),
}

impl Cell {
    /// A number with `digits` significant digits on the page.
    pub fn rounded(x: f64, digits: usize) -> Self {
        Cell::Number(Quantity::Real(x, Some(digits)))
    }

    /// No number, and the text in its place on the page; `null` in `results.json`.
    pub fn absent(words: impl Into<String>) -> Self {
        Cell::Number(Quantity::Absent(words.into()))
    }

    /// Intervals, as pairs of numbers.
    pub fn intervals(intervals: &[[f64; 2]], digits: usize) -> Self {
        Cell::Number(Quantity::Intervals(intervals.to_vec(), digits))
    }

    /// The number, if it is one.
    pub fn value(&self) -> Option<f64> {
        match self {
            Cell::Number(Quantity::Real(x, _)) => Some(*x),
            Cell::Number(Quantity::Count(n)) => Some(*n as f64),
            _ => None,
        }
    }

    /// The text of the cell on the page, by default with `digits` significant digits.
    pub fn typeset(&self, digits: usize) -> String {
        match self {
            Cell::Number(Quantity::Real(x, own)) => number(*x, own.unwrap_or(digits)),
            Cell::Number(Quantity::Count(n)) => count(*n),
            Cell::Number(Quantity::Intervals(intervals, _)) if intervals.is_empty() => {
                "nowhere".into()
            }
            Cell::Number(Quantity::Intervals(intervals, digits)) => {
                let one = |[from, to]: &[f64; 2]| {
                    format!("{} to {}", number(*from, *digits), number(*to, *digits))
                };
                intervals.iter().map(one).collect::<Vec<_>>().join(", ")
            }
            Cell::Number(Quantity::Absent(words)) | Cell::Text(words) => words.clone(),
        }
    }
}

impl Serialize for Quantity {
    /// Infinity and NaN are `null` in JSON.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Quantity::Real(x, _) => serializer.serialize_f64(*x),
            Quantity::Count(n) => serializer.serialize_u64(*n),
            Quantity::Intervals(intervals, _) => intervals.serialize(serializer),
            Quantity::Absent(_) => serializer.serialize_none(),
        }
    }
}

/// Digits of the ends of intervals, where a file does not say how many were shown.
const DIGITS: usize = 6;

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match Value::deserialize(deserializer)? {
            Value::Null => Quantity::Absent("—".to_owned()),
            Value::Number(number) => match (number.as_u64(), number.as_f64()) {
                (Some(count), _) => Quantity::Count(count),
                (None, Some(real)) => Quantity::Real(real, None),
                (None, None) => return Err(D::Error::custom("not a number")),
            },
            list => {
                let intervals = serde_json::from_value(list).map_err(D::Error::custom)?;
                Quantity::Intervals(intervals, DIGITS)
            }
        })
    }
}

impl From<f64> for Cell {
    fn from(x: f64) -> Self {
        Cell::Number(Quantity::Real(x, None))
    }
}

impl From<u64> for Cell {
    fn from(n: u64) -> Self {
        Cell::Number(Quantity::Count(n))
    }
}

/// A number, or a dash where there is none.
impl From<Option<f64>> for Cell {
    fn from(x: Option<f64>) -> Self {
        x.map_or_else(|| Cell::absent("—"), Cell::from)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_number_is_a_number_in_the_file_and_set_in_type_on_the_page() {
        for (cell, in_file, on_page) in [
            (Cell::from(2.5e-6), json!(2.5e-6), "2.5·10⁻⁶"),
            (Cell::rounded(1.234_56, 2), json!(1.234_56), "1.2"),
            (Cell::from(100_000), json!(100_000), "100\u{202f}000"),
            (Cell::intervals(&[[0.0, 2.0]], 3), json!([[0.0, 2.0]]), "0 to 2"),
            (Cell::intervals(&[], 3), json!([]), "nowhere"),
            (Cell::absent("overflows"), json!(null), "overflows"),
            (Cell::from(None), json!(null), "—"),
            (Cell::from("RK4"), json!("RK4"), "RK4"),
        ] {
            assert_eq!(serde_json::to_value(&cell).ok(), Some(in_file));
            assert_eq!(cell.typeset(4), on_page);
        }
    }
}
