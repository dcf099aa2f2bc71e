//! Exponential function of an `f32`, in `f32` arithmetic throughout.

use core::f32::consts::LOG2_E;

/// Adding 1.5·2²³ leaves no room for a fraction: it rounds to the nearest integer, whose low bits
/// are then the low bits of the sum.
const ROUNDER: f32 = 12_582_912.0;

/// ln 2 as a sum of two parts, its error below 2⁻⁴⁵. The first is a multiple of 2⁻¹⁵: its product with an
/// integer of 8 bits is exact.
const LN_2: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];

/// `(cosh r − 1 − r²/2)/r⁴` as a polynomial in `r²`: minimax on `[-ln 2 / 2, ln 2 / 2]`, found by Remez's
/// exchange, its coefficients rounded one after the other. The error of cosh is below 2⁻³³.
const COSH: [f32; 2] = [0.041_666_46, 0.001_393_542_9];

/// `(sinh r − r)/r³` as a polynomial in `r²`, found in the same way. The relative error of sinh is below
/// 2⁻³⁴.
const SINH: [f32; 3] = [0.166_666_67, 0.008_333_175, 0.000_199_740_46];

/// `e^x`, within 0.62 ulp, or 0.76 among the subnormal numbers; ∞ above 88.72, subnormal below −87.3 and 0 below −103.97.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // The exponentials of the limits are ∞ and 0. NaN passes both comparisons.
    let capped = if x > 89.0 { 89.0 } else { x };
    let capped = if capped < -105.0 { -105.0 } else { capped };
    let k = (capped * LOG2_E + ROUNDER) - ROUNDER;
    // Exact, by Sterbenz's lemma unless k is 0.
    let rest = capped - k * LN_2[0];
    let low = k * LN_2[1];
    let r = rest - low;
    let tail = (rest - r) - low;

    let z = r * r;
    let even = 0.5 * z + z * z * (COSH[0] + z * COSH[1]);
    let odd = z * r * (SINH[0] + z * (SINH[1] + z * SINH[2]));
    let base = 1.0 + r;
    let lost = r - (base - 1.0);
    let value = base + (lost + (even + (odd + tail * base)));
    // 2ᵏ may be beyond the range where the result is not: two factors, of which only the last rounds.
    let half = (0.5 * k + ROUNDER) - ROUNDER;
    let value = value * power_of_two(half) * power_of_two(k - half);
    if x.is_nan() { f32::NAN } else { value }
}

/// `2ᵏ` for an integer `k` from −126 to 127.
#[inline(always)]
fn power_of_two(k: f32) -> f32 {
    f32::from_bits((k + ROUNDER).to_bits().wrapping_add(127) << 23)
}
