//! One step as a matrix, in 1024 bits.

use libration_core::Scalar;
use libration_core::number::{Dual, Wide};
use libration_equations::{Dynamics, Program, StepProgram};

use super::LinearMap;
use super::exponential::exponential;

/// A system and one step of an integrator on it, linearised about a state.
///
/// For a linear system the matrices are the maps themselves, whatever the state. They carry 1024
/// bits, so that differences such as `det M − 1` have all the digits of an `f64` left.
#[derive(Clone, Debug)]
pub struct Linearisation {
    /// The Jacobian `A` of the rate of change `(q̇, v̇)`.
    pub generator: LinearMap,
    /// The Jacobian `M` of one step.
    pub step: LinearMap,
    /// The Jacobian of a step of `−Δt` from where the step ends.
    pub back: LinearMap,
    /// The time step in seconds.
    pub dt: Wide,
}

impl Linearisation {
    /// A step of `dt` seconds about the state `at`: positions, velocities and inputs.
    pub fn new(step: &StepProgram, dynamics: &Dynamics, at: &[f64], dt: f64) -> Self {
        let (at, dt) = (wide(at), Wide::from_f64(dt));
        let states = 2 * dynamics.degrees();
        let program = step.program();
        let with = |state: &[Wide], h: Wide| [state, &at[states..], &[h]].concat();
        let start = with(&at[..states], dt);
        let end: Vec<Wide> = program.on::<Wide>().run(&start).collect();
        Linearisation {
            generator: rates(dynamics, &at),
            step: jacobian(program, &start, states),
            back: jacobian(program, &with(&end, -dt), states),
            dt,
        }
    }

    /// Exact steps of `dt` seconds of a linear system, by the exponential of the generator.
    pub fn exact(dynamics: &Dynamics, at: &[f64], dt: f64) -> Self {
        let generator = rates(dynamics, &wide(at));
        let dt = Wide::from_f64(dt);
        let flow = |t: Wide| LinearMap::of_rows(&exponential(&generator.rows(), t));
        Linearisation { step: flow(dt), back: flow(-dt), generator, dt }
    }

    /// `‖M(−Δt)·M(Δt) − 1‖` in the Frobenius norm: zero for a time-reversible method.
    pub fn reversibility_defect(&self) -> Wide {
        self.back.after(&self.step).distance_from_identity()
    }
}

fn wide(state: &[f64]) -> Vec<Wide> {
    state.iter().map(|&x| Wide::from_f64(x)).collect()
}

/// The Jacobian of the rate of change `(v, a)`.
fn rates(dynamics: &Dynamics, at: &[Wide]) -> LinearMap {
    let degrees = dynamics.degrees();
    let forces = derivatives(dynamics.accelerations(), at, 2 * degrees);
    let unit = |i, j| if degrees + i == j { Wide::one() } else { Wide::ZERO };
    let column =
        |(j, force): (usize, Vec<Wide>)| (0..degrees).map(|i| unit(i, j)).chain(force).collect();
    LinearMap::of_columns(forces.into_iter().enumerate().map(column).collect())
}

fn jacobian(program: &Program, at: &[Wide], states: usize) -> LinearMap {
    LinearMap::of_columns(derivatives(program, at, states))
}

/// The derivatives of all outputs by each of the first inputs.
fn derivatives(program: &Program, at: &[Wide], inputs: usize) -> Vec<Vec<Wide>> {
    let mut run = program.on::<Dual<Wide>>();
    let mut seeded: Vec<Dual<Wide>> = at.iter().copied().map(Dual::constant).collect();
    let mut column = |j: usize| {
        seeded[j] = Dual::variable(at[j]);
        let column = run.run(&seeded).map(|x| x.du).collect();
        seeded[j] = Dual::constant(at[j]);
        column
    };
    (0..inputs).map(&mut column).collect()
}
