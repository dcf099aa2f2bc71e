//! The step of an integrator as operations on whole vectors.

use libration_core::integrator::ImplicitIntegrator;
use libration_core::thermostat::{LangevinMethod, LangevinStep};
use libration_core::{Integrator, State, System};

use super::step_trace::{StepTrace, TracedSystem, TracedVector, VectorId, VectorOperation};

/// An exact flow of a part of the system, for a part of the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flow {
    /// `v += h·a(q)`.
    Kick(f64),
    /// `q += h·v`.
    Drift(f64),
}

/// A step as operations on vectors of positions, velocities and accelerations, whatever their length.
#[derive(Clone, Debug, PartialEq)]
pub struct VectorStep {
    operations: Vec<VectorOperation>,
    ends: Vec<VectorId>,
}

impl VectorStep {
    /// A step of length `dt`; without a length the time step is an [input](VectorOperation::TimeStep).
    pub fn new(integrator: impl Integrator, dt: Option<f64>) -> Self {
        VectorStep::record(|system, start, trace| {
            let end = integrator.step(system, start, time_step(trace, dt));
            vec![end.q[0], end.v[0]]
        })
    }

    /// The same of an integrator that solves equations.
    pub(crate) fn implicit(integrator: impl ImplicitIntegrator) -> Self {
        VectorStep::record(|system, start, trace| {
            let end = integrator.step(system, start, time_step(trace, None));
            vec![end.q[0], end.v[0]]
        })
    }

    /// A step from positions, velocities and [accelerations](VectorOperation::Accelerations) to those at its end. It has the bits of
    /// [`new`](Self::new) where accelerations depend on positions alone.
    ///
    /// None if the integrator [carries](Integrator::CARRIES) no acceleration from step to step.
    pub fn carrying<M: Integrator>(integrator: M, dt: Option<f64>) -> Option<Self> {
        M::CARRIES.then(|| {
            VectorStep::record(|system, start, trace| {
                let known = [trace.record(VectorOperation::Accelerations)];
                let dt = time_step(trace, dt);
                let (end, known) = integrator.carried(system, start, known, dt);
                vec![end.q[0], end.v[0], known[0]]
            })
        })
    }

    /// A step of Langevin dynamics from positions, velocities and accelerations to those at its end, with [numbers](VectorOperation::Number)
    /// and [noise](VectorOperation::Noise).
    pub(crate) fn langevin(method: &LangevinMethod) -> Self {
        let mut step = VectorStep::record(|system, start, trace| {
            let dt = time_step(trace, None);
            let [decay, damping, implicit_factor] =
                [0, 1, 2].map(|i| trace.record(VectorOperation::Number(i)));
            let noise: Vec<_> =
                (0..method.noises()).map(|i| [trace.record(VectorOperation::Noise(i))]).collect();
            let numbers = LangevinStep { dt, decay, damping, implicit_factor };
            let end = method.step(system, start, numbers, &noise);
            let [known] = system.acceleration(&end);
            vec![end.q[0], end.v[0], known]
        });
        for i in 0..step.operations.len() {
            if let VectorOperation::AccelerationsAt(q, _) = step.operations[i]
                && step.operations[q] == VectorOperation::Positions
            {
                step.operations[i] = VectorOperation::Accelerations;
            }
        }
        step
    }

    fn record(
        step: impl for<'t> FnOnce(
            &TracedSystem<'t>,
            State<TracedVector<'t>, 1>,
            &'t StepTrace,
        ) -> Vec<TracedVector<'t>>,
    ) -> Self {
        let trace = StepTrace::default();
        let ends = {
            let start = State {
                q: [trace.record(VectorOperation::Positions)],
                v: [trace.record(VectorOperation::Velocities)],
            };
            let ends = step(&TracedSystem(&trace), start, &trace);
            ends.into_iter().map(|end| trace.id(end)).collect()
        };
        VectorStep { operations: trace.into_operations(), ends }
    }

    /// The step as kicks and drifts, each with its part of the time step, if it is a sequence of them.
    pub fn flows(integrator: impl Integrator) -> Option<Vec<Flow>> {
        let step = VectorStep::new(integrator, Some(1.0));
        let operations = &step.operations;
        let (mut q, mut v) = (0, 1);
        let mut flows = Vec::new();
        // A vector and its multiple.
        let multiple = |id: VectorId| match operations[id] {
            VectorOperation::Product(a, b) => match (&operations[a], &operations[b]) {
                (VectorOperation::Constant(c), _) => Some((*c, b)),
                (_, VectorOperation::Constant(c)) => Some((*c, a)),
                _ => None,
            },
            _ => None,
        };
        for (id, operation) in operations.iter().enumerate() {
            match *operation {
                VectorOperation::Sum(start, increment) => {
                    let (part, of) = multiple(increment)?;
                    let is_kick = matches!(operations[of], VectorOperation::AccelerationsAt(at, _) if at == q);
                    if start == q && of == v {
                        flows.push(Flow::Drift(part));
                        q = id;
                    } else if start == v && is_kick {
                        flows.push(Flow::Kick(part));
                        v = id;
                    } else {
                        return None;
                    }
                }
                VectorOperation::Positions
                | VectorOperation::Velocities
                | VectorOperation::Constant(_)
                | VectorOperation::Product(..)
                | VectorOperation::AccelerationsAt(..) => {}
                _ => return None,
            }
        }
        (step.ends == [q, v]).then_some(flows)
    }

    /// The operations; each makes one vector from those before it.
    pub fn operations(&self) -> &[VectorOperation] {
        &self.operations
    }

    /// Positions and velocities at the end; of a [carrying](Self::carrying) step also the accelerations.
    pub fn ends(&self) -> &[VectorId] {
        &self.ends
    }
}

fn time_step(trace: &StepTrace, dt: Option<f64>) -> TracedVector<'_> {
    dt.map_or_else(|| trace.record(VectorOperation::TimeStep), TracedVector::Constant)
}
