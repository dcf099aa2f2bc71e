//! Columns while a text is read.

use crate::column::{MISSING, Values, missing};

/// The text of a number in a cell; `candump -L` writes parentheses.
pub(crate) fn number(cell: &str) -> Option<f64> {
    let bare = cell.strip_prefix('(').and_then(|cell| cell.strip_suffix(')')).unwrap_or(cell);
    match bare {
        "true" | "True" => Some(1.0),
        "false" | "False" => Some(0.0),
        _ => bare.parse().ok(),
    }
}

/// A column while it is read: whole numbers as long as all are whole.
pub(crate) struct ColumnBuilder {
    values: Values,
    numbers: usize,
}

impl Default for ColumnBuilder {
    fn default() -> Self {
        ColumnBuilder { values: Values::Whole(Vec::new()), numbers: 0 }
    }
}

impl ColumnBuilder {
    /// The number of values.
    pub(crate) fn count(&self) -> usize {
        self.numbers
    }

    /// The values.
    pub(crate) fn into_values(self) -> Values {
        self.values
    }

    /// Appends the number in a cell, or none.
    pub(crate) fn push(&mut self, cell: &str) {
        let bare = cell.strip_prefix('(').and_then(|cell| cell.strip_suffix(')')).unwrap_or(cell);
        let Some(value) = number(bare) else {
            return self.push_missing();
        };
        self.numbers += 1;
        if let Values::Whole(all) = &mut self.values {
            if let Ok(whole) = bare.parse::<i64>() {
                return all.push(whole);
            }
            self.leave_whole(value);
        }
        if let Values::Nanoseconds(all) = &mut self.values {
            if let Some(nanoseconds) = nanoseconds(bare) {
                return all.push(nanoseconds);
            }
            let seconds = |&x: &i64| if x == MISSING { missing() } else { x as f64 / 1e9 };
            self.values = Values::Floats(all.iter().map(seconds).collect());
        }
        if let Values::Floats(all) = &mut self.values {
            all.push(value);
        }
    }

    /// Continues with decimals: exactly if the first is a number of seconds since 1970.
    fn leave_whole(&mut self, value: f64) {
        let Values::Whole(all) = &mut self.values else { return };
        let is_epoch = (5e8..5e9).contains(&value);
        let scaled = |&x: &i64| if x == MISSING { Some(x) } else { x.checked_mul(1_000_000_000) };
        let exact: Option<Vec<i64>> = is_epoch.then(|| all.iter().map(scaled).collect()).flatten();
        let float = |&x: &i64| if x == MISSING { missing() } else { x as f64 };
        self.values = exact
            .map_or_else(|| Values::Floats(all.iter().map(float).collect()), Values::Nanoseconds);
    }

    fn push_missing(&mut self) {
        match &mut self.values {
            Values::Whole(all) | Values::Nanoseconds(all) => all.push(MISSING),
            Values::Floats(all) => all.push(missing()),
        }
    }
}

/// Decimal seconds with at most nine digits behind the point, in ns.
fn nanoseconds(text: &str) -> Option<i64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() || fraction.len() > 9 || !digits(whole) || !digits(fraction) {
        return None;
    }
    format!("{whole}{fraction:0<9}").parse().ok()
}
