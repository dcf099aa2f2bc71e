//! Observations as arrays, in the float type of the engine or rounded to `float32`.

use libration::Float;
use libration::ensemble::{InstructionSet, Loop};
use numpy::ndarray::{Dim, Dimension};
use pyo3::prelude::*;

use crate::array::{Array, Number, ReusedArray, allocate, lies_in, reuse_or_allocate, view_mut};

/// Memory for observations that are rounded before anybody sees them; none where they are not.
#[derive(Debug)]
pub(crate) struct Rounding {
    exact: Vec<f64>,
    is_on: bool,
}

impl Rounding {
    pub(crate) fn new(is_on: bool) -> Self {
        Rounding { exact: Vec::new(), is_on }
    }

    /// Whether numbers of this type are rounded.
    pub(crate) fn applies<T: Number>(&self) -> bool {
        self.is_on && size_of::<T>() > size_of::<f32>()
    }

    /// Room for numbers of the engine.
    pub(crate) fn room<T: Number>(&mut self, len: usize) -> &mut [T] {
        self.exact.resize(self.exact.len().max(len), 0.0);
        &mut bytemuck::cast_slice_mut(&mut self.exact)[..len]
    }

    /// A new array `(n,)` of what the engine wrote into the room.
    pub(crate) fn array<'py, T: Number>(
        &self,
        py: Python<'py>,
        len: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        array_of::<T, 1>(py, &bytemuck::cast_slice(&self.exact)[..len], [len], self)
    }
}

/// An array of observations, `[n, i]`.
pub(crate) enum Observations<'py, T> {
    /// Of the engine's float type.
    Exact(Bound<'py, Array<T, 2>>),
    /// Rounded.
    Rounded(Bound<'py, Array<f32, 2>>),
}

impl<'py, T: Number> Observations<'py, T> {
    /// The kept array, or a new one; see [`reuse_or_allocate`].
    pub(crate) fn reused(
        py: Python<'py>,
        kept: &mut Option<ReusedArray>,
        shape: [usize; 2],
        shared: bool,
        rounding: &Rounding,
    ) -> PyResult<Self> {
        Ok(match rounding.applies::<T>() {
            true => Observations::Rounded(reuse_or_allocate(py, kept, shape, shared)?),
            false => Observations::Exact(reuse_or_allocate(py, kept, shape, shared)?),
        })
    }

    /// Whether these numbers are of its memory.
    pub(crate) fn has(&self, numbers: &[T]) -> bool {
        match self {
            Observations::Exact(array) => lies_in(numbers, array),
            Observations::Rounded(array) => lies_in(numbers, array),
        }
    }

    /// What the engine fills, `len` numbers.
    pub(crate) fn target<'a>(&'a self, len: usize, rounding: &'a mut Rounding) -> &'a mut [T] {
        match self {
            Observations::Exact(array) => view_mut(array),
            Observations::Rounded(_) => rounding.room(len),
        }
    }

    /// The array, with what the engine filled.
    pub(crate) fn filled(self, len: usize, rounding: &mut Rounding) -> Bound<'py, PyAny> {
        match self {
            Observations::Exact(array) => array.into_any(),
            Observations::Rounded(array) => {
                round(rounding.room::<T>(len), view_mut(&array));
                array.into_any()
            }
        }
    }
}

/// A new array with these numbers.
pub(crate) fn array_of<'py, T: Number, const N: usize>(
    py: Python<'py>,
    numbers: &[T],
    shape: [usize; N],
    rounding: &Rounding,
) -> PyResult<Bound<'py, PyAny>>
where
    Dim<[usize; N]>: Dimension,
{
    if rounding.applies::<T>() {
        let array: Bound<'py, Array<f32, N>> = allocate(py, shape)?;
        round(numbers, view_mut(&array));
        return Ok(array.into_any());
    }
    let array: Bound<'py, Array<T, N>> = allocate(py, shape)?;
    view_mut(&array).copy_from_slice(numbers);
    Ok(array.into_any())
}

/// Writes the nearest `f32` of each number.
fn round<T: Number>(numbers: &[T], to: &mut [f32]) {
    InstructionSet::widest().vectorize(Round { numbers, to });
}

struct Round<'a, T> {
    numbers: &'a [T],
    to: &'a mut [f32],
}

impl<T: Float> Loop for Round<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.to.iter_mut().zip(self.numbers).for_each(|(to, x)| *to = x.to_f64() as f32);
    }
}
