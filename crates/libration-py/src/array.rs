//! NumPy arrays and their memory.
#![allow(unsafe_code)]

use std::ffi::c_int;
use std::ptr::null_mut;
use std::slice::{from_raw_parts, from_raw_parts_mut};

use bytemuck::{AnyBitPattern, NoUninit, Zeroable};
use libration::{Elementary, Float};
use numpy::ndarray::{ArrayView, Dim, Dimension, IntoDimension, IxDyn};
use numpy::npyffi::{NPY_ARRAY_CARRAY, NpyTypes, PY_ARRAY_API, get_type_object, npy_intp};
use numpy::{Element, PyArray, PyArrayDescrMethods, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::ffi::Py_REFCNT;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyCapsule;

use crate::error::value_error;

/// A float type of NumPy.
pub(crate) trait Number: Float + Elementary + bytemuck::Pod + Element {
    /// Name in NumPy.
    const NUMPY: &str;
}

impl Number for f32 {
    const NUMPY: &str = "float32";
}

impl Number for f64 {
    const NUMPY: &str = "float64";
}

/// A NumPy array of `N` dimensions.
pub(crate) type Array<T, const N: usize> = PyArray<T, Dim<[usize; N]>>;

/// Returns a new array, which the caller must fill.
///
/// # Errors
/// A `MemoryError` of NumPy.
pub(crate) fn allocate<'py, T: Element + Zeroable, const N: usize>(
    py: Python<'py>,
    shape: [usize; N],
) -> PyResult<Bound<'py, Array<T, N>>> {
    let mut shape = shape.map(|len| len as npy_intp);
    // SAFETY: NumPy takes over the description that it is given, reads as many lengths as it is told, and gives a contiguous array of that
    // type and shape, which belongs to nobody yet, or nothing and an exception. The numbers and flags that are made here have no
    // invalid bits, and nobody sees them before they are written.
    unsafe {
        let array = PY_ARRAY_API.PyArray_NewFromDescr(
            py,
            get_type_object(py, NpyTypes::PyArray_Type),
            T::get_dtype(py).into_dtype_ptr(),
            N as c_int,
            shape.as_mut_ptr(),
            null_mut(),
            null_mut(),
            0,
            null_mut(),
        );
        Ok(Bound::from_owned_ptr_or_err(py, array)?.cast_into_unchecked())
    }
}

/// A reusable array, and the address of its data at its creation.
pub(crate) struct ReusedArray {
    array: Py<PyAny>,
    at: usize,
}

/// Returns the kept array, or a new one, which is kept from now on. A new one is needed if another reference to the old one exists
/// (unless `shared`), or if the old one was changed since its creation.
///
/// # Errors
/// A `MemoryError`.
pub(crate) fn reuse_or_allocate<'py, T: Element + Zeroable, const N: usize>(
    py: Python<'py>,
    kept: &mut Option<ReusedArray>,
    shape: [usize; N],
    shared: bool,
) -> PyResult<Bound<'py, Array<T, N>>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    if let Some(ReusedArray { array, at }) = kept
        // SAFETY: this is a reference to an object that is alive. Whatever shows its numbers has one too, so nobody has if this is the only one.
        && (shared || unsafe { Py_REFCNT(array.as_ptr()) } == 1)
        && let Ok(old) = array.bind(py).cast_exact::<Array<T, N>>()
        && old.shape() == shape
        && old.data() as usize == *at
        && may_be_written(old)
    {
        return Ok(old.clone());
    }
    let new = allocate_by_size(py, shape)?;
    *kept = Some(ReusedArray { array: new.clone().into_any().unbind(), at: new.data() as usize });
    Ok(new)
}

/// Returns a new array, which the caller must fill; a large one is aligned to a cache line.
///
/// # Errors
/// A `MemoryError`.
pub(crate) fn allocate_by_size<'py, T: Element + Zeroable, const N: usize>(
    py: Python<'py>,
    shape: [usize; N],
) -> PyResult<Bound<'py, Array<T, N>>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    let bytes = shape.iter().product::<usize>().saturating_mul(size_of::<T>());
    if bytes < LARGE { allocate(py, shape) } else { allocate_aligned(py, shape) }
}

/// Whether an array is contiguous and writable.
fn may_be_written<T: Element, D: Dimension>(array: &Bound<'_, PyArray<T, D>>) -> bool {
    // SAFETY: a reference to an array that is alive.
    let flags = unsafe { (*array.as_array_ptr()).fields.flags };
    flags & NPY_ARRAY_CARRAY == NPY_ARRAY_CARRAY
}

/// Size in bytes above which arrays are aligned to cache lines; a step of thousands takes a tenth less time.
const LARGE: usize = 1024;

/// A cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Returns a new array of zeros, aligned to a cache line.
fn allocate_aligned<'py, T: Element + Zeroable, const N: usize>(
    py: Python<'py>,
    shape: [usize; N],
) -> PyResult<Bound<'py, Array<T, N>>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    let bytes = shape.iter().try_fold(size_of::<T>(), |bytes, len| bytes.checked_mul(*len));
    let lines = bytes.map(|bytes| bytes.div_ceil(size_of::<Line>()));
    let mut memory = Vec::new();
    let reserved = lines.and_then(|lines| memory.try_reserve_exact(lines).ok().map(|()| lines));
    let lines = reserved.ok_or_else(|| {
        PyMemoryError::new_err(format!("not enough memory for {shape:?} numbers"))
    })?;
    memory.resize(lines, Line([0; 64]));
    let numbers = memory.as_ptr().cast::<T>();
    let owner = PyCapsule::new_with_value(py, memory, c"libration.memory")?;
    // SAFETY: so many numbers of zero bits lie there, aligned, until the owner is gone, which the array keeps; nobody else writes them.
    Ok(unsafe {
        let array = ArrayView::from_shape_ptr(shape.into_dimension(), numbers);
        PyArray::borrow_from_array(&array, owner.into_any())
    })
}

/// Returns the memory of an array, for writes of the engine.
#[allow(clippy::mut_from_ref, reason = "a reference to an array is no claim to its numbers")]
pub(crate) fn view_mut<'a, T: Element + AnyBitPattern + NoUninit, D: Dimension>(
    array: &'a Bound<'_, PyArray<T, D>>,
) -> &'a mut [T] {
    // SAFETY: `allocate` or `reuse_or_allocate` made the array, so its numbers are contiguous in memory of its own. A reader in Python
    // during the write has chosen reused buffers; it reads numbers of one step or the next, as in any array that NumPy writes
    // without the interpreter's lock.
    unsafe { from_raw_parts_mut(array.data(), array.len()) }
}

/// Returns the memory of an array of flags, for values 0 and 1.
#[allow(clippy::mut_from_ref, reason = "as above")]
pub(crate) fn bytes_of<'a>(array: &'a Bound<'_, Array<bool, 1>>) -> &'a mut [u8] {
    // SAFETY: as in `view_mut`; a flag is a byte, of which the engine makes nothing but 0 and 1.
    unsafe { from_raw_parts_mut(array.data().cast(), array.len()) }
}

/// Returns the data of an array of actions, `[n, width]`, or `[n]` if there is one each or one environment, if it is contiguous and
/// aligned.
pub(crate) fn contiguous_actions<'a, T: Number>(
    actions: &'a Bound<'_, PyAny>,
    [len, width]: [usize; 2],
) -> Option<&'a [T]> {
    // A class of its own may mean something else by its numbers, as a masked array does.
    let array = actions.cast_exact::<PyArray<T, IxDyn>>().ok()?;
    let fits = match *array.shape() {
        [n] => (n == len && width == 1) || (len == 1 && n == width),
        [n, each] => n == len && each == width,
        _ => false,
    };
    // SAFETY: the array is contiguous and aligned, and lives as long as the call that reads it. Whoever writes it meanwhile, from another
    // thread, gives one action or the other.
    (fits && array.is_c_contiguous() && is_aligned(array))
        .then(|| unsafe { from_raw_parts(array.data(), len * width) })
}

/// Whether all numbers are finite: zero times a finite number is zero, and vectors add faster than they compare.
pub(crate) fn are_finite<T: Number>(numbers: &[T]) -> bool {
    let (rows, rest) = numbers.as_chunks::<16>();
    let mut sums = [T::zero(); 16];
    for row in rows {
        for (sum, x) in sums.iter_mut().zip(row) {
            *sum = *sum + *x * T::zero();
        }
    }
    sums.iter().chain(rest).all(|x| x.is_finite())
}

/// Whether a slice overlaps the memory of an array.
pub(crate) fn lies_in<T, U: Element, D: Dimension>(
    numbers: &[T],
    array: &Bound<'_, PyArray<U, D>>,
) -> bool {
    let numbers = numbers.as_ptr_range();
    let begin = array.data() as usize;
    let end = begin + array.len() * size_of::<U>();
    (numbers.start as usize) < end && begin < numbers.end as usize
}

/// Returns memory of the engine as an array that owns a reference to its owner.
pub(crate) fn view<'py, T: Number, const N: usize>(
    owner: &Bound<'py, PyAny>,
    numbers: &[T],
    shape: [usize; N],
) -> PyResult<Bound<'py, PyAny>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    let array = ArrayView::from_shape(shape, numbers);
    let array = array.map_err(|error| value_error(error.to_string()))?;
    // SAFETY: whoever calls lends memory that its owner has until it is gone, at the same place; the array keeps the owner.
    Ok(unsafe { PyArray::borrow_from_array(&array, owner.clone()) }.into_any())
}

/// Returns flags of the engine as an array of `bool` that owns a reference to its owner.
pub(crate) fn view_of_flags<'py>(
    owner: &Bound<'py, PyAny>,
    flags: &[u8],
    shape: [usize; 2],
) -> PyResult<Bound<'py, PyAny>> {
    // SAFETY: a flag of the engine is a byte of 0 or 1.
    let flags: &[bool] = unsafe { from_raw_parts(flags.as_ptr().cast(), flags.len()) };
    let array = ArrayView::from_shape(shape, flags);
    let array = array.map_err(|error| value_error(error.to_string()))?;
    // SAFETY: as in `view`.
    Ok(unsafe { PyArray::borrow_from_array(&array, owner.clone()) }.into_any())
}

fn is_aligned<T: Element>(array: &Bound<'_, PyArray<T, IxDyn>>) -> bool {
    array.data().is_aligned()
}

/// A function of `libration._arrays` for what is rare.
pub(crate) fn helper<'py>(
    py: Python<'py>,
    cell: &'static PyOnceLock<Py<PyAny>>,
    name: &str,
) -> PyResult<&'py Bound<'py, PyAny>> {
    let import = || Ok::<_, PyErr>(py.import("libration._arrays")?.getattr(name)?.unbind());
    Ok(cell.get_or_try_init(py, import)?.bind(py))
}
