//! A force that is computed in another precision than the state.

use core::fmt;
use core::marker::PhantomData;

use super::System;
use crate::{Float, State};

/// A system whose acceleration is evaluated on floats `F`, whatever the state is made of.
///
/// The state is rounded to `F`, and the acceleration rounded from there to the number of the state: what a program
/// does that keeps positions in double and computes forces in single precision, or the other way round. It has no
/// energy; that is for the system on the numbers of the state.
pub struct MixedPrecision<Sys, F> {
    system: Sys,
    float: PhantomData<fn() -> F>,
}

impl<Sys, F> MixedPrecision<Sys, F> {
    /// `system`, which is one on numbers of type `F`.
    pub fn new(system: Sys) -> Self {
        MixedPrecision { system, float: PhantomData }
    }
}

// Derived, these would ask the same of `F`, of which there is no value.
impl<Sys: Copy, F> Copy for MixedPrecision<Sys, F> {}

impl<Sys: Clone, F> Clone for MixedPrecision<Sys, F> {
    fn clone(&self) -> Self {
        MixedPrecision::new(self.system.clone())
    }
}

impl<Sys: fmt::Debug, F: Float> fmt::Debug for MixedPrecision<Sys, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} in {}", self.system, F::NAME)
    }
}

impl<Sys, F, S, const D: usize> System<S, D> for MixedPrecision<Sys, F>
where
    Sys: System<F, D>,
    F: Float,
    S: Float,
{
    const POSITIONAL: bool = Sys::POSITIONAL;
    const REGISTERS: usize = Sys::REGISTERS + 2 * D;

    #[inline(always)]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        let rounded = state.map(|x| F::from_f64(x.to_f64()));
        self.system.acceleration(&rounded).map(|a| S::from_f64(a.to_f64()))
    }
}

#[cfg(test)]
mod tests {
    use half::f16;

    use super::*;
    use crate::integrator::{Rk4, VelocityVerlet};
    use crate::system::{Oscillator, Pendulum};
    use crate::{Integrator, Model};

    #[test]
    fn a_force_in_the_precision_of_the_state_changes_no_bit() {
        let system: Pendulum<f32> = Model::<1>::on(&Pendulum { omega2: 9.81 });
        let same = MixedPrecision::<_, f32>::new(system);
        let mut alike = [State { q: [2.5_f32], v: [-0.3] }; 2];
        for _ in 0..1000 {
            alike[0] = Rk4.step(&system, alike[0], 0.01);
            alike[1] = Rk4.step(&same, alike[1], 0.01);
            assert_eq!(alike[0], alike[1]);
        }
    }

    #[test]
    fn a_force_in_single_precision_is_that_of_the_rounded_state() {
        let single = MixedPrecision::<_, f32>::new(Oscillator { omega2: 10.1_f32 });
        let state = State { q: [0.3_f64], v: [1.0] };
        let [a] = single.acceleration(&state);
        assert_eq!(a, f64::from(-10.1_f32 * 0.3_f32));
        let [wide] = Oscillator { omega2: 10.1 }.acceleration(&state);
        // Three roundings of a number near 3, half an ulp each.
        assert!(a != wide && (a - wide).abs() < 3.0 * f64::from(f32::EPSILON));
    }

    #[test]
    fn a_force_in_double_precision_is_rounded_once() {
        let double = MixedPrecision::<_, f64>::new(Oscillator { omega2: 10.1 });
        let q = f16::from_f32(0.3);
        let [a] = double.acceleration(&State { q: [q], v: [q] });
        assert_eq!(a.to_f64(), f16::from_f64(-10.1 * q.to_f64()).to_f64());
        let next = VelocityVerlet.step(&double, State { q: [q], v: [q] }, f16::from_f32(0.01));
        assert!(next.coordinates().all(Float::is_finite));
    }
}
