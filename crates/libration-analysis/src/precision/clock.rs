//! A clock that sums its steps in floats.

use libration_core::Float;

/// The time after `ticks` additions `t += dt` from zero, in the float `F`: to the bit what the additions would give,
/// in about as many operations as there are powers of two on the way.
///
/// Between two powers of two all floats are equally far apart, so every addition is rounded alike; at a tie, to the
/// even neighbour, from the second addition on. Two equal increments in a row are then all there is up to the next
/// power of two. Where `dt` is less than half a unit in the last place, the clock stands still.
///
/// None if `dt` is not positive and finite, or if `F` keeps what its sums round off
/// ([`Compensated`](libration_core::number::Compensated), [`TwoFloat`](libration_core::number::TwoFloat)): such a clock has no such
/// pattern.
pub fn float_clock<F: Float>(dt: F, ticks: u64) -> Option<F> {
    let keeps = F::one() + F::from_f64(F::UNIT_ROUNDOFF / 2.0) != F::one();
    if keeps || !dt.is_finite() || dt <= F::zero() {
        return None;
    }
    let (mut t, mut left) = (F::zero(), ticks);
    // The increment before, and where it began.
    let (mut last, mut before) = (f64::NAN, f64::NAN);
    while left > 0 {
        let next = t + dt;
        left -= 1;
        // Exact, as soon as the clock is beyond the first power of two above `dt`.
        let (from, now) = (t.to_f64(), next.to_f64());
        let increment = now - from;
        if increment == 0.0 || !next.is_finite() {
            return Some(next);
        }
        t = next;
        let top = power_of_two_above(now);
        if increment == last && power_of_two_above(before) == top {
            // Two ticks short of the power of two, beyond which rounding has another grid.
            let jump = ((((top - now) / increment).floor() - 2.0).max(0.0) as u64).min(left);
            t = F::from_f64(now + jump as f64 * increment);
            left -= jump;
        }
        (last, before) = (increment, from);
    }
    Some(t)
}

/// The smallest power of two above `x`, which is positive.
fn power_of_two_above(x: f64) -> f64 {
    let exponent = f64::from_bits(x.to_bits() & (0x7ff << 52));
    if exponent > 0.0 { 2.0 * exponent } else { f64::MIN_POSITIVE }
}

#[cfg(test)]
mod tests {
    use half::{bf16, f16};
    use libration_core::Scalar;
    use libration_core::number::{Compensated, Mantissa, TwoFloat};

    use super::*;

    fn by_adding<F: Float>(dt: F, ticks: u64) -> F {
        (0..ticks).fold(F::zero(), |t, _| t + dt)
    }

    fn agrees<F: Float>(dt: f64) {
        let dt = F::from_f64(dt);
        for ticks in [0, 1, 2, 3, 7, 100, 1_023, 65_537, 1_000_000] {
            let (jumped, added) = (float_clock(dt, ticks).unwrap(), by_adding(dt, ticks));
            assert_eq!(jumped, added, "{} {dt:?} {ticks}", F::NAME);
        }
    }

    #[test]
    fn a_clock_predicted_by_powers_of_two_is_that_of_the_additions_to_the_bit() {
        // The last two tie in some of their binades, 2⁻³ never rounds.
        for dt in [0.01, 0.001, 1.0 / 3.0, 7e-4, 0.125, 3.0, 5.0 / 4096.0] {
            agrees::<f64>(dt);
            agrees::<f32>(dt);
            agrees::<f16>(dt);
            agrees::<bf16>(dt);
            agrees::<Mantissa<5>>(dt);
            agrees::<Mantissa<13>>(dt);
            agrees::<Mantissa<40>>(dt);
        }
    }

    #[test]
    fn a_single_precision_clock_is_135_seconds_slow_after_a_million_ticks_of_10_ms() {
        let t = float_clock(0.01_f32, 1_000_000).unwrap();
        assert!((t - 9865.22).abs() < 0.005, "{t}");
        // Where half a unit in the last place is more than a tick, it stands still.
        assert_eq!(float_clock(0.01_f32, u64::MAX), Some(262_144.0));
    }

    #[test]
    fn no_clock_is_predicted_for_sums_that_keep_their_rounding_or_steps_that_are_none() {
        assert_eq!(float_clock(Compensated::from_f64(0.01), 10), None);
        assert_eq!(float_clock(TwoFloat::from_f64(0.01), 10), None);
        assert!([0.0, -1.0, f64::NAN, f64::INFINITY].map(|dt| float_clock(dt, 3)) == [None; 4]);
    }
}
