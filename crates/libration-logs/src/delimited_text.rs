//! CSV, TSV and other tables in text.

use std::io::BufRead;

use crate::column::Column;
use crate::column_builder::{ColumnBuilder, number};
use crate::error::LogError;
use crate::input::Input;
use crate::read_options::ReadOptions;
use crate::table::Table;
use crate::text_encoding;
use crate::text_line::TextLines;
use crate::time_unit::{is_time_name, is_unit};

/// Largest number of cells in memory: 2 GiB of numbers.
const MOST_CELLS: u64 = 1 << 28;

/// Lines that determine the delimiter.
const LINES: usize = 8;

/// Reads a table in text.
pub(crate) fn open(input: &Input, options: &ReadOptions) -> Result<Table, LogError> {
    let Text { columns, notes, empty } = read(text_encoding::reader(input)?)?;
    Table::check_time(&columns, &empty, options)?;
    Table::new("text", columns, options, notes)
}

/// A text.
struct Text {
    /// The columns of numbers.
    columns: Vec<Column>,
    /// Remarks.
    notes: Vec<String>,
    /// The names of the columns without numbers.
    empty: Vec<String>,
}

/// The columns of a text.
///
/// Empty lines and those that begin with `#` are ignored. The first other line may have names; else the last line with `#` in front of
/// the numbers has them, if it has as many.
fn read(input: impl BufRead) -> Result<Text, LogError> {
    let mut lines = TextLines::new(input);
    let mut line = String::new();
    let mut comment = String::new();
    let mut table: Option<Rows> = None;
    let mut first_lines = Vec::new();
    while lines.read(&mut line)? {
        let is_first = lines.number == 1;
        let text = if is_first { line.trim_start_matches('\u{feff}') } else { &line };
        if text.trim().is_empty() {
            continue;
        }
        if let Some(rest) = text.trim_start().strip_prefix('#') {
            if table.is_none() && first_lines.is_empty() {
                comment = rest.trim().to_owned();
            }
            continue;
        }
        match &mut table {
            Some(rows) => rows.push(lines.number, text)?,
            None if first_lines.len() + 1 < LINES => {
                first_lines.push((lines.number, text.to_owned()));
            }
            None => {
                first_lines.push((lines.number, text.to_owned()));
                table = Rows::begin(&first_lines, &comment)?;
            }
        }
    }
    if table.is_none() {
        table = Rows::begin(&first_lines, &comment)?;
    }
    let rows = table.ok_or_else(|| LogError::Damaged("it has no line of numbers".to_owned()))?;
    let mut text = rows.into_columns();
    if lines.latin_1 > 0 {
        let count = lines.latin_1;
        text.notes
            .push(format!("lines that are not UTF-8 are read as Latin-1 or Windows-1252: {count}"));
    }
    Ok(text)
}

/// The rows of a table while they are read.
struct Rows {
    delimiter: Option<char>,
    names: Vec<String>,
    values: Vec<ColumnBuilder>,
    rows: usize,
    /// Number of rows with another number of cells.
    ragged: usize,
    /// Whether the next line may have units of the names.
    is_below_names: bool,
}

impl Rows {
    /// Begins with the first lines that are no comments; none without lines.
    fn begin(lines: &[(usize, String)], comment: &str) -> Result<Option<Self>, LogError> {
        let Some(((line, text), others)) = lines.split_first() else { return Ok(None) };
        let delimiter = delimiter(lines);
        let cells = cells(text, delimiter);
        let is_number =
            |cell: &&str| number(cell).is_some() || with_decimal_point(cell, delimiter).is_some();
        let is_header = !cells.iter().any(is_number) && number(first_word(cells[0])).is_none();
        let comment = self::cells(comment, delimiter);
        let names: Vec<String> = match (is_header, comment.len() == cells.len()) {
            (true, _) => cells.iter().map(|cell| name(cell)).collect(),
            (false, true) if comment.iter().all(|cell| number(cell).is_none()) => {
                comment.iter().map(|cell| name(cell)).collect()
            }
            _ => (1..=cells.len()).map(|i| format!("column_{i}")).collect(),
        };
        let values = names.iter().map(|_| ColumnBuilder::default()).collect();
        let mut rows = Rows { delimiter, names, values, rows: 0, ragged: 0, is_below_names: false };
        if !is_header {
            rows.push(*line, text)?;
        } else if is_damaged_number(cells[0]) {
            rows.values[0].note_gap(*line, text);
        }
        rows.is_below_names = is_header;
        others.iter().try_for_each(|(line, text)| rows.push(*line, text))?;
        Ok(Some(rows))
    }

    fn push(&mut self, line: usize, text: &str) -> Result<(), LogError> {
        let cells = cells(text, self.delimiter);
        if std::mem::take(&mut self.is_below_names) && is_units(&self.names, &cells) {
            for (name, unit) in
                self.names.iter_mut().zip(&cells).filter(|(_, unit)| !unit.is_empty())
            {
                *name = format!("{name} [{}]", unit.trim_matches(['[', ']', '(', ')']));
            }
            return Ok(());
        }
        self.ragged += usize::from(cells.len() != self.values.len());
        let is_empty = cells.iter().all(|cell| cell.is_empty());
        for (i, column) in self.values.iter_mut().enumerate() {
            let cell = cells.get(i).map_or("", |cell| cell);
            let is_value = match with_decimal_point(cell, self.delimiter) {
                Some(cell) => column.push(&cell),
                // A line of a log begins with its time.
                None if i == 0 && number(first_word(cell)).is_some() => {
                    column.push(first_word(cell))
                }
                None => column.push(cell),
            };
            if !is_value && !is_empty {
                column.note_gap(line, text);
            }
        }
        self.rows += 1;
        let value = self.rows as u64 * self.values.len() as u64;
        if value > MOST_CELLS {
            return Err(LogError::TooLarge { what: "number of cells", value, limit: MOST_CELLS });
        }
        Ok(())
    }

    fn into_columns(self) -> Text {
        let mut notes = Vec::new();
        if self.ragged > 0 {
            let (ragged, cells) = (self.ragged, self.values.len());
            notes.push(format!("{ragged} of {} rows do not have {cells} cells", self.rows));
        }
        let all = self.names.into_iter().zip(self.values);
        let (some, none): (Vec<_>, Vec<_>) = all.partition(|(_, values)| values.count() > 0);
        let column = |(name, values): (String, ColumnBuilder)| values.into_column(name);
        let empty = none.into_iter().map(|(name, _)| name).collect();
        Text { columns: some.into_iter().map(column).collect(), notes, empty }
    }
}

/// The delimiter: one with as many cells in each of the first lines, else the first in the first line.
///
/// A comma comes last, since it may be that of decimals.
fn delimiter(lines: &[(usize, String)]) -> Option<char> {
    let is_constant = |delimiter: &char| {
        let mut counts = lines.iter().map(|(_, line)| cells(line, Some(*delimiter)).len());
        let first = counts.next().unwrap_or(0);
        first > 1 && counts.all(|count| count == first)
    };
    let contains =
        |delimiter: &char| lines.first().is_some_and(|(_, line)| line.contains(*delimiter));
    let constant = [';', '\t', ','].into_iter().find(is_constant);
    constant.or_else(|| [',', ';', '\t'].into_iter().find(contains))
}

/// A number with a decimal comma, with a point. Between commas, `1,234` may be a thousand, and is none.
fn with_decimal_point(cell: &str, delimiter: Option<char>) -> Option<String> {
    let (whole, fraction) = cell.split_once(',')?;
    let is_thousands = fraction.len() == 3 && whole.trim_start_matches('-') != "0";
    let text = format!("{whole}.{fraction}");
    let is_number = text.parse::<f64>().is_ok() && !whole.contains('.');
    (is_number && !(delimiter == Some(',') && is_thousands)).then_some(text)
}

/// Whether the cells of a line are the units of these names: all in brackets, or one of them a unit of time below a name of time.
fn is_units(names: &[String], cells: &[&str]) -> bool {
    let is_number = cells.iter().any(|cell| number(cell).is_some());
    let mut some = cells.iter().filter(|cell| !cell.is_empty()).peekable();
    let in_brackets = some.peek().is_some() && some.all(|cell| cell.starts_with(['[', '(']));
    let below_time = |(name, cell): (&String, &&str)| is_time_name(name) && is_unit(cell);
    !is_number && (in_brackets || names.iter().zip(cells).any(below_time))
}

/// The cells of a line.
fn cells(text: &str, delimiter: Option<char>) -> Vec<&str> {
    match delimiter {
        None => text.split_whitespace().collect(),
        Some(delimiter) => {
            let mut quoted = false;
            let split = |c: char| {
                quoted ^= c == '"';
                c == delimiter && !quoted
            };
            text.split(split).map(|cell| cell.trim().trim_matches('"').trim()).collect()
        }
    }
}

fn first_word(cell: &str) -> &str {
    cell.split_whitespace().next().unwrap_or(cell)
}

/// Whether a cell is no name but a number with an error, such as `O.01`.
fn is_damaged_number(cell: &str) -> bool {
    let digits = cell.bytes().filter(u8::is_ascii_digit).count();
    cell.is_empty() || digits > cell.chars().filter(|c| c.is_alphabetic()).count()
}

/// The name in a cell; `rostopic echo -p` writes a percent sign before the first.
fn name(cell: &str) -> String {
    cell.trim_start_matches('%').trim_matches(['"', '\'']).trim().to_owned()
}

#[cfg(test)]
mod tests;
