//! The coefficients of published Runge–Kutta and Runge–Kutta–Nyström methods.
//!
//! Rational coefficients have 25 digits; those of `dormand-prince-8` have those of a float.
#![expect(
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "coefficients are data, for other programs too"
)]

use super::RungeKuttaTable;

mod general;
mod nystrom;
mod nystrom_12;

impl RungeKuttaTable {
    /// All of them by kind, then by rising order.
    pub const ALL: [&'static [RungeKuttaTable]; 3] =
        [general::TABLES, nystrom::TABLES, nystrom_12::TABLES];
}
