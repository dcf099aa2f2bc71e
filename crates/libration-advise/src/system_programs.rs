//! The programs by which the motion of a system is simulated.

use std::sync::OnceLock;

use libration::equations::{Degree, Dynamics};
use libration::integrator::Exact;
use libration::number::Dual;
use libration::{AnyMethod, Float, Method, Scalar, Trajectory, TrajectoryProgram};
use libration_settings::equations::EquationSystem;

use super::integrator_choice::offered_methods;

/// A function that writes the accelerations of a state.
pub(super) type Accelerations<'a> = Box<dyn FnMut(&[f64], &mut [f64]) + 'a>;

/// A function of the energy of a state.
pub(super) type Energy<'a> = Box<dyn FnMut(&[f64]) -> f64 + 'a>;

/// A function that writes the derivatives of the accelerations at a state by the coordinate at a place.
pub(super) type Slopes<'a> = Box<dyn FnMut(&[f64], usize, &mut [f64]) + 'a>;

/// A trajectory, step by step.
pub(super) trait Steps {
    /// Positions, then velocities, after another step.
    fn next(&mut self) -> &[f64];
}

impl Steps for Trajectory<f64> {
    fn next(&mut self) -> &[f64] {
        self.step()
    }
}

/// Steps in another float type.
struct RoundedSteps<S> {
    trajectory: Trajectory<S>,
    shown: Vec<f64>,
}

impl<S: Float> Steps for RoundedSteps<S> {
    fn next(&mut self) -> &[f64] {
        let RoundedSteps { trajectory, shown } = self;
        shown.iter_mut().zip(trajectory.step()).for_each(|(to, x)| *to = x.to_f64());
        shown
    }
}

/// Exact steps of a linear system: a matrix, row by row, and a constant.
struct MatrixSteps {
    matrix: Vec<f64>,
    constant: Vec<f64>,
    state: Vec<f64>,
    next: Vec<f64>,
}

impl MatrixSteps {
    /// The steps from `start` of which `step` takes one from any state.
    fn new(start: &[f64], mut step: impl FnMut(&[f64]) -> Vec<f64>) -> Self {
        let mut state = vec![0.0; start.len()];
        let constant = step(&state);
        let mut matrix = vec![0.0; start.len() * start.len()];
        for column in 0..start.len() {
            state[column] = 1.0;
            let moved = step(&state);
            state[column] = 0.0;
            for (row, (x, constant)) in moved.iter().zip(&constant).enumerate() {
                matrix[row * start.len() + column] = x - constant;
            }
        }
        MatrixSteps { matrix, constant, state: start.to_vec(), next: start.to_vec() }
    }
}

impl Steps for MatrixSteps {
    fn next(&mut self) -> &[f64] {
        let MatrixSteps { matrix, constant, state, next } = self;
        let rows = matrix.chunks_exact(state.len()).zip(&*constant);
        for (next, (row, constant)) in next.iter_mut().zip(rows) {
            *next = constant + row.iter().zip(&*state).map(|(a, x)| a * x).sum::<f64>();
        }
        std::mem::swap(state, next);
        state
    }
}

/// The programs of a system whose inputs are zero. States are positions, then velocities, in one list.
pub(super) struct SystemPrograms<'a> {
    dynamics: &'a Dynamics,
    states: Vec<usize>,
    depends_on_time: bool,
    exact_rate: Option<f64>,
    /// The steps of [all offered methods](offered_methods), of those that were needed.
    steps: Vec<(Method, OnceLock<TrajectoryProgram>)>,
    /// A part of an exact step.
    exact: OnceLock<TrajectoryProgram>,
}

/// Operations of the accelerations above which a step takes several times as long as one of a small system.
const FEW_OPERATIONS: usize = 16;

impl<'a> SystemPrograms<'a> {
    pub(super) fn new(system: &'a EquationSystem) -> Self {
        SystemPrograms {
            dynamics: system.equations.dynamics(),
            // Other places only carry time or an integral.
            states: system.states.iter().map(|state| state.place).collect(),
            depends_on_time: system.equations.degrees().contains(&Degree::Time),
            exact_rate: system.fastest_rate(),
            steps: offered_methods(true).map(|method| (method, OnceLock::new())).collect(),
            exact: OnceLock::new(),
        }
    }

    /// Degrees of freedom.
    pub(super) fn degrees(&self) -> usize {
        self.dynamics.degrees()
    }

    /// The places of the states that are compared, rising.
    pub(super) fn states(&self) -> &[usize] {
        &self.states
    }

    /// The most steps of a run, and of one that is compared with finer steps: a search takes hundreds of runs.
    pub(super) fn most_steps(&self) -> [f64; 2] {
        match self.dynamics.accelerations().operations() <= FEW_OPERATIONS {
            true => [2e7, 1e6],
            false => [2e6, 2e5],
        }
    }

    /// Whether accelerations depend on positions alone: elsewhere splitting methods lose their order.
    pub(super) fn is_positional(&self) -> bool {
        self.dynamics.is_positional()
    }

    /// The method with the smaller error of those with code of their own that are of order four on this system.
    pub(super) fn reference_method(&self) -> Method {
        if self.is_positional() { Method::Suzuki4 } else { Method::Rk4 }
    }

    /// The largest angle of an exact step of a second, of a linear system, in rad.
    pub(super) fn exact_rate(&self) -> Option<f64> {
        self.exact_rate
    }

    /// The accelerations.
    pub(super) fn accelerations(&self) -> Accelerations<'_> {
        let mut accelerations = self.dynamics.accelerations().on::<f64>();
        Box::new(move |state, to| {
            to.iter_mut().zip(accelerations.run(state)).for_each(|(to, x)| *to = x);
        })
    }

    /// The derivatives of the accelerations.
    pub(super) fn slopes(&self) -> Slopes<'_> {
        let mut accelerations = self.dynamics.accelerations().on::<Dual<f64>>();
        let mut inputs = Vec::new();
        Box::new(move |state, place, to| {
            inputs.clear();
            inputs.extend(state.iter().map(|&x| Dual::constant(x)));
            inputs[place].du = 1.0;
            to.iter_mut().zip(accelerations.run(&inputs)).for_each(|(to, x)| *to = x.du);
        })
    }

    /// Whether accelerations depend on time, which is no compared state.
    pub(super) fn depends_on_time(&self) -> bool {
        self.depends_on_time
    }

    /// Whether accelerations have no kinks and jumps.
    pub(super) fn is_smooth(&self) -> bool {
        self.dynamics.accelerations().is_smooth()
    }

    /// The energy, if there is one.
    pub(super) fn energy(&self) -> Option<Energy<'_>> {
        let mut energy = self.dynamics.energy()?.on::<f64>();
        Some(Box::new(move |state| energy.run(state).next().unwrap_or(f64::NAN)))
    }

    /// Steps of an integrator in `f32` or `f64`.
    pub(super) fn steps(
        &self,
        is_narrow: bool,
        method: Method,
        dt: f64,
        start: &[f64],
    ) -> Box<dyn Steps> {
        let place = self.steps.iter().position(|&(other, _)| other == method).unwrap_or_default();
        let (method, program) = &self.steps[place];
        let program = program
            .get_or_init(|| TrajectoryProgram::new(AnyMethod::Explicit(*method), self.dynamics));
        if !is_narrow {
            return Box::new(program.begin(start, dt, 1));
        }
        let narrow: Vec<f32> = start.iter().map(|&x| f32::from_f64(x)).collect();
        let trajectory = program.begin(&narrow, f32::from_f64(dt), 1);
        Box::new(RoundedSteps { trajectory, shown: start.to_vec() })
    }

    /// Exact steps, of a linear system; none where a step turns too far.
    pub(super) fn exact_steps(&self, dt: f64, start: &[f64]) -> Option<Box<dyn Steps>> {
        let exact = Exact::of_angle(self.exact_rate? * dt.abs())?;
        let program = self.exact.get_or_init(|| TrajectoryProgram::exact(exact, self.dynamics));
        let (_, parts) = exact.parts();
        let step = |state: &[f64]| program.begin(state, dt, parts).step().to_vec();
        Some(Box::new(MatrixSteps::new(start, step)))
    }
}
