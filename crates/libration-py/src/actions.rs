//! Actions from Python, as numbers of the engine.

use libration::Float;
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use crate::array::{Number, are_finite, contiguous_actions, helper};
use crate::error::value_error;

static ACTIONS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
static CHOICES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// Calls `work` with the actions of environments, an array of shape `[len, width]`, all of them finite. `levels` are the commands of discrete
/// actions, or empty.
///
/// # Errors
/// A `TypeError` or a `ValueError` that names the first action that is not allowed, or the error of `work`.
pub(crate) fn with_actions<T: Number, R>(
    given: &Bound<'_, PyAny>,
    levels: &[f64],
    shape: [usize; 2],
    work: impl FnOnce(&[T]) -> PyResult<R>,
) -> PyResult<R> {
    let no_array = || PyTypeError::new_err("actions are no array");
    if levels.is_empty() {
        if let Some(actions) = contiguous_actions::<T>(given, shape) {
            return work(finite(actions, shape[1])?);
        }
        // What action spaces of Gymnasium sample.
        if let Some(actions) = contiguous_actions::<f32>(given, shape) {
            let actions: Vec<T> = actions.iter().map(|&x| T::from_f64(x.into())).collect();
            return work(finite(&actions, shape[1])?);
        }
        let made = helper(given.py(), &ACTIONS, "actions")?.call1((given, shape, T::NUMPY))?;
        let actions = contiguous_actions::<T>(&made, shape).ok_or_else(no_array)?;
        return work(finite(actions, shape[1])?);
    }
    if shape[0] == 1
        && let Some(command) = command::<T>(given, levels)?
    {
        return work(&[command]);
    }
    if let Some(commands) = commands::<T>(given, levels, shape[0]) {
        return work(&commands);
    }
    let levels = levels.to_vec();
    let made =
        helper(given.py(), &CHOICES, "choices")?.call1((given, shape[0], levels, T::NUMPY))?;
    work(contiguous_actions::<T>(&made, shape).ok_or_else(no_array)?)
}

/// The actions, if all of them are finite.
fn finite<T: Number>(actions: &[T], width: usize) -> PyResult<&[T]> {
    if are_finite(actions) {
        return Ok(actions);
    }
    let n = actions.iter().position(|action| !action.is_finite()).unwrap_or(0);
    let index = match width {
        1 => n.to_string(),
        width => format!("{}, {}", n / width, n % width),
    };
    Err(value_error(format!("actions[{index}] is {:?}, but it must be finite", actions[n])))
}

/// The command of an integer; none of what is no integer of an action.
fn command<T: Float>(given: &Bound<'_, PyAny>, levels: &[f64]) -> PyResult<Option<T>> {
    match given.extract::<usize>() {
        Ok(i) => Ok(levels.get(i).map(|&level| T::from_f64(level))),
        Err(error) => {
            let py = given.py();
            let is_other = error.is_instance_of::<PyTypeError>(py)
                || error.is_instance_of::<PyOverflowError>(py);
            if is_other { Ok(None) } else { Err(error) }
        }
    }
}

/// The commands of an array of so many integers, if it has the type of NumPy's integers and each is a discrete action.
fn commands<T: Float>(given: &Bound<'_, PyAny>, levels: &[f64], len: usize) -> Option<Vec<T>> {
    let array = given.cast_exact::<PyArray1<i64>>().ok().filter(|array| array.len() == len)?;
    let chosen = array.try_readonly().ok()?;
    let chosen = chosen.as_slice().ok()?;
    let most = levels.len() as u64;
    // A negative number is a large one without its sign.
    if chosen.iter().fold(false, |beyond, &i| beyond | (i as u64 >= most)) {
        return None;
    }
    let levels: Vec<T> = levels.iter().map(|&level| T::from_f64(level)).collect();
    Some(match levels[..] {
        // Several at once.
        [low, high] => chosen.iter().map(|&i| if i == 0 { low } else { high }).collect(),
        _ => chosen.iter().map(|&i| levels[i as usize]).collect(),
    })
}
