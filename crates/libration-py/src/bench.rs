//! What benchmarks set beside the package: the same work without Python.

use std::time::Instant;

use libration::rl::Outcome;
use pyo3::prelude::*;

use crate::array::Number;
use crate::error::Raised;
use crate::held::{Held, Table, with_table};
use crate::settings::Settings;

/// Seconds that so many steps take under actions of zero, in memory that is used again.
#[pyfunction]
pub(crate) fn _seconds_of_steps(py: Python<'_>, settings: Settings, steps: usize) -> PyResult<f64> {
    let (recipe, execution) = (settings.recipe()?, settings.execution()?);
    let (len, single) = (settings.num_envs, settings.single()?);
    py.detach(|| {
        let mut held = Held::new(&recipe, single, len, &execution).map_err(Raised::raised)?;
        with_table!(&mut held, table => timed(&mut **table, len, steps))
    })
}

fn timed<T: Number>(table: &mut dyn Table<T>, len: usize, steps: usize) -> PyResult<f64> {
    let seeds: Vec<Option<u64>> = (0..len as u64).map(Some).collect();
    table.seed(&seeds).map_err(Raised::raised)?;
    let actions = vec![T::zero(); len];
    let (mut seen, mut reward) = (vec![T::zero(); len * table.observations()], actions.clone());
    let (mut terminated, mut truncated) = (vec![0; len], vec![0; len]);
    let start = Instant::now();
    for _ in 0..steps {
        let to = Outcome {
            seen: &mut seen,
            reward: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        table.act(&actions, to).map_err(Raised::raised)?;
    }
    Ok(start.elapsed().as_secs_f64())
}
