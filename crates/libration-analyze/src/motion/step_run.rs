//! A motion under steps of one length.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::equations::StepProgram;

use crate::AnalyzeError;

/// Steps between two checks of the stop flag.
const CHUNK: u64 = 1 << 12;

/// A motion under steps of one length.
pub(crate) struct StepRun<'a> {
    /// Positions, velocities and inputs.
    pub(crate) start: &'a [f64],
    pub(crate) step: &'a StepProgram,
    pub(crate) dt: f64,
    /// Steps that take the time of one of the request.
    pub(crate) substeps: u64,
}

impl StepRun<'_> {
    /// Shows positions and velocities with the inputs after each step of the request, until one is not finite.
    pub(crate) fn follow(
        &self,
        steps: u64,
        stop: &AtomicBool,
        mut show: impl FnMut(u64, &[f64]),
    ) -> Result<(), AnalyzeError> {
        let mut run = self.step.program().on::<f64>();
        let mut inputs = self.start.to_vec();
        let last = inputs.len();
        inputs.push(self.dt);
        let mut next = Vec::with_capacity(last);
        for step in 1..=steps {
            if step % CHUNK == 0 && stop.load(Ordering::Relaxed) {
                return Err(AnalyzeError::Interrupted);
            }
            for _ in 0..self.substeps {
                next.clear();
                next.extend(run.run(&inputs));
                inputs[..next.len()].copy_from_slice(&next);
            }
            show(step, &inputs[..last]);
            if next.iter().any(|x| !x.is_finite()) {
                break;
            }
        }
        Ok(())
    }
}
