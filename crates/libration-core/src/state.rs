//! A point in phase space, and the vector-space operations on it.

use core::ops::Add;

use crate::array::{self, each};
use crate::{Scalar, System};

/// Position `q` and velocity `v` of a system with `D` degrees of freedom.
///
/// The same type holds a rate of change `(q̇, v̇)`: phase space is a vector space here, and its
/// tangent vectors have its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S, const D: usize> {
    /// Generalised positions.
    pub q: [S; D],
    /// Generalised velocities.
    pub v: [S; D],
}

/// `x + h·y`, element by element.
#[inline(always)]
fn axpy<S: Scalar, const D: usize>(x: [S; D], h: S, y: [S; D]) -> [S; D] {
    each(|i| x[i] + h * y[i])
}

impl<S: Scalar, const D: usize> State<S, D> {
    /// The origin of phase space.
    #[inline(always)]
    pub fn origin() -> Self {
        State { q: [S::zero(); D], v: [S::zero(); D] }
    }

    /// `self + h·rate`.
    #[inline(always)]
    pub fn plus(self, h: S, rate: Self) -> Self {
        State { q: axpy(self.q, h, rate.q), v: axpy(self.v, h, rate.v) }
    }

    /// `v += h·a(q, v)`: the flow of the potential energy.
    #[inline(always)]
    pub fn kick(self, system: &impl System<S, D>, h: S) -> Self {
        self.kicked(system.acceleration(&self), h)
    }

    /// `v += h·acceleration`: [`State::kick`] where the acceleration is known.
    #[inline(always)]
    pub fn kicked(self, acceleration: [S; D], h: S) -> Self {
        State { v: axpy(self.v, h, acceleration), ..self }
    }

    /// `q += h·v`: the flow of the kinetic energy.
    #[inline(always)]
    pub fn drift(self, h: S) -> Self {
        State { q: axpy(self.q, h, self.v), ..self }
    }

    /// `2·self`, exactly.
    #[inline(always)]
    pub fn doubled(self) -> Self {
        self + self
    }

    /// The same point on another number type.
    #[inline(always)]
    pub fn map<T: Scalar>(self, f: impl Fn(S) -> T) -> State<T, D> {
        State { q: array::map(self.q, &f), v: array::map(self.v, &f) }
    }

    /// The coordinates `q₀ … q_{D−1}, v₀ … v_{D−1}`.
    pub fn coordinates(&self) -> impl Iterator<Item = S> + Clone + '_ {
        self.q.iter().chain(&self.v).copied()
    }
}

impl<S: Scalar, const D: usize> Add for State<S, D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        State { q: each(|i| self.q[i] + other.q[i]), v: each(|i| self.v[i] + other.v[i]) }
    }
}
