//! Systems whose implicit steps can be solved.

use crate::array::each;
use crate::elimination::solve;
use crate::number::Dual;
use crate::{Elementary, Scalar, State, System};

/// A system with the derivatives of its acceleration, and the solutions of the linear equations that an implicit step has.
///
/// The equations are those of the system and not of the method, so that a method has one definition for systems of any size and for
/// every way to solve them. [`Differentiated`] is any system that runs on dual numbers.
pub trait ImplicitSystem<S: Scalar, const D: usize>: System<S, D> {
    /// The derivative of the acceleration at `at` along `direction`.
    fn acceleration_derivative(&self, at: &State<S, D>, direction: &State<S, D>) -> [S; D];

    /// The `x` with `x − h·(∂a/∂v)x = right`, the derivative taken at `at`.
    fn solve_damping(&self, at: &State<S, D>, h: S, right: [S; D]) -> [S; D];

    /// The `x` with `x − h·(∂a/∂v)x − h²·(∂a/∂q)x = right`, the derivatives taken at `at`.
    fn solve_damping_and_stiffness(&self, at: &State<S, D>, h: S, right: [S; D]) -> [S; D];

    /// The `y` with `y − h·Jy = right`, where `J` is the derivative of the [rate](System::rate) at `at`.
    #[inline]
    fn solve_rate(&self, at: &State<S, D>, h: S, right: State<S, D>) -> State<S, D> {
        solve_motion(self, at, h, right)
    }
}

/// [`ImplicitSystem::solve_rate`] of a system whose velocities are the rates of its positions: positions follow from velocities, so that
/// there are `D` equations and not `2D`.
#[inline]
pub fn solve_motion<S: Scalar, const D: usize>(
    system: &(impl ImplicitSystem<S, D> + ?Sized),
    at: &State<S, D>,
    h: S,
    right: State<S, D>,
) -> State<S, D> {
    let positions = State { q: right.q, v: [S::zero(); D] };
    let change = system.acceleration_derivative(at, &positions);
    let v = each(|i| right.v[i] + h * change[i]);
    let v = system.solve_damping_and_stiffness(at, h, v);
    State { q: each(|i| right.q[i] + h * v[i]), v }
}

/// A system on dual numbers, as a system on their parts whose implicit steps are solved by [elimination](crate::elimination).
#[derive(Clone, Copy, Debug)]
pub struct Differentiated<T>(pub T);

impl<T> Differentiated<T> {
    fn acceleration_along<S: Elementary, const D: usize>(
        &self,
        at: &State<S, D>,
        direction: &State<S, D>,
    ) -> [Dual<S>; D]
    where
        T: System<Dual<S>, D>,
    {
        let dual = |re: &[S; D], du: &[S; D]| {
            let mut all = [Dual::constant(S::zero()); D];
            all.iter_mut().zip(re.iter().zip(du)).for_each(|(x, (&re, &du))| *x = Dual { re, du });
            all
        };
        let state = State { q: dual(&at.q, &direction.q), v: dual(&at.v, &direction.v) };
        self.0.acceleration(&state)
    }

    /// The `x` with `x − Wx = right`, where `Wx` is the derivative along positions `of_q·x` and velocities `of_v·x`.
    fn solve<S: Elementary, const D: usize>(
        &self,
        at: &State<S, D>,
        [of_q, of_v]: [S; 2],
        mut right: [S; D],
    ) -> [S; D]
    where
        T: System<Dual<S>, D>,
    {
        let mut matrix = [[S::zero(); D]; D];
        for j in 0..D {
            let mut direction = State::origin();
            direction.q[j] = of_q;
            direction.v[j] = of_v;
            let column = self.acceleration_along(at, &direction);
            for (i, row) in matrix.iter_mut().enumerate() {
                let unit = if i == j { S::one() } else { S::zero() };
                row[j] = unit - column[i].du;
            }
        }
        solve(matrix.as_flattened_mut(), &mut right);
        right
    }
}

impl<S: Elementary, const D: usize, T: System<Dual<S>, D>> System<S, D> for Differentiated<T> {
    const POSITIONAL: bool = T::POSITIONAL;

    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        let accelerations = self.acceleration_along(state, &State::origin());
        each(|i| accelerations[i].re)
    }
}

impl<S: Elementary, const D: usize, T: System<Dual<S>, D>> ImplicitSystem<S, D>
    for Differentiated<T>
{
    fn acceleration_derivative(&self, at: &State<S, D>, direction: &State<S, D>) -> [S; D] {
        let accelerations = self.acceleration_along(at, direction);
        each(|i| accelerations[i].du)
    }

    fn solve_damping(&self, at: &State<S, D>, h: S, right: [S; D]) -> [S; D] {
        self.solve(at, [S::zero(), h], right)
    }

    fn solve_damping_and_stiffness(&self, at: &State<S, D>, h: S, right: [S; D]) -> [S; D] {
        self.solve(at, [h * h, h], right)
    }
}
