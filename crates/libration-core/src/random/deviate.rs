//! Random numbers from random words, the same for every float type.

/// A number uniform on (−1, 1), made of 24 bits: its mean is zero, and an `f32` holds it exactly.
#[inline(always)]
pub fn uniform(word: u32) -> f32 {
    odd(word) * UNIT
}

/// 2²⁴ times [`uniform`]: the odd numbers below.
#[inline(always)]
pub fn odd(word: u32) -> f32 {
    (((word as i32) >> 7) | 1) as f32
}

/// The factor from [`odd`] to [`uniform`]: a power of two, so that other factors can absorb it.
pub const UNIT: f32 = 1.0 / (1 << 24) as f32;

/// More than any [`normal`] number has in size: `√(48 ln 2)` and its rounding.
pub const LARGEST: f32 = 5.7683;

/// A number with the standard normal distribution, up to [`LARGEST`] in size.
///
/// G. E. P. Box, M. E. Muller, *A note on the generation of random normal deviates*, The Annals of Mathematical
/// Statistics 29, 1958; in `f32` arithmetic throughout, and without a branch.
#[inline(always)]
pub fn normal([size, turn]: [u32; 2]) -> f32 {
    // In (0, 1], by steps of 2⁻²⁴.
    let u = ((size >> 8) + 1) as i32 as f32 / (1 << 24) as f32;
    // In (−¼, ¼]: the sine of all angles, each once.
    let x = 0.25 - (((turn as i32) >> 8) as f32 / (1 << 24) as f32).abs();
    (-2.0 * log(u)).sqrt() * sine_of_turn(x)
}

/// `(ln(1 + f) − f)/f²` as a polynomial in `f` for `1 + f` in `[√½, √2]`, by interpolation at 400 of Chebyshev's points; its
/// error is below 3·10⁻⁸ of `ln(1 + f)`.
const LOG: [f32; 8] = [
    -0.499_999_94,
    0.333_336_6,
    -0.250_016_1,
    0.199_731_05,
    -0.165_750_47,
    0.148_064_6,
    -0.142_577_95,
    0.090_042_025,
];

/// `sin(2πx)/x` as a polynomial in `x²` for `|x| ≤ ¼`, in the same way; its error is below 7·10⁻⁹.
const SINE: [f32; 5] = [6.283_185_5, -41.341_682, 81.602_48, -76.581_28, 39.760_723];

/// The logarithm of a positive number that is not subnormal.
#[inline(always)]
fn log(x: f32) -> f32 {
    const ROOT_HALF: u32 = 0x3F35_04F3;
    let bits = x.to_bits().wrapping_sub(ROOT_HALF);
    let exponent = ((bits as i32) >> 23) as f32;
    let f = f32::from_bits((bits & 0x007F_FFFF).wrapping_add(ROOT_HALF)) - 1.0;
    exponent * core::f32::consts::LN_2 + (f + f * f * polynomial(LOG, f))
}

/// `sin(2πx)` for `|x| ≤ ¼`.
#[inline(always)]
fn sine_of_turn(x: f32) -> f32 {
    x * polynomial(SINE, x * x)
}

/// Horner's rule.
#[inline(always)]
fn polynomial<const N: usize>(coefficients: [f32; N], x: f32) -> f32 {
    let mut value = 0.0;
    for i in (0..N).rev() {
        value = value * x + coefficients[i];
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Streams};

    #[test]
    fn a_uniform_number_is_odd_in_its_word() {
        // No word gives 0 or ±1, and each number has its opposite: the mean over all words is zero.
        for word in [0, 1, 127, 128, 1 << 31, u32::MAX, 0x1234_5678] {
            assert_eq!(uniform(word), -uniform(!word));
            assert!(uniform(word) != 0.0 && uniform(word).abs() < 1.0);
        }
    }

    #[test]
    fn the_logarithm_and_the_sine_are_good_to_an_f32() {
        for k in (1..=1 << 24).step_by(997) {
            let u = k as f32 / (1 << 24) as f32;
            let exact = f64::from(u).ln();
            // Two units of the last place of the larger of both terms.
            assert!((f64::from(log(u)) - exact).abs() < 2.4e-7 * exact.abs().max(0.05), "{u}");
            let x = u / 4.0;
            let exact = (core::f64::consts::TAU * f64::from(x)).sin();
            assert!((f64::from(sine_of_turn(x)) - exact).abs() < 2.4e-7 * exact.max(0.1), "{x}");
        }
        assert_eq!(log(1.0), 0.0);
    }

    #[test]
    fn numbers_have_the_moments_of_their_laws() {
        const COUNT: u64 = 1 << 20;
        let (mut sums, mut uniforms) = ([0.0_f64; 6], [0.0_f64; 4]);
        for trajectory in 0..COUNT / 64 {
            let mut stream = Streams::<1>::at(3, trajectory, 0, Purpose::StepTime);
            for _ in 0..64 {
                let x = f64::from(normal([stream.next(0), stream.next(0)]));
                let y = f64::from(uniform(stream.next(0)));
                sums.iter_mut().enumerate().for_each(|(k, sum)| *sum += x.powi(k as i32 + 1));
                uniforms.iter_mut().enumerate().for_each(|(k, sum)| *sum += y.powi(k as i32 + 1));
            }
        }
        // Four standard errors: √(variance of the power)/2¹⁰.
        let bounds = |sums: &[f64], moments: &[f64], deviations: &[f64]| {
            for ((sum, moment), deviation) in sums.iter().zip(moments).zip(deviations) {
                let mean = sum / COUNT as f64;
                assert!((mean - moment).abs() < 4.0 * deviation / 1024.0, "{mean} {moment}");
            }
        };
        let deviations = [1.0_f64, 2.0, 15.0, 96.0, 945.0, 10_395.0 - 225.0].map(f64::sqrt);
        bounds(&sums, &[0.0, 1.0, 0.0, 3.0, 0.0, 15.0], &deviations);
        let deviations = [1.0 / 3.0, 4.0 / 45.0, 1.0 / 7.0, 16.0 / 225.0].map(f64::sqrt);
        bounds(&uniforms, &[0.0, 1.0 / 3.0, 0.0, 0.2], &deviations);
    }
}
