//! Arc sine and arc cosine of an `f64`.

use core::f64::consts::{FRAC_PI_2, PI};

use super::error_free::{fast_two_sum, two_product};

/// `(asin s − s)/s³` as a polynomial in `s²`: minimax for the relative error of the arc sine on `|s| ≤ ½`, found
/// by Remez's exchange, its coefficients rounded one after the other. Its error is below 2⁻⁵⁹.
const ASIN: [f64; 13] = [
    0.166_666_666_666_667_63,
    0.074_999_999_999_701_29,
    0.044_642_857_175_236_2,
    0.030_381_942_678_616_762,
    0.022_372_215_789_220_582,
    0.017_351_598_507_922_3,
    0.013_980_960_729_346_278,
    0.011_398_044_727_941_006,
    0.010_783_015_140_810_672,
    0.003_705_588_296_604_290_3,
    0.021_682_930_564_298_594,
    -0.020_923_774_700_386_002,
    0.032_554_979_348_771_77,
];

/// π/2 − [`FRAC_PI_2`], rounded.
const FRAC_PI_2_LOW: f64 = 6.123_233_995_736_766e-17;

const SIGN: u64 = 1 << 63;

/// Arc sine of `x` in radians, within 0.66 ulp, NaN outside [−1, 1].
#[inline(always)]
pub fn asin(x: f64) -> f64 {
    let a = x.abs();
    let (s, rest) = kernel(a);
    // asin a = π/2 − 2 asin √((1 − a)/2).
    let small = a < 0.5;
    let offset = if small { (0.0, 0.0) } else { (FRAC_PI_2, FRAC_PI_2_LOW) };
    let factor = if small { 1.0 } else { -2.0 };
    let value = sum(offset, factor * s, factor * rest);
    let value = f64::from_bits(value.to_bits() | (x.to_bits() & SIGN));
    if a <= 1.0 { value } else { f64::NAN }
}

/// Arc cosine of `x` in radians, within 0.65 ulp, NaN outside [−1, 1].
#[inline(always)]
pub fn acos(x: f64) -> f64 {
    let a = x.abs();
    let (s, rest) = kernel(a);
    let small = a < 0.5;
    let negative = x < 0.0;
    // acos a = 2 asin √((1 − a)/2), acos(−a) = π − acos a, and below ½ it is π/2 − asin x.
    let offset = if negative { (PI, 2.0 * FRAC_PI_2_LOW) } else { (0.0, 0.0) };
    let offset = if small { (FRAC_PI_2, FRAC_PI_2_LOW) } else { offset };
    let factor = if small { -1.0 } else { 2.0 };
    let factor = if negative { -factor } else { factor };
    let value = sum(offset, factor * s, factor * rest);
    if a <= 1.0 { value } else { f64::NAN }
}

/// Arc sine of `a` as a sum if `a < ½`, else that of `√((1 − a)/2)`.
#[inline(always)]
fn kernel(a: f64) -> (f64, f64) {
    let small = a < 0.5;
    let z = if small { a * a } else { 0.5 * (1.0 - a) };
    let root = z.sqrt();
    let (square, error) = two_product(root, root);
    let twice = if root == 0.0 { 1.0 } else { 2.0 * root };
    // What the root lost to rounding.
    let low = ((z - square) - error) / twice;
    let (s, low) = if small { (a, 0.0) } else { (root, low) };
    (s, low + z * s * horner(z, ASIN))
}

/// `offset + lead + rest`, where `lead` is smaller than the offset, or this is zero.
#[inline(always)]
fn sum((offset, offset_low): (f64, f64), lead: f64, rest: f64) -> f64 {
    let (base, lost) = fast_two_sum(offset, lead);
    base + (lost + (offset_low + rest))
}

#[inline(always)]
fn horner(z: f64, [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12]: [f64; 13]) -> f64 {
    let high = c7 + z * (c8 + z * (c9 + z * (c10 + z * (c11 + z * c12))));
    c0 + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * (c6 + z * high))))))
}
