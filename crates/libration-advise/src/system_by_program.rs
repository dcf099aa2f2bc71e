//! Systems by their programs.

use std::sync::OnceLock;

use libration::equations::{Degree, Dynamics, Evaluation, StepProgram};
use libration::number::Dual;
use libration::{Float, Method};
use libration_settings::equations::EquationSystem;

use super::integrator_choice::offered_methods;
use super::simulated_system::{Accelerations, Energy, SimulatedSystem, Slopes, Steps};

/// A system by its program, whose inputs are zero.
pub(super) struct SystemByProgram<'a> {
    dynamics: &'a Dynamics,
    states: Vec<usize>,
    depends_on_time: bool,
    /// The steps of [all offered methods](offered_methods), of those that were asked for.
    steps: Vec<(Method, OnceLock<StepProgram>)>,
}

impl<'a> SystemByProgram<'a> {
    pub(super) fn new(system: &'a EquationSystem) -> Self {
        let dynamics = system.equations.dynamics();
        SystemByProgram {
            dynamics,
            // Other places only carry time or an integral.
            states: system.states.iter().map(|state| state.place).collect(),
            depends_on_time: system.equations.degrees().contains(&Degree::Time),
            steps: offered_methods(true).map(|method| (method, OnceLock::new())).collect(),
        }
    }

    fn steps_on<S: Float>(&self, method: Method, dt: f64, start: &[f64]) -> ProgramSteps<'_, S> {
        let place = self.steps.iter().position(|&(other, _)| other == method).unwrap_or_default();
        let (method, step) = &self.steps[place];
        let step = step.get_or_init(|| StepProgram::new(*method, self.dynamics));
        let mut inputs: Vec<S> = start.iter().map(|&x| S::from_f64(x)).collect();
        inputs.resize(start.len() + self.dynamics.inputs(), S::zero());
        inputs.push(S::from_f64(dt));
        ProgramSteps { step: step.program().on(), inputs, next: Vec::new(), shown: start.to_vec() }
    }
}

impl SimulatedSystem for SystemByProgram<'_> {
    fn degrees(&self) -> usize {
        self.dynamics.degrees()
    }

    fn states(&self) -> &[usize] {
        &self.states
    }

    fn most_steps(&self) -> [f64; 2] {
        // A step by a program takes several times as long as a compiled one.
        [2e6, 2e5]
    }

    fn is_positional(&self) -> bool {
        self.dynamics.is_positional()
    }

    fn exact_rate(&self) -> Option<f64> {
        None
    }

    fn accelerations(&self) -> Accelerations<'_> {
        let mut accelerations = self.dynamics.accelerations().on::<f64>();
        Box::new(move |state, to| {
            to.iter_mut().zip(accelerations.run(state)).for_each(|(to, x)| *to = x);
        })
    }

    fn slopes(&self) -> Slopes<'_> {
        let mut accelerations = self.dynamics.accelerations().on::<Dual<f64>>();
        let mut inputs = Vec::new();
        Box::new(move |state, place, to| {
            inputs.clear();
            inputs.extend(state.iter().map(|&x| Dual::constant(x)));
            inputs[place].du = 1.0;
            to.iter_mut().zip(accelerations.run(&inputs)).for_each(|(to, x)| *to = x.du);
        })
    }

    fn depends_on_time(&self) -> bool {
        self.depends_on_time
    }

    fn is_smooth(&self) -> bool {
        self.dynamics.accelerations().is_smooth()
    }

    fn energy(&self) -> Option<Energy<'_>> {
        let mut energy = self.dynamics.energy()?.on::<f64>();
        Some(Box::new(move |state| energy.run(state).next().unwrap_or(f64::NAN)))
    }

    fn steps(
        &self,
        is_narrow: bool,
        method: Method,
        dt: f64,
        start: &[f64],
    ) -> Box<dyn Steps + '_> {
        match is_narrow {
            true => Box::new(self.steps_on::<f32>(method, dt, start)),
            false => Box::new(self.steps_on::<f64>(method, dt, start)),
        }
    }

    fn exact_steps(&self, _: f64, _: &[f64]) -> Option<Box<dyn Steps + '_>> {
        None
    }
}

struct ProgramSteps<'p, S> {
    step: Evaluation<'p, S>,
    /// Positions, velocities, inputs and the time step.
    inputs: Vec<S>,
    next: Vec<S>,
    shown: Vec<f64>,
}

impl<S: Float> Steps for ProgramSteps<'_, S> {
    fn next(&mut self) -> &[f64] {
        let ProgramSteps { step, inputs, next, shown } = self;
        next.clear();
        next.extend(step.run(inputs));
        inputs[..next.len()].copy_from_slice(next);
        shown.iter_mut().zip(&*next).for_each(|(to, x)| *to = x.to_f64());
        shown
    }
}
