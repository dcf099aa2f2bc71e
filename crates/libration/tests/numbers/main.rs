//! Claims about the number types, each against exact arithmetic or an independent library.

mod dual;
mod poly;
mod ratio;
mod twofloat;
mod wide;
mod wide_functions;

use libration::number::Wide;

/// `2^n` for a normal exponent, exactly.
fn exp2(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

/// `|x − exact| / |exact|`.
fn relative_error(x: Wide, exact: Wide) -> f64 {
    if x == exact { 0.0 } else { ((x - exact) / exact).abs().to_f64() }
}
