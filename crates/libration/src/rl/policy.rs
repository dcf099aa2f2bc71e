//! Who acts.

use core::array::from_fn;

use crate::Float;

/// Chooses an action: an acceleration in each of `D` degrees of freedom, from `O` numbers that are seen.
pub trait Policy<T: Float, const O: usize, const D: usize>: Copy + Send + Sync {
    /// The action. It branches on nothing but what `self` holds, and is `#[inline(always)]`, or the loops over environments
    /// are no vectors.
    fn act(&self, place: Place, seen: &[T; O]) -> [T; D];
}

/// Which action is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The number of the environment.
    pub environment: usize,
    /// Steps since the batch was made.
    pub step: u64,
}

/// Always the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant<const D: usize>(
    /// The action.
    pub [f64; D],
);

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Constant<D> {
    #[inline(always)]
    fn act(&self, _: Place, _: &[T; O]) -> [T; D] {
        self.0.map(T::from_f64)
    }
}

/// `u = W·seen + b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const O: usize, const D: usize> {
    /// `W`, row by row: a row for each degree of freedom.
    pub weights: [[f64; O]; D],
    /// `b`.
    pub bias: [f64; D],
}

impl<T: Float, const O: usize, const D: usize> Policy<T, O, D> for Linear<O, D> {
    #[inline(always)]
    fn act(&self, _: Place, seen: &[T; O]) -> [T; D] {
        from_fn(|i| {
            let mut sum = T::from_f64(self.bias[i]);
            for (weight, &x) in self.weights[i].iter().zip(seen) {
                sum = sum + T::from_f64(*weight) * x;
            }
            sum
        })
    }
}
