//! Exported float types and their shortest decimals.

use std::borrow::Cow;
use std::fmt::Write;

use half::{bf16, f16};
use libration::{Float, Scalar};

use super::Values;

/// A float type of exported columns.
pub trait Number: Float {
    /// The column of these values.
    fn values(values: Vec<Self>) -> Values<'static>;

    /// Appends the shortest decimal that is read as the same number in this type.
    ///
    /// It always has a decimal point or an exponent. Other values are `inf`, `-inf` and `NaN`.
    fn append_text(self, text: &mut String);
}

macro_rules! machine_number {
    ($float:ident, $variant:ident) => {
        impl Number for $float {
            fn values(values: Vec<Self>) -> Values<'static> {
                Values::$variant(Cow::Owned(values))
            }

            fn append_text(self, text: &mut String) {
                let _infallible = write!(text, "{self:?}");
            }
        }
    };
}

machine_number!(f64, F64);
machine_number!(f32, F32);

macro_rules! half_number {
    ($float:ident, $variant:ident, $digits:literal) => {
        impl Number for $float {
            fn values(values: Vec<Self>) -> Values<'static> {
                Values::$variant(Cow::Owned(values))
            }

            fn append_text(self, text: &mut String) {
                let wide = f64::from(self.to_f32());
                // Of the decimals with 1, 2, … significant digits that are nearest to the number,
                // the first that rounds back to it. `$digits` always do.
                let start = text.len();
                for after_point in 0..$digits {
                    let _infallible = write!(text, "{wide:.after_point$e}");
                    let decimal = text[start..].parse::<f64>().unwrap_or(f64::NAN);
                    text.truncate(start);
                    if <$float as Scalar>::from_f64(decimal) == self || after_point == $digits - 1 {
                        let _infallible = write!(text, "{decimal:?}");
                        return;
                    }
                }
            }
        }
    };
}

// ⌈1 + p·log₁₀ 2⌉ digits tell any two numbers of p bits apart.
half_number!(f16, F16, 5);
half_number!(bf16, Bf16, 4);
