//! Stamps in two columns: seconds and nanoseconds.

use crate::column::{Column, MISSING, Values};
use crate::time_unit::{split_nanoseconds, split_seconds};

const NANOSECONDS: i64 = 1_000_000_000;

/// The smallest number that the greatest of many nanoseconds reaches: counters of a loop stay below it, stamps do not.
const SMALLEST_MAXIMUM: i64 = 1_000_000;

/// The smallest number of seconds since 1970.
const EPOCH: i64 = 500_000_000;

/// Joins a column of seconds and one of nanoseconds, such as `stamp.sec` and `stamp.nanosec`, to one of stamps; false if there are none.
pub(crate) fn combine_named(columns: &mut Vec<Column>) -> bool {
    let pair = columns.iter().enumerate().find_map(|(second, column)| {
        let stem = split_seconds(&column.name)?;
        let is_rest =
            |other: &Column| split_nanoseconds(&other.name).is_some_and(|own| own == stem);
        let rest = columns.iter().position(is_rest)?;
        let stamps = sums(column, &columns[rest])?;
        Some((second, rest, stem, stamps))
    });
    let Some((second, rest, stem, stamps)) = pair else { return false };
    let name = if stem.is_empty() { "time".to_owned() } else { stem };
    replace(columns, second, rest, name, stamps);
    true
}

/// Joins the first two columns, if they have no names and the shape of seconds and nanoseconds, as `ros2 topic echo --csv` writes them,
/// and adds a note.
pub(crate) fn combine_leading(columns: &mut Vec<Column>, notes: &mut Vec<String>) {
    let [first, second, ..] = columns.as_slice() else { return };
    if first.name != "column_1" || second.name != "column_2" || !has_shape(first, second) {
        return;
    }
    let Some(stamps) = sums(first, second) else { return };
    notes.push(
        "`column_1` and `column_2` are taken as the seconds and nanoseconds of `time`; help: --time column_1, if they are not".to_owned(),
    );
    replace(columns, 0, 1, "time".to_owned(), stamps);
}

/// Whether whole numbers look like the seconds and nanoseconds of stamps.
///
/// The second column passes a million and the sums go back at most as often as stamps may. The seconds count from 1970, or two rows have
/// the same second and two others not: a number of a row is in one row only, a number of a motor never changes.
fn has_shape(first: &Column, second: &Column) -> bool {
    let (Values::Whole(seconds), Some(stamps)) = (&first.values, sums(first, second)) else {
        return false;
    };
    let Values::Whole(nanoseconds) = &second.values else { return false };
    let largest = nanoseconds.iter().copied().max().unwrap_or(0);
    let backward = stamps.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let steps = || seconds.windows(2).map(|pair| pair[1] != pair[0]);
    let is_epoch = seconds.first().is_some_and(|&first| first >= EPOCH);
    stamps.len() >= 2
        && largest >= SMALLEST_MAXIMUM
        && backward <= stamps.len() / 20
        && (is_epoch || steps().any(|is_step| is_step) && steps().any(|is_step| !is_step))
}

/// Seconds and nanoseconds as nanoseconds; none if they are no such numbers.
fn sums(seconds: &Column, nanoseconds: &Column) -> Option<Vec<i64>> {
    let (Values::Whole(seconds), Values::Whole(nanoseconds)) =
        (&seconds.values, &nanoseconds.values)
    else {
        return None;
    };
    let sum = |(&s, &n): (&i64, &i64)| match (0..NANOSECONDS).contains(&n) {
        _ if s == MISSING || n == MISSING => Some(MISSING),
        true => s.checked_mul(NANOSECONDS)?.checked_add(n),
        false => None,
    };
    seconds.iter().zip(nanoseconds).map(sum).collect()
}

/// Replaces the column of seconds by that of stamps, and removes that of nanoseconds.
fn replace(columns: &mut Vec<Column>, second: usize, rest: usize, name: String, stamps: Vec<i64>) {
    let gap = columns[second].gap.take().or(columns[rest].gap.take());
    columns[second] = Column { gap, ..Column::new(name, Values::Nanoseconds(stamps)) };
    columns[second].per_second = Some(1.0);
    columns.remove(rest);
}
