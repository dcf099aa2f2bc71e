//! Where episodes begin.

use core::array::from_fn;

use crate::control::ControlError;
use crate::random::{Address, Purpose};
use crate::{Float, State};

/// The start of every episode of every environment.
pub trait Start<T: Float, const D: usize>: Copy + Send + Sync {
    /// Whether its numbers are those of a start.
    ///
    /// # Errors
    /// The first that is not.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// Where episode number `episode` of `environment` begins.
    fn draw(&self, seed: u64, environment: u64, episode: u64) -> State<T, D>;
}

/// Always there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At<const D: usize>(
    /// The start.
    pub State<f64, D>,
);

impl<T: Float, const D: usize> Start<T, D> for At<D> {
    fn draw(&self, _: u64, _: u64, _: u64) -> State<T, D> {
        self.0.map(T::from_f64)
    }
}

/// Anywhere between two corners, each coordinate uniformly and by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between<const D: usize>(
    /// The lower ends.
    pub State<f64, D>,
    /// The upper ends.
    pub State<f64, D>,
);

/// Draws of an episode that have an address of their own, of two numbers each.
const DRAWS: u64 = 64;

impl<T: Float, const D: usize> Start<T, D> for Between<D> {
    fn check(&self) -> Result<(), ControlError> {
        let ends = self.0.coordinates().zip(self.1.coordinates());
        for (index, (low, high)) in ends.enumerate() {
            if !(low <= high && (high - low).is_finite()) {
                let (name, allowed) = ("width of the start", "a finite number of at least 0");
                return Err(ControlError { name, index: Some(index), value: high - low, allowed });
            }
        }
        Ok(())
    }

    fn draw(&self, seed: u64, environment: u64, episode: u64) -> State<T, D> {
        let shares: [[f64; 2]; D] = from_fn(|i| {
            let step = episode * DRAWS + i as u64;
            Address { seed, trajectory: environment, step, purpose: Purpose::Start }.uniform()
        });
        let between = |low: f64, high: f64, share: f64| T::from_f64(low + share * (high - low));
        State {
            q: from_fn(|i| between(self.0.q[i], self.1.q[i], shares[i][0])),
            v: from_fn(|i| between(self.0.v[i], self.1.v[i], shares[i][1])),
        }
    }
}
