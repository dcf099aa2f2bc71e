//! Loops around a system by equations in place of its linearisation.

use libration::AnyMethod;
use libration::ensemble::Execution;
use libration::equations::StepProgram;
use libration::linear_loops::{LinearLoops, ProgramMotion};
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::OperatingPoint;

use super::LinearRequest;
use crate::trajectory::TrajectoryError;

impl LinearRequest {
    /// The same loop around a system of which the plant is the linearisation at `point`, from the start of the system, in steps of at most
    /// `longest_step` seconds.
    ///
    /// # Errors
    /// In words: an implicit integrator that does not take so many degrees of freedom.
    pub fn around_system(
        mut self,
        system: &EquationSystem,
        point: &OperatingPoint,
        method: AnyMethod,
        longest_step: f64,
    ) -> Result<Self, String> {
        let equations = &system.equations;
        let dynamics = match equations.inputs().is_empty() {
            true => equations.dynamics().with_added_accelerations(),
            false => equations.dynamics().clone(),
        };
        let (degrees, most) = (dynamics.degrees(), StepProgram::most_degrees(method));
        if degrees > most {
            return Err(format!(
                "--integrator {}: the system has {degrees} degrees of freedom; expected an explicit integrator for more than {most}",
                method.name()
            ));
        }
        let mut at = point.state_of(system);
        at.resize(2 * degrees + dynamics.inputs(), 0.0);
        let places: Vec<usize> = system.states.iter().map(|state| state.place).collect();
        let start = system.start();
        self.start = places.iter().map(|&place| start[place] - at[place]).collect();
        let step = StepProgram::of(method, &dynamics);
        self.motion = Some(ProgramMotion { step, operating_point: at, places, longest_step });
        Ok(self)
    }

    /// The loops of the request at their start.
    ///
    /// # Errors
    /// [`TrajectoryError`]: an invalid request, or not enough memory.
    pub fn loops(&self, execution: Execution) -> Result<LinearLoops, TrajectoryError> {
        let LinearRequest { linear, timing, record, ensemble, .. } = self;
        let count = ensemble.map_or(1, |ensemble| ensemble.count);
        let scale = |n| ensemble.map_or(1.0, |ensemble| ensemble.scale(n));
        let mut all = LinearLoops::new(linear, timing, record.as_deref(), count, execution)?;
        if let Some(motion) = &self.motion {
            all = all.with_motion(linear, motion.clone())?;
        }
        all.set_reference(&self.reference)?;
        all.set_disturbance(&self.disturbance)?;
        all.reset(self.seed, |n, i| scale(n) * self.start[i]);
        Ok(all)
    }
}
