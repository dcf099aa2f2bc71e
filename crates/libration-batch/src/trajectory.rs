//! One trajectory by the program of a step.

use libration_core::integrator::Exact;
use libration_core::{AnyMethod, Float};
use libration_equations::{Dynamics, StepProgram};

use crate::machine::{Lane, MachineStep};

/// A trajectory of a system without commands, in steps of equal length.
///
/// The program of the step is made for the machine of ensembles and runs on single numbers. The trajectory has the bits of the
/// program, and those of a compiled system with the same operations.
#[derive(Debug)]
pub struct Trajectory<S> {
    lane: Lane<S>,
    dt: S,
    /// Runs of the program for a step.
    parts: u64,
    step: u64,
    states: usize,
    /// Inputs of the system.
    commands: usize,
    /// The rows before the last steps.
    before: Vec<S>,
}

/// The program of a step, by which trajectories of a system begin anywhere, in steps of any length, in any float type.
#[derive(Debug)]
pub struct TrajectoryProgram {
    step: MachineStep,
    degrees: usize,
    /// Inputs of the system.
    commands: usize,
    /// Inputs of the program before the time step.
    inputs: usize,
}

impl TrajectoryProgram {
    /// A step of a method.
    pub fn new(method: AnyMethod, dynamics: &Dynamics) -> Self {
        TrajectoryProgram::of_step(MachineStep::new(method, dynamics, true), dynamics)
    }

    /// A part of an exact step of a linear system.
    pub fn exact(exact: Exact, dynamics: &Dynamics) -> Self {
        let (part, _) = exact.parts();
        let program = StepProgram::new(part, dynamics);
        TrajectoryProgram::of_step(MachineStep::of_program(&program, dynamics.degrees()), dynamics)
    }

    fn of_step(step: MachineStep, dynamics: &Dynamics) -> Self {
        let inputs = step.inputs(dynamics);
        let (degrees, commands) = (dynamics.degrees(), dynamics.inputs());
        TrajectoryProgram { step, degrees, commands, inputs }
    }

    /// A trajectory from positions and velocities, in steps of `dt` seconds that are so many equal parts: 1 for a method, and
    /// [as many](Exact::parts) as it has for an exact step.
    pub fn begin<S: Float>(&self, start: &[S], dt: S, parts: i32) -> Trajectory<S> {
        let states = 2 * self.degrees;
        let mut inputs = vec![S::zero(); self.inputs];
        inputs.push(dt.ratio(1, parts));
        let mut lane = Lane::new(&self.step.step, &inputs);
        lane.rows_mut()[..states].copy_from_slice(&start[..states]);
        if let Some(first) = &self.step.first {
            let mut first = Lane::new(first, &inputs);
            first.rows_mut()[..states].copy_from_slice(&start[..states]);
            first.run(1, 0);
            let known = states..states + self.degrees;
            lane.rows_mut()[known.clone()].copy_from_slice(&first.rows()[known]);
        }
        Trajectory {
            lane,
            dt,
            parts: parts as u64,
            step: 0,
            states,
            commands: self.commands,
            before: Vec::new(),
        }
    }
}

impl<S: Float> Trajectory<S> {
    /// From positions and velocities, as many as `dynamics` has, in steps of `dt` seconds.
    pub fn new(method: AnyMethod, dynamics: &Dynamics, start: &[S], dt: S) -> Self {
        TrajectoryProgram::new(method, dynamics).begin(start, dt, 1)
    }

    /// The same in exact steps of a linear system.
    pub fn exact(exact: Exact, dynamics: &Dynamics, start: &[S], dt: S) -> Self {
        let (_, parts) = exact.parts();
        TrajectoryProgram::exact(exact, dynamics).begin(start, dt, parts)
    }

    /// Takes a step, also one whose numbers are not finite. Returns positions and velocities.
    pub fn step(&mut self) -> &[S] {
        self.lane.run(self.parts, 0);
        self.step += 1;
        self.state()
    }

    /// Takes so many steps, or fewer if a number of the state would not be finite: the trajectory stays before that step. Returns whether
    /// all steps were taken.
    pub fn advance(&mut self, steps: u64) -> bool {
        self.before.clear();
        self.before.extend_from_slice(self.lane.rows());
        let done = self.lane.run(steps.saturating_mul(self.parts), self.states) / self.parts;
        if done < steps {
            // The same steps again, but for the last.
            self.lane.rows_mut().copy_from_slice(&self.before);
            self.lane.run(done * self.parts, self.states);
        }
        self.step += done;
        done == steps
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Time since the start in s: a product, never a running sum.
    pub fn time(&self) -> f64 {
        self.time_of(self.step)
    }

    /// The time of a step in s.
    pub fn time_of(&self, step: u64) -> f64 {
        step as f64 * self.dt.to_f64()
    }

    /// The inputs of the program of a step: positions and velocities, the inputs of the system, which are zero, and the time step.
    pub fn inputs(&self) -> Vec<S> {
        let mut inputs = self.state().to_vec();
        inputs.resize(self.states + self.commands, S::zero());
        inputs.push(self.dt);
        inputs
    }

    /// Positions and velocities.
    pub fn state(&self) -> &[S] {
        &self.lane.rows()[..self.states]
    }
}
