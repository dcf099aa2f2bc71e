//! Work without Python, as a reference for benchmarks of the package.

use std::time::Instant;

use libration::rl::{EnvironmentError, Plan, ProgramPolicy, StepBuffers};
use libration_env::environments::AnyEnvironments;
use pyo3::prelude::*;

use crate::any_batch::{AnyBatch, with_batch};
use crate::array::Number;
use crate::error::Raised;
use crate::policy::{Policy, PolicyRequest};
use crate::settings::Settings;

/// Seconds that so many steps take under actions of zero, in memory that is used again.
#[pyfunction]
pub(crate) fn _seconds_of_steps(py: Python<'_>, settings: Settings, steps: usize) -> PyResult<f64> {
    let (len, mut batch) = (settings.num_envs, settings.batch()?);
    py.detach(|| with_batch!(&mut batch, environments => timed(&mut **environments, len, steps)))
}

/// Seconds of each of so many rollouts under a policy, into memory that is used again.
#[pyfunction]
pub(crate) fn _seconds_of_rollouts(
    py: Python<'_>,
    settings: Settings,
    policy: PolicyRequest<'_>,
    horizon: usize,
    rollouts: usize,
) -> PyResult<Vec<f64>> {
    fn each<T: Number>(
        environments: &mut dyn AnyEnvironments<T>,
        acts: &Policy<T>,
        plan: Plan,
        rollouts: usize,
    ) -> Result<Vec<f64>, EnvironmentError> {
        let mut tensors = environments.new_rollout(plan)?;
        let seeds: Vec<Option<u64>> = (0..plan.environments as u64).map(Some).collect();
        environments.seed(&seeds)?;
        let timed = |_| {
            let start = Instant::now();
            let policy = acts.sized(environments.sizes()[1]);
            environments.fill(policy, &mut *tensors, 0..plan.horizon)?;
            Ok(start.elapsed().as_secs_f64())
        };
        (0..rollouts).map(timed).collect()
    }
    let plan = Plan::new(horizon, settings.num_envs).truncated();
    let done = match settings.batch()? {
        AnyBatch::F32(mut environments) => {
            let acts = Policy::new(&policy)?;
            py.detach(|| each(&mut *environments, &acts, plan, rollouts))
        }
        AnyBatch::F64(mut environments) => {
            let acts = Policy::new(&policy)?;
            py.detach(|| each(&mut *environments, &acts, plan, rollouts))
        }
    };
    done.map_err(Raised::raised)
}

fn timed<T: Number>(
    environments: &mut dyn AnyEnvironments<T>,
    len: usize,
    steps: usize,
) -> PyResult<f64> {
    let seeds: Vec<Option<u64>> = (0..len as u64).map(Some).collect();
    environments.seed(&seeds).map_err(Raised::raised)?;
    let [observations, actions] = environments.sizes();
    let actions = vec![T::zero(); len * actions];
    let (mut seen, mut reward) = (vec![T::zero(); len * observations], vec![T::zero(); len]);
    let (mut terminated, mut truncated) = (vec![0; len], vec![0; len]);
    let start = Instant::now();
    for _ in 0..steps {
        let to = StepBuffers {
            seen: &mut seen,
            reward: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        environments.act(ProgramPolicy::ActionSequence(&actions), to).map_err(Raised::raised)?;
    }
    Ok(start.elapsed().as_secs_f64())
}
