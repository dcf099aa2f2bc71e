//! Powers of priorities.

use core::f64::consts::{LN_2, LOG2_E, SQRT_2};

/// Powers of two beyond these, of which fewer digits would be known, are left to the library.
const MOST: f64 = 100.0;

/// `base` to the power of `exponent`, by operations that give the same bits on every machine: within 40 units in the last place, in a
/// quarter of the time of the library's, whose last digits no weight needs.
#[inline(always)]
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    // What is exact stays so.
    if exponent == 1.0 || exponent == 2.0 {
        return if exponent == 1.0 { base } else { base * base };
    }
    let twos = exponent * log2(base);
    // Neither zero nor what is subnormal, infinite or not a number.
    if (f64::MIN_POSITIVE..f64::INFINITY).contains(&base) && twos.abs() <= MOST {
        exp2(twos)
    } else {
        libm::pow(base, exponent)
    }
}

/// The logarithm of a positive normal number: that of its power of two, and `2 artanh((m − 1)/(m + 1))` of the rest, which lies
/// between √½ and √2.
#[inline(always)]
fn log2(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    let bits = x.to_bits();
    let mantissa = f64::from_bits((bits & MANTISSA) | ONE);
    let large = mantissa > SQRT_2;
    let mantissa = if large { 0.5 * mantissa } else { mantissa };
    let twos = ((bits >> 52) as i64 - 1023 + i64::from(large)) as f64;
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    // Of s² ≤ 0.0295 the eleventh power is below half a unit in the last place of the first.
    let square = s * s;
    let mut sum = 0.0;
    for k in (0..11).rev() {
        sum = sum * square + 1.0 / (2 * k + 1) as f64;
    }
    twos + 2.0 * LOG2_E * s * sum
}

/// Two to a power of at most [`MOST`]: to the nearest whole one, times the exponential series of the rest, at most a half.
#[inline(always)]
fn exp2(x: f64) -> f64 {
    // Half a unit of this is one: what is added to it is rounded to the nearest whole number.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let shifted = x + WHOLE;
    let twos = shifted - WHOLE;
    let rest = (x - twos) * LN_2;
    // 0.3466¹⁴ / 14! is below half a unit in the last place of one.
    let mut sum = 1.0;
    for k in (1..14).rev() {
        sum = 1.0 + sum * rest * (1.0 / k as f64);
    }
    let scale = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
    sum * scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library_to_forty_units_in_the_last_place() {
        let mut worst = 0.0_f64;
        for i in 0..200_000_u64 {
            // From 2⁻⁵⁰ to 2⁵⁰, and exponents from −2 to 2.
            let share = |k: u64| (i.wrapping_mul(k) >> 11) as f64 / (1_u64 << 53) as f64;
            let base = libm::exp2(100.0 * share(0x9e37_79b9_7f4a_7c15) - 50.0);
            let exponent = 4.0 * share(0xd1b5_4a32_d192_ed03) - 2.0;
            let (found, wanted) = (power(base, exponent), libm::pow(base, exponent));
            worst = worst.max((found / wanted - 1.0).abs() / f64::EPSILON);
        }
        // A logarithm of up to 100 is known to half a unit of its last place: 100 · ln 2 · ½ units of the power.
        assert!(worst < 40.0, "{worst}");
    }

    #[test]
    fn what_is_no_usual_number_is_as_the_library_has_it() {
        let numbers = [0.0, 5e-324, f64::MIN_POSITIVE, 1.0, 1e308, f64::INFINITY, f64::NAN, -1.0];
        for base in numbers {
            for exponent in [0.0, 0.6, 1.0, -0.4, 3.0, -3.0] {
                let (found, wanted) = (power(base, exponent), libm::pow(base, exponent));
                let same = found.to_bits() == wanted.to_bits()
                    || (found.is_nan() && wanted.is_nan())
                    || (found / wanted - 1.0).abs() < 40.0 * f64::EPSILON;
                assert!(same, "{base} to the power of {exponent}: {found}, {wanted}");
            }
        }
        for exponent in [0.0, 0.5, -7.0] {
            assert_eq!(power(1.0, exponent), 1.0);
        }
        assert_eq!([power(4.0, 0.5), power(2.0, -3.0)], [2.0, 0.125]);
        assert_eq!([power(5.3, 1.0), power(5.0, 2.0)], [5.3, 25.0]);
    }
}
