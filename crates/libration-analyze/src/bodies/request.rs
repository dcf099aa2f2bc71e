//! Requests for simulations of bodies.

use libration::bodies::{BodiesError, BodyIntegrator, BodySimulation};
use libration::ensemble::Execution;
use libration_settings::bodies_file::NamedBodies;

/// Bodies, their integrator and time step.
#[derive(Clone, Debug)]
pub struct BodiesRequest {
    /// The bodies.
    pub system: NamedBodies,
    /// The integrator.
    pub integrator: BodyIntegrator,
    /// The time step in the units of the system.
    pub dt: f64,
    /// Number of steps, at least 1.
    pub steps: u64,
    /// Steps from sample to sample: the start, every such step and the last are sampled. None for at most 1000 samples that take little time.
    pub every: Option<u64>,
    /// Whether positions and velocities keep what their sums round off.
    pub is_compensated: bool,
    /// Whether steps follow the encounters; `dt` is then the first.
    pub is_adaptive: bool,
    /// Whether a second run with twice the time step predicts the changes by the order: half of the time again.
    pub is_predicted: bool,
    /// Where the sums over pairs run.
    pub execution: Execution,
}

/// Samples of a motion without `every`.
const SAMPLES: u64 = 1000;

/// Evaluations of all forces that a sample takes: accelerations, potentials and distances.
const EVALUATIONS_OF_A_SAMPLE: u64 = 4;

/// Bodies from which on a sample takes so long that samples are limited to a tenth of the time.
const MANY_BODIES: usize = 64;

impl BodiesRequest {
    /// The simulation at its start with this time step.
    ///
    /// # Errors
    /// [`BodiesError`]: an invalid time step, or bodies to which the integrator does not apply.
    pub(super) fn simulation(&self, dt: f64) -> Result<BodySimulation, BodiesError> {
        let bodies = self.system.bodies.clone();
        let execution = self.execution.clone();
        let simulation =
            BodySimulation::new(bodies, self.integrator, dt, self.is_compensated, execution)?;
        if self.is_adaptive { simulation.adaptive() } else { Ok(simulation) }
    }

    /// Number of rows: one for each body of each sample.
    pub fn rows(&self) -> u64 {
        let samples = self.steps.div_ceil(self.stride()).saturating_add(1);
        samples.saturating_mul(self.system.bodies.count() as u64)
    }

    /// Steps from sample to sample.
    pub(super) fn stride(&self) -> u64 {
        self.every.map(|every| every.max(1)).unwrap_or_else(|| {
            let few = self.steps.div_ceil(SAMPLES);
            match self.system.bodies.count() >= MANY_BODIES {
                true => {
                    let evaluations = self.integrator.evaluations() as u64;
                    few.max((10 * EVALUATIONS_OF_A_SAMPLE).div_ceil(evaluations))
                }
                false => few,
            }
        })
    }
}
