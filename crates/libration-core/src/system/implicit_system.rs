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
    /// Whether the rate is linear and its numbers are exact, so that a step with irrational coefficients ends after its first Newton step.
    ///
    /// It is exact and has rational coefficients. On floats it stays false, so that a step has the same operations on all systems.
    const IS_EXACTLY_LINEAR: bool = false;

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

    /// The `x` with `xᵢ − Σⱼ(of_qᵢⱼ·∂a/∂q + of_vᵢⱼ·∂a/∂v)xⱼ = rightᵢ` for `N` coupled stages `i`, the derivatives taken at `atᵢ`.
    fn solve_stage_accelerations<const N: usize>(
        &self,
        at: &[State<S, D>; N],
        of: StageCoefficients<'_, S, N>,
        right: [[S; D]; N],
    ) -> [[S; D]; N];

    /// The `y` with `yᵢ − Σⱼ hᵢⱼ·Jᵢyⱼ = rightᵢ` for `N` coupled stages `i`, where `Jᵢ` is the derivative of the [rate](System::rate) at
    /// `atᵢ`.
    #[inline]
    fn solve_stages<const N: usize>(
        &self,
        at: &[State<S, D>; N],
        h: &[[S; N]; N],
        right: [State<S, D>; N],
    ) -> [State<S, D>; N] {
        solve_stage_motion(self, at, h, right)
    }
}

/// The coefficients of the coupled equations of accelerations.
#[derive(Clone, Copy, Debug)]
pub struct StageCoefficients<'a, S, const N: usize> {
    /// Those of the derivatives by positions, stage by stage.
    pub of_q: &'a [[S; N]; N],
    /// Those of the derivatives by velocities, stage by stage.
    pub of_v: &'a [[S; N]; N],
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

/// [`ImplicitSystem::solve_stages`] of a system whose velocities are the rates of its positions: `N·D` equations and not `2N·D`.
#[inline]
pub fn solve_stage_motion<S: Scalar, const D: usize, const N: usize>(
    system: &(impl ImplicitSystem<S, D> + ?Sized),
    at: &[State<S, D>; N],
    h: &[[S; N]; N],
    mut right: [State<S, D>; N],
) -> [State<S, D>; N] {
    let mut squares = [[S::zero(); N]; N];
    let mut velocities = [[S::zero(); D]; N];
    for i in 0..N {
        squares[i] = each(|j| (0..N).fold(S::zero(), |sum, k| sum + h[i][k] * h[k][j]));
        let along = each(|d| (0..N).fold(S::zero(), |sum, j| sum + h[i][j] * right[j].q[d]));
        let positions = State { q: along, v: [S::zero(); D] };
        let change = system.acceleration_derivative(&at[i], &positions);
        velocities[i] = each(|d| right[i].v[d] + change[d]);
    }
    let of = StageCoefficients { of_q: &squares, of_v: h };
    let velocities = system.solve_stage_accelerations(at, of, velocities);
    for (stage, h) in right.iter_mut().zip(h) {
        stage.q = each(|d| (0..N).fold(stage.q[d], |sum, j| sum + h[j] * velocities[j][d]));
    }
    for (stage, v) in right.iter_mut().zip(velocities) {
        stage.v = v;
    }
    right
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

    fn solve_stage_accelerations<const N: usize>(
        &self,
        at: &[State<S, D>; N],
        of: StageCoefficients<'_, S, N>,
        mut right: [[S; D]; N],
    ) -> [[S; D]; N] {
        // Rows: stages, then degrees of freedom; columns: the same.
        let mut matrix = [[[[S::zero(); D]; N]; D]; N];
        for (i, rows) in matrix.iter_mut().enumerate() {
            for j in 0..D {
                let (mut along_q, mut along_v) = (State::origin(), State::origin());
                along_q.q[j] = S::one();
                along_v.v[j] = S::one();
                let by_q = self.acceleration_along(&at[i], &along_q);
                let by_v = self.acceleration_along(&at[i], &along_v);
                for (d, row) in rows.iter_mut().enumerate() {
                    for (k, entries) in row.iter_mut().enumerate() {
                        let unit = if i == k && d == j { S::one() } else { S::zero() };
                        let change = of.of_q[i][k] * by_q[d].du + of.of_v[i][k] * by_v[d].du;
                        entries[j] = unit - change;
                    }
                }
            }
        }
        let matrix = matrix.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        solve(matrix, right.as_flattened_mut());
        right
    }
}
