//! Columns while a text is read.

use crate::column::{Column, Gap, MISSING, Values, missing};
use crate::iso_8601::parse_iso_8601;

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
    gap: Option<Gap>,
}

impl Default for ColumnBuilder {
    fn default() -> Self {
        ColumnBuilder { values: Values::Whole(Vec::new()), numbers: 0, gap: None }
    }
}

impl ColumnBuilder {
    /// The number of values.
    pub(crate) fn count(&self) -> usize {
        self.numbers
    }

    /// The column of these values.
    pub(crate) fn into_column(self, name: String) -> Column {
        Column { gap: self.gap, ..Column::new(name, self.values) }
    }

    /// Keeps the first line without a finite value.
    pub(crate) fn note_gap(&mut self, line: usize, text: &str) {
        self.gap.get_or_insert_with(|| Gap { line, text: text.trim().chars().take(40).collect() });
    }

    /// Appends the number in a cell, or none; whether there is a finite one.
    pub(crate) fn push(&mut self, cell: &str) -> bool {
        let before = self.numbers;
        self.append(cell);
        self.numbers > before && number(cell).is_none_or(f64::is_finite)
    }

    fn append(&mut self, cell: &str) {
        let bare = cell.strip_prefix('(').and_then(|cell| cell.strip_suffix(')')).unwrap_or(cell);
        let Some(value) = number(bare) else {
            return match parse_iso_8601(bare) {
                Some(time) => self.push_time(time),
                None => self.push_missing(),
            };
        };
        self.numbers += 1;
        if let Values::Whole(all) = &mut self.values {
            if let Some(whole) = scaled(bare, 0) {
                return all.push(whole);
            }
            self.leave_whole(value);
        }
        if let Values::Nanoseconds(all) = &mut self.values {
            if let Some(nanoseconds) = scaled(bare, 9) {
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

    /// Appends a time since 1970 in ns; none among numbers of another kind.
    fn push_time(&mut self, time: i64) {
        if let (0, Values::Whole(all)) = (self.numbers, &mut self.values) {
            self.values = Values::Nanoseconds(std::mem::take(all));
        }
        let Values::Nanoseconds(all) = &mut self.values else { return self.push_missing() };
        all.push(time);
        self.numbers += 1;
    }

    fn push_missing(&mut self) {
        match &mut self.values {
            Values::Whole(all) | Values::Nanoseconds(all) => all.push(MISSING),
            Values::Floats(all) => all.push(missing()),
        }
    }
}

/// A decimal number times a power of ten, if that is whole: `1.76e+18`, `5.0`.
fn scaled(text: &str, power: i32) -> Option<i64> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (sign, digits) = match mantissa.strip_prefix('-') {
        Some(rest) => ("-", rest),
        None => ("", mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    let all = format!("{whole}{fraction}");
    if all.is_empty() || !all.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let zeros = exponent.parse::<i32>().ok()?.checked_add(power)?;
    let zeros = zeros.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    let kept = match zeros {
        0..=19 => all + &"0".repeat(zeros.unsigned_abs() as usize),
        _ if all.bytes().all(|digit| digit == b'0') => "0".to_owned(),
        // Zeros at the end are no fraction.
        _ if zeros < 0 => {
            let cut = all.len().checked_sub(zeros.unsigned_abs() as usize)?;
            let (kept, rest) = (all.get(..cut)?, all.get(cut..)?);
            rest.bytes().all(|digit| digit == b'0').then(|| kept.to_owned())?
        }
        _ => return None,
    };
    // The sign of −0.0 needs a decimal.
    let value = format!("{sign}{kept}").parse().ok()?;
    (value != 0 || sign.is_empty()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::scaled;

    #[test]
    fn decimals_that_are_whole_keep_all_digits() {
        for (text, power, wanted) in [
            ("1.7000000000004175e+18", 0, Some(1_700_000_000_000_417_500)),
            ("1.760000000123466240e+18", 0, Some(1_760_000_000_123_466_240)),
            ("1.760000000123466015e+09", 9, Some(1_760_000_000_123_466_015)),
            ("-1760000000005.000", 0, Some(-1_760_000_000_005)),
            ("1700000000.001000017", 9, Some(1_700_000_000_001_000_017)),
            ("0.000e+00", 0, Some(0)),
            ("500e-2", 0, Some(5)),
            ("0.5", 0, None),
            ("-0.0", 0, None),
            ("1e300", 0, None),
            ("1e-300", 0, None),
            ("e5", 0, None),
            ("1..5", 0, None),
        ] {
            assert_eq!(scaled(text, power), wanted, "{text}");
        }
    }
}
