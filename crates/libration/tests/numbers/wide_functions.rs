//! The elementary functions of 1024-bit numbers against mpmath: `tools/elementary_values.py` makes the table.

#![allow(clippy::unwrap_used)]

use libration::number::Wide;
use libration::{Elementary, Scalar};

use crate::relative_error;

/// The number of a decimal with up to 310 digits.
fn decimal(text: &str) -> Wide {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = whole.trim_start_matches('-').chars().chain(fraction.chars());
    let ten = Wide::from_f64(10.0);
    let integer = digits.fold(Wide::zero(), |n, digit| {
        n * ten + Wide::from_f64(digit.to_digit(10).unwrap().into())
    });
    let power = exponent.parse::<i64>().unwrap() - fraction.len() as i64;
    let scale = ten.powi(power.unsigned_abs());
    let value = if power < 0 { integer / scale } else { integer * scale };
    if whole.starts_with('-') { -value } else { value }
}

#[test]
fn functions_agree_with_mpmath_to_298_digits() {
    let float = |bits: &str| Wide::from_f64(f64::from_bits(u64::from_str_radix(bits, 16).unwrap()));
    let mut rows = 0;
    for row in include_str!("wide_values.csv").lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [name, x, other, value] = fields[..] else { panic!("{row}") };
        let x = float(x);
        let found = match name {
            "sin" => x.sin(),
            "cos" => x.cos(),
            "tan" => x.tan(),
            "asin" => x.asin(),
            "acos" => x.acos(),
            "atan" => x.atan(),
            "atan2" => x.atan2(float(other)),
            "exp" => x.exp(),
            "ln" => x.ln(),
            "sinh" => x.sinh(),
            "cosh" => x.cosh(),
            "tanh" => x.tanh(),
            _ => panic!("{name}"),
        };
        // The functions err by 2⁻⁹⁹⁹ = 10⁻³⁰¹ at most, and the conversion of the decimal by some 2⁻¹⁰¹².
        let error = relative_error(found, decimal(value));
        assert!(error <= 1e-298, "{name} of {x}: {error:e}");
        rows += 1;
    }
    assert!(rows > 50, "{rows}");
}

#[test]
fn a_decimal_is_read_to_all_digits() {
    assert_eq!(decimal("-0.125"), Wide::from_f64(-0.125));
    assert_eq!(decimal("12.5e3"), Wide::from_f64(12_500.0));
}
