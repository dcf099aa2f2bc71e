//! Tangent of an `f64`.

use super::error_free::{fast_two_sum, quotient, two_product};
use super::sine64::{RANGE, corrections, reduce};

const SIXTH: f64 = 1.0 / 6.0;

const SIGN: u64 = 1 << 63;

/// Tangent of `x` radians, within 0.88 ulp for `|x|` up to [`RANGE`], NaN beyond.
#[inline(always)]
pub fn tan(x: f64) -> f64 {
    let a = x.abs();
    let (k, r, tail) = reduce(a);
    let (sine_low, base, cosine_low) = corrections(r, tail);
    // The square of r in the leading terms, r³/6 and r²/2, is rounded.
    let (_, square_low) = two_product(r, r);
    let (sine, low) = fast_two_sum(r, sine_low);
    let sine = (sine, low - square_low * (r * SIXTH));
    let cosine = fast_two_sum(base, cosine_low - 0.5 * square_low);

    // After an odd number of quarter turns the tangent is −cos/sin.
    let odd = k & 1 == 1;
    let numerator = if odd { cosine } else { sine };
    let denominator = if odd { sine } else { cosine };
    let (q, low) = quotient(numerator, denominator);
    let sign = ((k & 1) << 63) ^ (x.to_bits() & SIGN);
    let value = f64::from_bits((q + low).to_bits() ^ sign);
    if a <= RANGE { value } else { f64::NAN }
}
