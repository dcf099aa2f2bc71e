//! What an environment shows, what it pays, and when it is over.

use crate::{Elementary, Float, State};

/// A task on a system with `D` degrees of freedom, of which `O` numbers are seen. Nothing in it branches on data, and each
/// function is `#[inline(always)]`, or the loops over environments are no vectors.
pub trait Task<T: Float, const D: usize, const O: usize>: Copy + Send + Sync {
    /// What is seen of a state.
    fn observe(&self, state: &State<T, D>) -> [T; O];

    /// What a step from `before` to `after` under `action` pays.
    fn reward(&self, before: &State<T, D>, action: &[T; D], after: &State<T, D>) -> T;

    /// Whether it is over with this state. What is no longer finite is over in any case.
    fn terminated(&self, after: &State<T, D>) -> bool;
}

/// To rest at the origin: a step pays `−(p·q² + r·v² + e·u²)`, and the episode is over beyond a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulate {
    /// `p`, the price of a distance squared.
    pub position: f64,
    /// `r`, that of a velocity squared.
    pub velocity: f64,
    /// `e`, that of a command squared.
    pub effort: f64,
    /// The distance from the origin, in each degree of freedom, beyond which all is lost; infinite for none.
    pub bound: f64,
}

/// The sum of so many terms, of which there is at least one.
#[inline(always)]
fn sum<T: Float, const D: usize>(term: impl Fn(usize) -> T) -> T {
    let mut all = term(0);
    for i in 1..D {
        all = all + term(i);
    }
    all
}

macro_rules! regulate {
    ($d:literal, $o:literal) => {
        impl<T: Float> Task<T, $d, $o> for Regulate {
            #[inline(always)]
            fn observe(&self, state: &State<T, $d>) -> [T; $o] {
                core::array::from_fn(|i| if i < $d { state.q[i] } else { state.v[i - $d] })
            }

            #[inline(always)]
            fn reward(&self, _: &State<T, $d>, action: &[T; $d], after: &State<T, $d>) -> T {
                let [position, velocity, effort] =
                    [self.position, self.velocity, self.effort].map(T::from_f64);
                let cost = |i: usize| {
                    let (q, v, u) = (after.q[i], after.v[i], action[i]);
                    position * (q * q) + velocity * (v * v) + effort * (u * u)
                };
                -sum::<T, $d>(cost)
            }

            #[inline(always)]
            fn terminated(&self, after: &State<T, $d>) -> bool {
                let bound = T::from_f64(self.bound);
                let mut beyond = false;
                for i in 0..$d {
                    beyond |= (after.q[i] > bound) | (after.q[i] < -bound);
                }
                beyond
            }
        }
    };
}

regulate!(1, 2);
regulate!(2, 4);

/// To stand a pendulum on its head, which hangs at `q = 0`: seen are the cosine and the sine of its angle and its velocity, and
/// a step pays `cos q − 1 − r·v² − e·u²` of the angle from the top. It is never over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingUp {
    /// `r`, the price of a velocity squared.
    pub velocity: f64,
    /// `e`, that of a command squared.
    pub effort: f64,
}

impl<T: Float + Elementary> Task<T, 1, 3> for SwingUp {
    #[inline(always)]
    fn observe(&self, &State { q: [q], v: [v] }: &State<T, 1>) -> [T; 3] {
        [-Elementary::cos(q), -Elementary::sin(q), v]
    }

    #[inline(always)]
    fn reward(&self, _: &State<T, 1>, &[u]: &[T; 1], after: &State<T, 1>) -> T {
        let (velocity, effort) = (T::from_f64(self.velocity), T::from_f64(self.effort));
        let v = after.v[0];
        -Elementary::cos(after.q[0]) - T::one() - velocity * (v * v) - effort * (u * u)
    }

    #[inline(always)]
    fn terminated(&self, _: &State<T, 1>) -> bool {
        false
    }
}
