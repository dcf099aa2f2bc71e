//! Values that are shared by trajectories, or listed per trajectory.

/// A value for every trajectory of an ensemble: [one for all](All) or [one per trajectory](PerTrajectory).
pub trait Assign<X>: Copy + Send + Sync {
    /// The values of a block of `W` neighbouring trajectories.
    type Lanes<const W: usize>: Copy;

    /// Whether it is the same for all.
    const UNIFORM: bool = false;

    /// The values of the `count` trajectories from `first` on; lanes beyond repeat the last.
    fn lanes<const W: usize>(self, first: usize, count: usize) -> Self::Lanes<W>;

    /// The value in lane `l`.
    fn lane<const W: usize>(lanes: &Self::Lanes<W>, l: usize) -> X;

    /// The value of trajectory `n`.
    fn of(self, n: usize) -> X;

    /// The number of trajectories for which there is a value, unless there is one for all.
    fn count(self) -> Option<usize>;
}

/// The same value for all trajectories.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct All<X>(pub X);

/// One value per trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerTrajectory<'a, X>(pub &'a [X]);

impl<X: Copy + Send + Sync> Assign<X> for All<X> {
    type Lanes<const W: usize> = X;

    const UNIFORM: bool = true;

    #[inline(always)]
    fn lanes<const W: usize>(self, _: usize, _: usize) -> X {
        self.0
    }

    #[inline(always)]
    fn lane<const W: usize>(&lanes: &X, _: usize) -> X {
        lanes
    }

    #[inline(always)]
    fn of(self, _: usize) -> X {
        self.0
    }

    #[inline(always)]
    fn count(self) -> Option<usize> {
        None
    }
}

impl<X: Copy + Send + Sync> Assign<X> for PerTrajectory<'_, X> {
    type Lanes<const W: usize> = [X; W];

    #[inline(always)]
    fn lanes<const W: usize>(self, first: usize, count: usize) -> [X; W] {
        padded(&self.0[first..first + count])
    }

    #[inline(always)]
    fn lane<const W: usize>(lanes: &[X; W], l: usize) -> X {
        lanes[l]
    }

    #[inline(always)]
    fn of(self, n: usize) -> X {
        self.0[n]
    }

    #[inline(always)]
    fn count(self) -> Option<usize> {
        Some(self.0.len())
    }
}

/// The values, of which there is at least one and there are at most `W`, and then the last again.
#[inline(always)]
pub(super) fn padded<X: Copy, const W: usize>(values: &[X]) -> [X; W] {
    match values.try_into() {
        Ok(&whole) => whole,
        Err(_) => {
            let mut lanes = [values[values.len() - 1]; W];
            lanes[..values.len()].copy_from_slice(values);
            lanes
        }
    }
}
