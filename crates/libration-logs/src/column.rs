//! Columns of tables, whose whole numbers keep all digits.

use crate::error::LogError;
use crate::time_unit::{unit_by_magnitude, unit_in_name};

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    /// Whole numbers. [`MISSING`] is none.
    Whole(Vec<i64>),
    /// Decimal seconds since 1970, as nanoseconds. [`MISSING`] is none.
    Nanoseconds(Vec<i64>),
    /// Other numbers. A value with the bits of [`missing`] is none.
    Floats(Vec<f64>),
}

/// No whole number.
pub(crate) const MISSING: i64 = i64::MIN;

/// No number: not the `NaN` that a program computes or reads.
pub(crate) fn missing() -> f64 {
    f64::from_bits(0x7ff8_0000_0000_6d69)
}

pub(crate) fn is_missing(value: f64) -> bool {
    value.to_bits() == missing().to_bits()
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) unit: Option<String>,
    /// The number of units of time per second, if the file has it.
    pub(crate) per_second: Option<f64>,
    /// The number of units of time per second, if neither the file nor the name has it.
    pub(crate) default_per_second: Option<f64>,
    pub(crate) values: Values,
    /// The first line of a text without a finite value.
    pub(crate) gap: Option<Gap>,
}

/// A line of a text without a finite value of a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gap {
    /// The number of the line, from 1.
    pub(crate) line: usize,
    /// The beginning of the line.
    pub(crate) text: String,
}

/// Times, each with the number of its row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Times {
    /// In ns.
    Exact(Vec<(usize, i64)>),
    /// In units of which there are so many per second: a difference before the division has one rounding less.
    Floats(Vec<(usize, f64)>, f64),
}

impl Column {
    pub(crate) fn new(name: String, values: Values) -> Self {
        Column {
            unit: unit_in_brackets(&name),
            per_second: None,
            default_per_second: None,
            name,
            values,
            gap: None,
        }
    }

    /// The number of rows.
    pub(crate) fn rows(&self) -> usize {
        match &self.values {
            Values::Whole(x) | Values::Nanoseconds(x) => x.len(),
            Values::Floats(x) => x.len(),
        }
    }

    /// The number of values.
    pub(crate) fn count(&self) -> usize {
        match &self.values {
            Values::Whole(x) | Values::Nanoseconds(x) => {
                x.iter().filter(|&&x| x != MISSING).count()
            }
            Values::Floats(x) => x.iter().filter(|&&x| !is_missing(x)).count(),
        }
    }

    /// The value of a row.
    pub(crate) fn value(&self, row: usize) -> Option<f64> {
        match &self.values {
            Values::Whole(x) => x.get(row).filter(|&&x| x != MISSING).map(|&x| x as f64),
            Values::Nanoseconds(x) => {
                x.get(row).filter(|&&x| x != MISSING).map(|&x| x as f64 / 1e9)
            }
            Values::Floats(x) => x.get(row).copied().filter(|&x| !is_missing(x)),
        }
    }

    /// The column as times. Values that are not finite are none.
    pub(crate) fn times(&self) -> Times {
        match &self.values {
            Values::Whole(x) => {
                let there = || x.iter().copied().enumerate().filter(|&(_, x)| x != MISSING);
                let per_second = self.unit_of_time().0;
                let scale = 1e9 / per_second;
                let nanoseconds = scale.round() as i64;
                // A minute is a whole number of nanoseconds but for a rounding; a femtosecond is none.
                let is_whole = (scale - scale.round()).abs() < 1e-9 * scale;
                let product = |(row, x): (usize, i64)| Some((row, x.checked_mul(nanoseconds)?));
                let exact = is_whole.then(|| there().map(product).collect::<Option<Vec<_>>>());
                exact.flatten().map_or_else(
                    || {
                        let floats = there().map(|(row, x)| (row, x as f64)).collect();
                        Times::Floats(floats, per_second)
                    },
                    Times::Exact,
                )
            }
            Values::Nanoseconds(x) => {
                // The decimals of another unit than seconds have been scaled as if they were seconds.
                let per_second = self.unit_of_time().0;
                let scaled = |x: i64| {
                    if per_second == 1.0 { x } else { (x as f64 / per_second).round() as i64 }
                };
                let there = x.iter().copied().enumerate().filter(|&(_, x)| x != MISSING);
                Times::Exact(there.map(|(row, x)| (row, scaled(x))).collect())
            }
            Values::Floats(x) => {
                let there = x.iter().copied().enumerate().filter(|&(_, x)| x.is_finite());
                Times::Floats(there.collect(), self.unit_of_time().0)
            }
        }
    }

    /// The distance of neighbouring numbers of floating point at the largest value, as a time in s; 0 of whole numbers.
    pub(crate) fn resolution(&self) -> f64 {
        let spacing = |largest: f64| largest.next_up() - largest;
        match &self.values {
            Values::Whole(_) => 0.0,
            Values::Floats(x) => {
                let finite = x.iter().filter(|x| x.is_finite());
                spacing(finite.fold(0.0, |most: f64, x| most.max(x.abs()))) / self.unit_of_time().0
            }
            // The shortest text of an `f64` since 1970 has at most seven decimals.
            Values::Nanoseconds(x) => {
                let there = || x.iter().filter(|&&x| x != MISSING);
                match there().all(|x| x % 100 == 0) {
                    true => spacing(there().copied().max().unwrap_or(0) as f64 / 1e9),
                    false => 0.0,
                }
            }
        }
    }

    /// The number of units of time per second, of the file, of the name, else by the size of the values; and whether it is a guess.
    pub(crate) fn unit_of_time(&self) -> (f64, bool) {
        if let Some(known) =
            self.per_second.or_else(|| unit_in_name(&self.name)).or(self.default_per_second)
        {
            return (known, false);
        }
        let ends = |values: &mut dyn DoubleEndedIterator<Item = f64>| {
            let first = values.next().unwrap_or(0.0);
            (first, values.next_back().unwrap_or(first))
        };
        let (first, last) = match &self.values {
            Values::Whole(x) => ends(&mut x.iter().filter(|&&x| x != MISSING).map(|&x| x as f64)),
            // Only seconds since 1970 are kept so.
            Values::Nanoseconds(_) => return (1.0, false),
            Values::Floats(x) => ends(&mut x.iter().copied().filter(|x| x.is_finite())),
        };
        unit_by_magnitude(first, last, self.count())
    }
}

impl Times {
    /// The times in s from the first one of `origin`, each with its row.
    pub(crate) fn since(&self, origin: &Times) -> Vec<(usize, f64)> {
        match (self, origin) {
            (Times::Exact(own), Times::Exact(origin)) => {
                let zero = i128::from(origin.first().map_or(0, |first| first.1));
                own.iter().map(|&(row, x)| (row, (i128::from(x) - zero) as f64 / 1e9)).collect()
            }
            (Times::Floats(own, per_second), Times::Floats(origin, other))
                if per_second == other =>
            {
                let zero = origin.first().map_or(0.0, |first| first.1);
                own.iter().map(|&(row, x)| (row, (x - zero) / per_second)).collect()
            }
            (own, origin) => {
                let zero = origin.seconds().next().map_or(0.0, |first| first.1);
                own.seconds().map(|(row, x)| (row, x - zero)).collect()
            }
        }
    }

    /// The times of so many rows in ns, rounded if the file has decimals.
    ///
    /// # Errors
    /// If a time is too large for nanoseconds in 64 bits.
    pub(crate) fn nanoseconds(&self, rows: usize) -> Result<Vec<Option<i64>>, LogError> {
        let mut all = vec![None; rows];
        match self {
            Times::Exact(own) => own.iter().for_each(|&(row, x)| all[row] = Some(x)),
            Times::Floats(own, per_second) => {
                for &(row, x) in own {
                    let nanoseconds = (x * (1e9 / per_second)).round();
                    // A conversion to an integer would saturate.
                    if nanoseconds.abs() >= i64::MAX as f64 {
                        return Err(LogError::Damaged(format!(
                            "the time stamp {x:e} is {:e} s; expected less than 292 years; help: the column has another unit, or is no time",
                            x / per_second
                        )));
                    }
                    all[row] = Some(nanoseconds as i64);
                }
            }
        }
        Ok(all)
    }

    fn seconds(&self) -> Box<dyn Iterator<Item = (usize, f64)> + '_> {
        match self {
            Times::Exact(x) => Box::new(x.iter().map(|&(row, x)| (row, x as f64 / 1e9))),
            Times::Floats(x, per_second) => {
                Box::new(x.iter().map(move |&(row, x)| (row, x / per_second)))
            }
        }
    }
}

/// The text in brackets at the end of a name: `x [m]` or `x (m)`.
fn unit_in_brackets(name: &str) -> Option<String> {
    let name = name.trim();
    let inner = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    let inner = inner.or_else(|| name.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')));
    let (before, unit) = inner?;
    // `x[3]` is an element.
    let is_unit = !before.is_empty() && !unit.is_empty() && unit.parse::<usize>().is_err();
    is_unit.then(|| unit.trim().to_owned())
}
