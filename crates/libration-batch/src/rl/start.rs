//! Initial states of episodes.

use core::array::from_fn;

use libration_core::control::clock::{Jittered, Skewed};
use libration_core::control::error::ensure_finite;
use libration_core::control::{Clock, ControlError, Jitter, StartAddress};
use libration_core::random::{Address, Purpose};
use libration_core::{Float, State};

use crate::ensemble::InstructionSet;

/// The address of all that is drawn for an episode once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Episode {
    /// The seed of the batch.
    pub seed: u64,
    /// The number of the environment.
    pub environment: u64,
    /// The number of earlier episodes.
    pub number: u64,
}

/// The number of draws of an episode per purpose.
const DRAWS: u64 = 64;

/// Between the epochs of an episode and those of the next: an odd number, so that all of them differ, and as far from any simple share of
/// 2⁶⁴ as can be, so that they hardly ever come near each other.
const EPISODE_STRIDE: u64 = 0x9E37_79B9_7F4A_7C15;

impl Episode {
    /// The address of its `i`-th draw for a purpose.
    #[inline(always)]
    pub(super) fn address(self, purpose: Purpose, i: usize) -> Address {
        let Episode { seed, environment: trajectory, number } = self;
        let step = number.wrapping_mul(DRAWS).wrapping_add(i as u64);
        Address { seed, trajectory, step, purpose }
    }

    /// The address of the words that follow each other in one of its epochs. Those of the first episode are those of a trajectory.
    pub(super) fn epoch(self, purpose: Purpose, epoch: u64) -> Address {
        let Episode { seed, environment: trajectory, number } = self;
        let step = number.wrapping_mul(EPISODE_STRIDE).wrapping_add(epoch);
        Address { seed, trajectory, step, purpose }
    }

    /// The length of its steps in units of the nominal one under a clock with this skew and without jitter, as clocks
    /// `(Skewed, Jittered)` draw it.
    pub fn clock_rate<T: Float>(self, skew: Jitter) -> T {
        let begin = StartAddress::new(self.seed, self.environment, self.number);
        let ([rate], _) = (Skewed(skew), Jittered(Jitter::Gaussian(0.0))).start(begin);
        rate
    }

    /// Its start uniform in these ranges of positions, then of velocities.
    pub fn start_within<T: Float>(self, ranges: &[[f64; 2]]) -> Vec<T> {
        let mut start = Vec::with_capacity(ranges.len());
        uniform::start(self, ranges, InstructionSet::Baseline, |_, x| start.push(x));
        start
    }

    /// Fails to compile if an episode has fewer than `draws` addresses.
    pub(super) const fn assert_draws(draws: usize) {
        assert!(draws as u64 <= DRAWS, "more numbers than an episode has addresses");
    }
}

/// The distribution of the initial states of episodes.
pub trait Start<T: Float, const D: usize>: Copy + Send + Sync {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The initial state of an episode.
    fn draw(&self, episode: Episode) -> State<T, D>;
}

/// The same initial state for every episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedStart<const D: usize>(
    /// The start.
    pub State<f64, D>,
);

impl<T: Float, const D: usize> Start<T, D> for FixedStart<D> {
    fn check(&self) -> Result<(), ControlError> {
        self.0.coordinates().try_for_each(|x| ensure_finite::<T>("coordinate of the start", x))
    }

    fn draw(&self, _: Episode) -> State<T, D> {
        self.0.map(T::from_f64)
    }
}

/// Initial states uniform between two corners, each coordinate independently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformStart<const D: usize>(
    /// The lower ends.
    pub State<f64, D>,
    /// The upper ends.
    pub State<f64, D>,
);

impl<T: Float, const D: usize> Start<T, D> for UniformStart<D> {
    fn check(&self) -> Result<(), ControlError> {
        uniform::check("width of the start", self.0.coordinates().zip(self.1.coordinates()))?;
        self.0.coordinates().try_for_each(|x| ensure_finite::<T>("lower end of the start", x))?;
        self.1.coordinates().try_for_each(|x| ensure_finite::<T>("upper end of the start", x))
    }

    fn draw(&self, episode: Episode) -> State<T, D> {
        let positions = uniform::shares::<D>(episode, Purpose::Start, 0);
        let velocities = uniform::shares::<D>(episode, Purpose::Start, D);
        State {
            q: from_fn(|i| uniform::at((self.0.q[i], self.1.q[i]), positions[i])),
            v: from_fn(|i| uniform::at((self.0.v[i], self.1.v[i]), velocities[i])),
        }
    }
}

/// Uniform random numbers.
pub(super) mod uniform {
    use core::array::from_fn;

    use libration_core::Float;
    use libration_core::control::ControlError;
    use libration_core::random::Purpose;

    use super::{Episode, InstructionSet};
    use crate::ensemble::Loop;

    /// Returns an error unless every lower end is at most its upper one.
    pub(in crate::rl) fn check(
        name: &'static str,
        ends: impl IntoIterator<Item = (f64, f64)>,
    ) -> Result<(), ControlError> {
        for (index, (low, high)) in ends.into_iter().enumerate() {
            if !(low <= high && (high - low).is_finite()) {
                let (value, allowed) = (high - low, "a finite number of at least 0");
                return Err(ControlError { name, index: Some(index), value, allowed });
            }
        }
        Ok(())
    }

    /// `N` uniform numbers from 0 to 1, from draw number `first` on.
    pub(in crate::rl) fn shares<const N: usize>(
        episode: Episode,
        purpose: Purpose,
        first: usize,
    ) -> [f64; N] {
        const { Episode::assert_draws(N) };
        from_fn(|i| episode.address(purpose, first + i).uniform()[0])
    }

    /// Writes a start of an episode, a number in each range.
    pub(in crate::rl) fn start<T: Float>(
        episode: Episode,
        ranges: &[[f64; 2]],
        instructions: InstructionSet,
        mut to: impl FnMut(usize, T),
    ) {
        for (first, ranges) in ranges.chunks(TOGETHER).enumerate() {
            let first = first * TOGETHER;
            let shares: [f64; TOGETHER] = match ranges.iter().all(|[low, high]| low == high) {
                true => [0.0; TOGETHER],
                false => instructions.vectorize(Starts { episode, first }),
            };
            for (i, (&[low, high], share)) in ranges.iter().zip(shares).enumerate() {
                // The sum makes -0 what the product of the other arm makes of it.
                let fixed = || T::from_f64(low + 0.0);
                to(first + i, if low == high { fixed() } else { at((low, high), share) });
            }
        }
    }

    /// Numbers of a start that are drawn together.
    const TOGETHER: usize = 4;

    /// Shares of the ranges of a start from one on.
    struct Starts {
        episode: Episode,
        first: usize,
    }

    impl Loop for Starts {
        type Output = [f64; TOGETHER];

        #[inline(always)]
        fn run(self) -> [f64; TOGETHER] {
            let mut shares = [0.0; TOGETHER];
            for (i, share) in shares.iter_mut().enumerate() {
                *share = self.episode.address(Purpose::Start, self.first + i).uniform()[0];
            }
            shares
        }
    }

    /// The number at this share of the range.
    pub(in crate::rl) fn at<T: Float>((low, high): (f64, f64), share: f64) -> T {
        T::from_f64(low + share * (high - low))
    }
}
