//! States and numbers of episodes as arrays.

use libration::control::Jitter;
use libration::rl::EnvironmentError;
use libration_env::environments::AnyEnvironments;
use pyo3::prelude::*;

use crate::array::{Array, Number, allocate, view_mut};

/// The states at these places among positions and velocities.
pub(crate) fn states<'py, T: Number>(
    py: Python<'py>,
    environments: &dyn AnyEnvironments<T>,
    len: usize,
    places: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let width = places.len();
    let all: Bound<'py, Array<T, 2>> = allocate(py, [len, width])?;
    for (n, row) in view_mut(&all).chunks_exact_mut(width).enumerate() {
        let state = environments.state(n).unwrap_or_default();
        row.iter_mut().zip(places).for_each(|(x, &place)| *x = state[place]);
    }
    Ok(all.into_any())
}

/// Puts environments at states.
pub(crate) fn put_states<T: Number>(
    environments: &mut dyn AnyEnvironments<T>,
    places: &[usize],
    rows: impl Iterator<Item = (usize, Vec<f64>)>,
) -> Result<(), EnvironmentError> {
    for (n, row) in rows {
        let mut state = environments.state(n).unwrap_or_default();
        places.iter().zip(row).for_each(|(&place, x)| state[place] = T::from_f64(x));
        environments.set_state(n, &state)?;
    }
    Ok(())
}

/// What is drawn of each episode, of times of answers that so many steps ahead; at last the rate of its clock under this skew.
pub(crate) fn episode_numbers<'py, T: Number>(
    py: Python<'py>,
    environments: &dyn AnyEnvironments<T>,
    skew: Jitter,
    ahead: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let row = |n| {
        let mut row = environments.episode_numbers(n, ahead)?;
        row.push(environments.episode(n)?.clock_rate(skew));
        Some(row)
    };
    let rows: Vec<Vec<T>> = (0..environments.len()).filter_map(row).collect();
    let width = rows.first().map_or(0, Vec::len);
    let all: Bound<'py, Array<T, 2>> = allocate(py, [rows.len(), width])?;
    let to = view_mut(&all).iter_mut();
    to.zip(rows.iter().flatten()).for_each(|(to, &x)| *to = x);
    Ok(all.into_any())
}
