//! Tables: signals are columns, and one column is the time.

use crate::column::{Column, Gap, MISSING, Times, Values};
use crate::error::LogError;
use crate::read_options::ReadOptions;
use crate::signal::{ClockChoice, Series, SignalInfo, TopicInfo};
use crate::source::Source;
use crate::split_stamps;
use crate::time_unit::{is_time_name, unit_in_name, unit_name};

/// A table with a column of time.
pub(crate) struct Table {
    format: &'static str,
    columns: Vec<Column>,
    time: usize,
    notes: Vec<String>,
    /// Columns without numbers.
    ignored: Vec<String>,
    has_stamps: bool,
}

/// Smallest whole number that is taken for a clock since 1970, whatever its column is called: milliseconds.
const EPOCH: i64 = 100_000_000_000;

impl Table {
    /// A table of these columns, whose time is that of the option, else a column named as one, else the first.
    pub(crate) fn new(
        format: &'static str,
        mut columns: Vec<Column>,
        options: &ReadOptions,
        mut notes: Vec<String>,
    ) -> Result<Self, LogError> {
        if columns.is_empty() {
            return Err(LogError::Damaged("it has no column of numbers".to_owned()));
        }
        if options.time.is_none() && !split_stamps::combine_named(&mut columns) {
            split_stamps::combine_leading(&mut columns, &mut notes);
        }
        let named = columns.iter().position(|column| is_time_name(&column.name));
        let time = match &options.time {
            Some(name) => {
                position(&columns, name).ok_or_else(|| unknown("column", name, &columns))?
            }
            None => named.unwrap_or(0),
        };
        if let Some(unit) = options.time_unit {
            columns[time].per_second = Some(unit.per_second());
            // Other columns of stamps mostly have the same unit.
            for column in columns.iter_mut().filter(|column| column.unit_of_time().1) {
                column.default_per_second = Some(unit.per_second());
            }
        }
        let (rows, count) = (columns[time].rows(), columns[time].count());
        if count == 0 || count < rows / 2 {
            let first = columns[time].gap.as_ref().map_or_else(String::new, |gap| {
                format!("; the first other line is {}, `{}`", gap.line, gap.text)
            });
            return Err(LogError::Damaged(format!(
                "only {count} of {rows} lines have a number in the column `{}`, which is the time; expected a table of numbers{first}",
                columns[time].name
            )));
        }
        Ok(Table { format, columns, time, notes, ignored: Vec::new(), has_stamps: true })
    }

    /// Checks that no other column is taken for the time if that with its name has no numbers.
    pub(crate) fn check_time(
        columns: &[Column],
        empty: &[String],
        options: &ReadOptions,
    ) -> Result<(), LogError> {
        let has_time = columns.iter().any(|column| is_time_name(&column.name));
        match empty.iter().find(|name| is_time_name(name)) {
            Some(name) if options.time.is_none() && !has_time => Err(LogError::Damaged(format!(
                "the column `{name}` has no numbers; expected times as numbers or ISO 8601; help: choose another column with --time"
            ))),
            _ => Ok(()),
        }
    }

    /// The same table, with notes about columns without numbers.
    pub(crate) fn with_ignored(self, ignored: Vec<String>) -> Self {
        Table { ignored, ..self }
    }

    /// The same table, whose rows have no order in time.
    pub(crate) fn without_stamps(self) -> Self {
        Table { has_stamps: false, ..self }
    }

    /// Whether a column has time stamps, from its name or the size of its numbers.
    fn is_stamps(&self, index: usize) -> bool {
        let column = &self.columns[index];
        let is_epoch = match &column.values {
            Values::Whole(x) => {
                let mut there = x.iter().filter(|&&x| x != MISSING).peekable();
                there.peek().is_some() && there.all(|&x| x >= EPOCH)
            }
            Values::Nanoseconds(_) => true,
            // Nanoseconds with a missing value, as pandas has them.
            Values::Floats(x) => {
                let mut there = x.iter().filter(|x| x.is_finite()).peekable();
                let is_stamp = |&x: &f64| x >= EPOCH as f64 && x.fract() == 0.0 && x < 1e19;
                there.peek().is_some() && there.all(is_stamp)
            }
        };
        let is_named = is_time_name(&column.name) && unit_in_name(&column.name).is_some();
        index == self.time || is_epoch || is_named || column.per_second.is_some()
    }

    /// The time from the first to the last stamp in s.
    fn span(&self, index: usize) -> f64 {
        let times = self.columns[index].times();
        let times = times.since(&times);
        times.last().map_or(0.0, |last| last.1)
    }

    /// A note if the unit of time is a guess, and a warning if the guess leads to a rate that few loops have.
    fn guessed_unit(&self) -> Vec<String> {
        let time = &self.columns[self.time];
        let (per_second, is_guess) = time.unit_of_time();
        if !is_guess || !self.has_stamps {
            return Vec::new();
        }
        let rate = time.count().saturating_sub(1) as f64 / self.span(self.time);
        let is_rare = rate.is_finite() && !(0.1..=2e4).contains(&rate);
        let is_float = matches!(time.values, Values::Floats(_));
        let (name, unit) = (&time.name, unit_name(per_second));
        let mut notes = Vec::new();
        // Decimal seconds are the custom.
        if !is_float || per_second != 1.0 || rate < 1.0 || is_rare {
            notes.push(format!("the unit of `{name}` is assumed to be {unit}; help: --time-unit, or rename the column to `{name}_us` for µs"));
        }
        if is_rare {
            notes.push(format!(
                "warning: the rate is {rate:.4} Hz with the assumed unit {unit} of `{name}`"
            ));
        }
        notes
    }

    fn origin(&self) -> Times {
        self.columns[self.time].times()
    }
}

impl Source for Table {
    fn format(&self) -> String {
        self.format.to_owned()
    }

    fn signals(&self) -> Vec<SignalInfo> {
        let info = |column: &Column| SignalInfo {
            name: column.name.clone(),
            count: column.count(),
            unit: column.unit.clone(),
        };
        self.columns.iter().map(info).collect()
    }

    fn topics(&self) -> Vec<TopicInfo> {
        let all = if self.has_stamps { self.columns.len() } else { 0 };
        let stamps = (0..all).filter(|&i| self.is_stamps(i));
        let info = |i: usize| TopicInfo {
            name: self.columns[i].name.clone(),
            message_type: "time stamps".to_owned(),
            count: self.columns[i].count(),
            clocks: vec![ClockChoice::Log],
            span: self.span(i),
        };
        stamps.map(info).collect()
    }

    fn series(&self, name: &str, _: ClockChoice) -> Result<Series, LogError> {
        let index =
            position(&self.columns, name).ok_or_else(|| unknown("signal", name, &self.columns))?;
        let origin = self.origin();
        let mut series = Series::default();
        for (row, time) in origin.since(&origin) {
            if let Some(value) = self.columns[index].value(row) {
                series.time.push(time);
                series.values.push(value);
            }
        }
        Ok(series)
    }

    fn stamps(&self, topic: &str, _: ClockChoice) -> Result<Vec<f64>, LogError> {
        let index =
            position(&self.columns, topic).ok_or_else(|| unknown("topic", topic, &self.columns))?;
        let stamps = self.columns[index].times().since(&self.origin());
        Ok(stamps.into_iter().map(|(_, time)| time).collect())
    }

    fn exact_stamps(&self, topic: &str, _: ClockChoice) -> Result<Vec<Option<i64>>, LogError> {
        let index =
            position(&self.columns, topic).ok_or_else(|| unknown("topic", topic, &self.columns))?;
        let column = &self.columns[index];
        column.times().nanoseconds(column.rows())
    }

    fn time_gap(&self) -> Option<&Gap> {
        self.columns[self.time].gap.as_ref()
    }

    fn resolution(&self, topic: &str) -> f64 {
        position(&self.columns, topic).map_or(0.0, |index| self.columns[index].resolution())
    }

    fn is_time(&self, name: &str) -> bool {
        position(&self.columns, name) == Some(self.time)
    }

    fn time_name(&self) -> Option<String> {
        Some(self.columns[self.time].name.clone())
    }

    fn notes(&self) -> Vec<String> {
        let time = &self.columns[self.time];
        let mut notes = vec![format!("the column of time is `{}`", time.name)];
        notes.extend(self.warnings(false));
        notes.extend(self.ignored.iter().cloned());
        notes
    }

    fn warnings(&self, keeps_seconds: bool) -> Vec<String> {
        let keeps_unit = keeps_seconds && self.columns[self.time].unit_of_time().0 == 1.0;
        let mut warnings = if keeps_unit { Vec::new() } else { self.guessed_unit() };
        let time = &self.columns[self.time];
        let (rows, without) = (time.rows(), time.rows() - time.count());
        if without > 0 {
            warnings
                .push(format!("{without} of {rows} rows have no time in `{}`: ignored", time.name));
        }
        warnings.extend(self.notes.iter().cloned());
        warnings
    }
}

/// The index of a column with this name, or with this name before its unit in brackets.
fn position(columns: &[Column], name: &str) -> Option<usize> {
    let bare = |column: &Column| {
        column.unit.is_some()
            && column.name.rsplit_once(['[', '(']).is_some_and(|(b, _)| b.trim() == name)
    };
    let exact = columns.iter().position(|column| column.name == name);
    exact.or_else(|| columns.iter().position(bare))
}

fn unknown(what: &'static str, name: &str, columns: &[Column]) -> LogError {
    let known = columns.iter().map(|column| column.name.clone()).collect();
    LogError::Unknown { what, name: name.to_owned(), known }
}
