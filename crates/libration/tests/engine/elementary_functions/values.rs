//! Values that mpmath computed: `tools/elementary_values.py` makes the table.

/// A value of a function, as a sum of two floats of which the first is the correctly rounded value.
pub(super) struct Value {
    pub(super) function: &'static str,
    pub(super) x: f64,
    /// The second argument, of `atan2`.
    pub(super) other: Option<f64>,
    pub(super) high: f64,
    pub(super) low: f64,
}

/// The rows of the table.
pub(super) fn values() -> Vec<Value> {
    let rows = include_str!("../elementary_values.csv").lines().skip(1);
    let float = |bits: &str| f64::from_bits(u64::from_str_radix(bits, 16).unwrap());
    let value = |row: &'static str| {
        let fields: Vec<&str> = row.split(',').collect();
        let [function, x, other, high, low] = fields[..] else { panic!("{row}") };
        let other = (!other.is_empty()).then(|| float(other));
        Value { function, x: float(x), other, high: float(high), low: float(low) }
    };
    rows.map(value).collect()
}

/// The power of two of the last place of a number near `value`, with `bits` of significand and that smallest one.
fn last_place(value: f64, bits: i32, smallest: i32) -> i32 {
    let exponent = ((value.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    (exponent - bits + 1).max(smallest)
}

/// `found − (high + low)` in units of the last place of `f64` near `high`.
pub(super) fn ulps_of_f64(found: f64, high: f64, low: f64) -> f64 {
    if found == high && (low == 0.0 || found.is_infinite()) {
        return 0.0;
    }
    // In two steps: neither a tiny difference nor the power of two may underflow.
    let power = -last_place(high, 53, -1074);
    let difference = (found - high) - low;
    (difference * 2f64.powi(power / 2) * 2f64.powi(power - power / 2)).abs()
}

/// The same for `f32`.
pub(super) fn ulps_of_f32(found: f32, exact: f64) -> f64 {
    if exact as f32 == found && (found.is_infinite() || found == 0.0) {
        return 0.0;
    }
    (f64::from(found) - exact).abs() * 2f64.powi(-last_place(exact, 24, -149))
}
