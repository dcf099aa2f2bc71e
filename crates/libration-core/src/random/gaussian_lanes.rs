//! Normal numbers of neighbouring trajectories, in vectors.

use core::f64::consts::TAU;

use super::Address;
use crate::Elementary;

/// [`Address::gaussian`] of `W` neighbouring trajectories from `first` on, bit for bit, in loops without branches or calls.
#[inline(always)]
pub fn gaussian_lanes<const W: usize>(first: Address) -> [[f64; W]; 2] {
    let mut words = [[0_u32; 4]; W];
    for (l, words) in words.iter_mut().enumerate() {
        *words = Address { trajectory: first.trajectory + l as u64, ..first }.bits();
    }
    let mut radius = [0.0; W];
    let mut angle = [0.0; W];
    for l in 0..W {
        let [a, b, c, d] = words[l];
        radius[l] = (-2.0 * log(uniform(a, b))).sqrt();
        angle[l] = TAU * uniform(c, d);
    }
    let (mut first, mut second) = ([0.0; W], [0.0; W]);
    for l in 0..W {
        first[l] = radius[l] * Elementary::cos(angle[l]);
        second[l] = radius[l] * Elementary::sin(angle[l]);
    }
    [first, second]
}

/// 2⁵², from which on floats are whole numbers.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// The number of [`Address::uniform`]. AVX2 converts no whole numbers of 64 bits, so these become the last digits of [`WHOLE`].
#[inline(always)]
fn uniform(low: u32, high: u32) -> f64 {
    let bits = (u64::from(high) << 32 | u64::from(low)) >> 12;
    (f64::from_bits(WHOLE.to_bits() | bits) - WHOLE + 0.5) * (1.0 / WHOLE)
}

/// `libm::log` of a number in `(0, 1)` that is not subnormal, with the same operations but no branch.
///
/// FreeBSD, `e_log.c`, whose constants and order of operations these are.
#[inline(always)]
fn log(x: f64) -> f64 {
    const ROOT_HALF: u64 = 0x3FE6_A09E << 32;
    const EXPONENT: u64 = 0x3FF << 52;
    let bits = x.to_bits() + (EXPONENT - ROOT_HALF);
    // The exponent, biased by 1023, as the last digits of 2⁵².
    let k = f64::from_bits(WHOLE.to_bits() | bits >> 52) - (WHOLE + 1023.0);
    let f = f64::from_bits((bits & 0x000F_FFFF_FFFF_FFFF) + ROOT_HALF) - 1.0;
    let hfsq = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (LG[1] + w * (LG[3] + w * LG[5]));
    let odd = z * (LG[0] + w * (LG[2] + w * (LG[4] + w * LG[6])));
    s * (hfsq + (odd + even)) + k * LN2_LOW - hfsq + f + k * LN2_HIGH
}

const LN2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
const LN2_LOW: f64 = f64::from_bits(0x3DEA_39EF_3579_3C76);
const LG: [f64; 7] = [
    f64::from_bits(0x3FE5_5555_5555_5593),
    f64::from_bits(0x3FD9_9999_9997_FA04),
    f64::from_bits(0x3FD2_4924_9422_9359),
    f64::from_bits(0x3FCC_71C5_1D8E_78AF),
    f64::from_bits(0x3FC7_4664_96CB_03DE),
    f64::from_bits(0x3FC3_9A09_D078_C69F),
    f64::from_bits(0x3FC2_F112_DF3E_5244),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    #[test]
    fn lanes_have_the_bits_of_lone_draws() {
        for step in 0..20_000 {
            let first = Address { seed: 9, trajectory: 77, step, purpose: Purpose::Disturbance };
            let [a, b] = gaussian_lanes::<16>(first);
            for l in 0..16 {
                let lone = Address { trajectory: 77 + l as u64, ..first }.gaussian();
                assert_eq!([a[l], b[l]].map(f64::to_bits), lone.map(f64::to_bits), "{step} {l}");
            }
        }
    }

    #[test]
    fn the_logarithm_is_that_of_libm_at_both_ends_and_between() {
        let near_one = (1..2000).map(|k| 1.0 - f64::from(k) * 2.0_f64.powi(-53));
        let near_zero = (1..2000).map(|k| f64::from(k) * 2.0_f64.powi(-53));
        let between = (1..2000).map(|k| f64::from(k) / 2000.0);
        for x in near_one.chain(near_zero).chain(between) {
            assert_eq!(log(x).to_bits(), libm::log(x).to_bits(), "{x}");
        }
    }
}
