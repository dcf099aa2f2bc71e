//! Order of numbers that are the sum of a value and a smaller part.
//!
//! The smaller part of an infinity may be NaN, which must not matter.

/// Whether the first number is less than the second.
#[inline(always)]
pub(super) fn less<T: PartialOrd>((a, a_low): (T, T), (b, b_low): (T, T)) -> bool {
    (a < b) | ((a == b) & (a_low < b_low))
}

/// Whether both numbers are the same.
#[inline(always)]
pub(super) fn equal<T: PartialOrd>((a, a_low): (T, T), (b, b_low): (T, T)) -> bool {
    (a == b) & !((a_low < b_low) | (a_low > b_low))
}
