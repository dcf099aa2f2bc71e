//! Methods that solve one set of linear equations in each step.

use super::ImplicitIntegrator;
use super::newton::increment;
use crate::array::each;
use crate::system::ImplicitSystem;
use crate::{Scalar, State};

/// Symplectic Euler with implicit damping: `v' = v + h(1 − h·∂a/∂v)⁻¹ a(q, v)`, `q' = q + h·v'`. Order 1.
///
/// MuJoCo's integrators `Euler`, for the damping of joints, and `implicitfast`, for all forces that depend on velocities (MuJoCo
/// documentation, Computation, Numerical integration). Springs stay explicit: on `q̈ = −ω²q − 2ζωv` it is stable for
/// `ωh < 2(ζ + √(1 + ζ²))`, symplectic Euler for `ωh < 2(√(1 + ζ²) − ζ)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct DampingImplicit;

impl ImplicitIntegrator for DampingImplicit {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let acceleration = system.acceleration(&state);
        state.kicked(system.solve_damping(&state, dt, acceleration), dt).drift(dt)
    }
}

/// Linearly implicit Euler: `v' = v + h(1 − h·∂a/∂v − h²·∂a/∂q)⁻¹(a + h·(∂a/∂q)v)`, `q' = q + h·v'`. Order 1.
///
/// It is the first Newton step of [`BackwardEuler`](super::BackwardEuler), and the same on linear systems. E. Hairer, G. Wanner: Solving
/// Ordinary Differential Equations II, 2nd ed., §IV.7 and §IV.9; D. Baraff, A. Witkin: Large Steps in Cloth Simulation, SIGGRAPH 1998.
#[derive(Clone, Copy, Debug, Default)]
pub struct DampingStiffnessImplicit;

impl ImplicitIntegrator for DampingStiffnessImplicit {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        state + increment(system, state, dt, 1)
    }
}

/// Stable PD: `v' = v + h(1 − h·∂a/∂v)⁻¹(a + h·(∂a/∂q)v)`, `q' = q + h·v'`. Order 1.
///
/// J. Tan, K. Liu, G. Turk: Stable Proportional-Derivative Controllers, IEEE Computer Graphics and Applications 31(4), 2011. They take
/// the torque of a PD controller at the next position `q + h·v` and the next velocity `v + h·q̈`, and solve
/// `q̈ = (M + h·K_d)⁻¹(−K_p(q + h·v − q̄) − K_d·v + τ)` for the acceleration. Here all forces of the system are treated as they treat that
/// torque, with their derivatives at the state: a spring is a `K_p`, a damper a `K_d`. Forces that depend on neither positions nor
/// velocities stay explicit, as theirs.
///
/// The formula is one of accelerations; positions move with the new velocity, as in most simulators. On `q̈ = −ω²q − 2ζωv` it then is
/// stable for `ωh < ⅔(ζ + √(3 + ζ²))`, which is less than [`DampingImplicit`] allows: the predicted position costs stability. (With
/// `q' = q + h·v` the limit would be `2(ζ + √(1 + ζ²))`.)
#[derive(Clone, Copy, Debug, Default)]
pub struct StablePd;

impl ImplicitIntegrator for StablePd {
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl ImplicitSystem<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let acceleration = system.acceleration(&state);
        let velocity = State { q: state.v, v: [S::zero(); D] };
        let change = system.acceleration_derivative(&state, &velocity);
        let next = each(|i| acceleration[i] + dt * change[i]);
        state.kicked(system.solve_damping(&state, dt, next), dt).drift(dt)
    }
}
