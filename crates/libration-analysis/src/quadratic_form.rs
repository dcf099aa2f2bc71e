//! Quadratic forms on a phase space of one degree of freedom.

use libration_core::{Scalar, State};

use super::UpdateMatrix;

/// The quadratic form `qq·q² + 2·qv·q·v + vv·v²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraticForm<S> {
    /// Coefficient of `q²`.
    pub qq: S,
    /// Half the coefficient of `q·v`.
    pub qv: S,
    /// Coefficient of `v²`.
    pub vv: S,
}

impl<S: Scalar> QuadraticForm<S> {
    /// The form with these values, by polarisation.
    pub fn of(f: impl Fn(&State<S, 1>) -> S) -> Self {
        let (zero, one) = (S::zero(), S::one());
        let at = |q, v| f(&State { q: [q], v: [v] });
        let (qq, vv) = (at(one, zero), at(zero, one));
        QuadraticForm { qq, vv, qv: (at(one, one) - qq - vv).ratio(1, 2) }
    }

    /// The form `Q(y) = −yᵀJMy` that every `2 × 2` matrix carries along: `Q(My) = det M · Q(y)`,
    /// because `MᵀJM = det M · J`.
    ///
    /// Of a symplectic step it is conserved: up to a factor, the modified Hamiltonian (Hairer,
    /// Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §IX.3), here in closed form.
    pub fn carried_by(step: &UpdateMatrix<S>) -> Self {
        QuadraticForm {
            qq: -step.entry(1, 0),
            qv: (step.entry(0, 0) - step.entry(1, 1)).ratio(1, 2),
            vv: step.entry(0, 1),
        }
    }

    /// The value at a state.
    #[inline(always)]
    pub fn at(&self, State { q: [q], v: [v] }: &State<S, 1>) -> S {
        let cross = self.qv * *q * *v;
        self.qq * *q * *q + cross + cross + self.vv * *v * *v
    }

    /// The determinant; positive if the form is definite.
    pub fn determinant(&self) -> S {
        self.mixed(self)
    }

    /// Half the coefficient of `s·t` in `det(s·self + t·other)`.
    pub fn mixed(&self, other: &Self) -> S {
        (self.qq * other.vv + self.vv * other.qq).ratio(1, 2) - self.qv * other.qv
    }

    /// `self + r·other`.
    pub fn plus(&self, r: S, other: &Self) -> Self {
        QuadraticForm {
            qq: self.qq + r * other.qq,
            qv: self.qv + r * other.qv,
            vv: self.vv + r * other.vv,
        }
    }

    /// The same form on another number type.
    pub fn map<T>(&self, f: impl Fn(S) -> T) -> QuadraticForm<T> {
        QuadraticForm { qq: f(self.qq), qv: f(self.qv), vv: f(self.vv) }
    }
}
