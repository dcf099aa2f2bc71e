//! Digits of the values of interactive figures.

use crate::figure::axis::{Scale, Span};

/// Significant digits that the text beside the pointer shows of a place.
pub(super) const PLACE_DIGITS: usize = 8;

/// Significant digits that the text beside the pointer shows of a value of a raster.
pub(super) const VALUE_DIGITS: usize = 7;

/// Part of the shown range that a place is rounded to: less than a pixel where the reader has zoomed in a thousand times.
const PLACE_PART: f64 = 1e-6;

/// Part of the shown range that the colour of a value is rounded to; it has 255 shades.
const COLOR_PART: f64 = 1e-4;

/// The value as the text beside the pointer has it, with more digits where the axis shows a narrow range of large values.
pub(super) fn place(value: f64, span: &Span) -> f64 {
    let range = match span.scale {
        Scale::Linear => span.high - span.low,
        Scale::Log => (span.high - span.low) * std::f64::consts::LN_10 * value.abs(),
    };
    rounded(value, range * PLACE_PART, PLACE_DIGITS)
}

/// A place on the scale of a colour bar to at least `digits` significant digits.
pub(super) fn shade(place: f64, span: &Span, digits: usize) -> f64 {
    rounded(place, (span.high - span.low) * COLOR_PART, digits)
}

/// The value to at least `digits` significant digits, and to as many more as differ from it by no more than `error`.
pub(super) fn rounded(value: f64, error: f64, digits: usize) -> f64 {
    let needed = (value.abs() / error).log10().ceil();
    // An `f64` has 17 digits at most; a range without a width needs them all.
    let more = if needed.is_nan() { 16.0 } else { needed.clamp(0.0, 16.0) };
    let after_point = (digits - 1).max(more as usize);
    format!("{value:.after_point$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(scale: Scale, low: f64, high: f64) -> Span {
        Span { scale, low, high }
    }

    #[test]
    fn a_place_has_the_digits_that_the_pointer_reads() {
        let wide = span(Scale::Linear, 0.0, 10.0);
        assert_eq!(place(1.0 / 3.0, &wide), 0.33333333);
        assert_eq!(place(-2e-9 / 3.0, &wide), -6.6666667e-10);
        assert_eq!(place(0.0, &wide), 0.0);
        assert_eq!(place(f64::MAX, &wide), f64::MAX, "as many as it has");
        let decades = span(Scale::Log, -16.0, 0.0);
        assert_eq!(place(2e-16 / 3.0, &decades), 6.6666667e-17);
    }

    #[test]
    fn a_place_in_a_narrow_range_is_off_by_less_than_a_millionth_of_it() {
        for width in [1e-3, 1e-6, 1e-9, 1e-12] {
            let linear = span(Scale::Linear, 1.0, 1.0 + width);
            let log = span(Scale::Log, 0.0, width);
            for share in [0.1, 1.0 / 3.0, 0.7] {
                let value = 1.0 + share * width;
                for shown in [linear, log] {
                    let off = shown.share(place(value, &shown)) - shown.share(value);
                    let floats = 4.0 * f64::EPSILON / width;
                    assert!(off.abs() <= 1.01e-6 + floats, "{width}: {off}");
                }
            }
        }
        let point = span(Scale::Linear, 1.0, 1.0);
        assert_eq!(place(1.0 + f64::EPSILON, &point), 1.0 + f64::EPSILON);
    }

    #[test]
    fn a_shade_is_off_by_less_than_a_colour_shows() {
        let bar = span(Scale::Log, -6.0, 2.0);
        for value in [-5.123_456_789, 1e-9, 1.999_999_9] {
            assert!((shade(value, &bar, 1) - value).abs() <= 8e-4, "{value}");
        }
        assert_eq!(shade(-5.123_456_789, &bar, 1), -5.1235);
        let narrow = span(Scale::Linear, 1.0, 1.0 + 1e-9);
        assert!((shade(1.0 + 0.3e-9, &narrow, 7) - 1.0 - 0.3e-9).abs() < 1e-13);
    }
}
