//! Division by a constant divisor.

/// A divisor, of which the reciprocal is known: a processor multiplies several times sooner than it divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Divisor {
    by: u64,
    /// The largest number that times `by` is no more than 2⁶⁴ − 1.
    reciprocal: u64,
}

impl Divisor {
    /// The divisor `by`, at least 1.
    pub(super) fn new(by: usize) -> Self {
        let by = (by as u64).max(1);
        Divisor { by, reciprocal: u64::MAX / by }
    }

    /// The quotient and the remainder.
    #[inline(always)]
    pub(super) fn divide(self, number: u64) -> (u64, u64) {
        let guess = ((u128::from(number) * u128::from(self.reciprocal)) >> 64) as u64;
        // The reciprocal is too small by at most one part in 2⁶⁴: the guess is right, or too small by one.
        let left = number - guess * self.by;
        let more = left >= self.by;
        (guess + u64::from(more), if more { left - self.by } else { left })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_are_those_of_the_processor() {
        let numbers = |by: u64| {
            let near = [0, 1, 2].into_iter().flat_map(move |k: u64| {
                [
                    by.wrapping_mul(k),
                    u64::MAX - k,
                    (u64::MAX / by).wrapping_mul(by),
                    1 << 32,
                    1 << 63,
                ]
            });
            near.flat_map(|x| [x.wrapping_sub(1), x, x.wrapping_add(1)])
        };
        let divisors = (1..70).chain([1 << 20, 4095, 4096, 4097, 999_983, (1 << 40) + 15]);
        for by in divisors.chain([u64::MAX, u64::MAX / 2, u64::MAX / 2 + 1, u64::MAX - 1]) {
            let divisor = Divisor::new(by as usize);
            for number in numbers(by) {
                assert_eq!(divisor.divide(number), (number / by, number % by), "{number} by {by}");
            }
        }
    }
}
