//! What the definition of environments by programs must be.

use libration_core::Float;
use libration_core::control::ControlError;
use libration_core::control::error::{ensure, ensure_finite, ensure_not_negative};

use libration_equations::Program;

use super::ProgramEnvironment;
use crate::rl::start::uniform;
use crate::rl::{EnvironmentError, EpisodeNumber};

impl ProgramEnvironment {
    /// Checks what the [world](ProgramEnvironment::world) does not have, for so many environments.
    pub(super) fn check<T: Float>(&self, len: usize) -> Result<(), EnvironmentError> {
        let (degrees, inputs) = (self.dynamics.degrees(), self.dynamics.inputs());
        let parameters = self.parameters.len();
        let allowed = degrees.min(Self::MAX_DEGREES);
        EnvironmentError::shape("degrees of freedom of an environment", degrees, allowed)?;
        EnvironmentError::shape("inputs of the system", inputs, inputs.max(parameters + 1))?;
        let actions = self.actions();
        EnvironmentError::shape("ranges of the start", self.start.len(), 2 * degrees)?;
        EnvironmentError::shape("largest commands", self.saturation.len(), actions)?;
        if !self.noise.is_empty() {
            EnvironmentError::shape("laws of noise", self.noise.len(), self.observations())?;
        }
        let most = |program: &Program| program.inputs_in_use().max().map_or(0, |input| input + 1);
        for (name, found, wanted) in [
            (
                "inputs of the observation",
                most(&self.task.observation),
                2 * degrees + parameters + 1,
            ),
            (
                "inputs of the verdict",
                most(&self.task.verdict),
                4 * degrees + actions + parameters + 1,
            ),
            (
                "inputs of the inner controller",
                self.task.inner.as_ref().map_or(0, most),
                2 * degrees + parameters + actions + 1,
            ),
            (
                "inputs of the projection",
                self.task.projection.as_ref().map_or(0, most),
                4 * degrees + inputs + 1,
            ),
        ] {
            EnvironmentError::shape(name, found, found.min(wanted))?;
        }
        if let Some(answers) = &self.answers {
            answers.check::<T>(self.dt, self.substeps, self.delays)?;
            EnvironmentError::shape("lengths of steps", self.lengths.len(), 0)?;
            let [seen, judged] = self.time_inputs();
            let reads = |program: &Program, time| program.inputs_in_use().any(|i| i == time);
            // How long a system has waited is known to nothing that reads the time.
            let timed = reads(&self.task.observation, seen) || reads(&self.task.verdict, judged);
            if timed && answers.waits > 0 {
                return Err(EnvironmentError::Waits);
            }
        }
        EnvironmentError::shape("outputs of the verdict", self.task.verdict.outputs().len(), 2)?;
        if let Some(inner) = &self.task.inner {
            let outputs = inner.outputs().len();
            EnvironmentError::shape(
                "outputs of the inner controller",
                outputs,
                inputs - parameters,
            )?;
        }
        let (steps, allowed) = (f64::from(self.inner_steps), "at least 1");
        ensure("steps of the inner controller", steps, allowed, |steps| steps >= 1.0)?;
        if let Some(projection) = &self.task.projection {
            let outputs = projection.outputs().len();
            EnvironmentError::shape("outputs of the projection", outputs, 2 * degrees)?;
        }
        if !self.lengths.is_empty() {
            let substeps = self.substeps as usize;
            EnvironmentError::shape("lengths of steps", self.lengths.len(), substeps)?;
        }
        for (index, &length) in self.lengths.iter().enumerate() {
            let allowed = "a finite number above 0 in the float type";
            ensure("length of a step", length, allowed, |length| {
                T::from_f64(length) > T::zero() && T::from_f64(length).is_finite()
            })
            .map_err(|error| ControlError { index: Some(index), ..error })?;
        }
        for end in self.start.iter().flatten() {
            ensure_finite::<T>("end of the start", *end)?;
        }
        uniform::check("range of the start", self.start.iter().map(|[low, high]| (*low, *high)))?;
        let indexed = |index: usize| move |error| ControlError { index: Some(index), ..error };
        let numbers = self.numbers().count();
        EnvironmentError::shape(
            "numbers of an episode",
            numbers,
            numbers.min(EpisodeNumber::MOST),
        )?;
        for count in self.numbers().filter_map(EpisodeNumber::environments) {
            EnvironmentError::shape("numbers of the environments", count, len)?;
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            parameter.check::<T>(index)?;
        }
        for (index, most) in self.saturation.iter().enumerate() {
            let least = most.least();
            ensure("saturation", least, "above 0", |most| T::from_f64(most) > T::zero())
                .map_err(indexed(index))?;
            if most.as_constant().is_none() {
                most.check::<T>(index)?;
            }
        }
        for (index, &level) in self.levels.iter().enumerate() {
            ensure_finite::<T>("level of a command", level).map_err(indexed(index))?;
        }
        let falls = |pair: &[f64]| T::from_f64(pair[0]) >= T::from_f64(pair[1]);
        if let Some(i) = self.levels.windows(2).position(falls) {
            let (name, value) = ("level of a command", self.levels[i + 1]);
            let allowed = "above the level before it in the float type";
            return Err(ControlError { name, index: Some(i + 1), value, allowed }.into());
        }
        for (index, law) in self.noise.iter().enumerate() {
            ensure_not_negative::<T>("the rms of the noise of observation", law.rms())
                .map_err(indexed(index))?;
        }
        Ok(())
    }
}
