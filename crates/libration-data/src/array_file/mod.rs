//! Arrays with names in files of NumPy and of MATLAB.

mod byte_reader;
mod mat;
mod npy;
mod npy_records;
mod npz;
mod number_format;

pub use mat::read_mat;
pub use npy::parse_npy;
pub use npy_records::parse_npy_records;
pub use npz::read_npz;

/// An array with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedArray {
    /// The name of the variable.
    pub name: String,
    /// Its values.
    pub values: ArrayValues,
}

/// The values of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayValues {
    /// Numbers, row by row.
    Numbers {
        /// At most two lengths; none for a single number.
        shape: Vec<usize>,
        /// As many as the product of the lengths.
        entries: Vec<f64>,
    },
    /// Integers of which a `f64` would lose digits, row by row.
    Integers {
        /// At most two lengths; none for a single number.
        shape: Vec<usize>,
        /// As many as the product of the lengths.
        entries: Vec<i64>,
    },
    /// A list of strings.
    Text(Vec<String>),
}

/// Numbers by rows, of numbers by columns.
fn by_rows<T: Copy>(columns: &[T], shape: &[usize]) -> Vec<T> {
    match *shape {
        [m, n] => (0..m * n).map(|i| columns[i % n * m + i / n]).collect(),
        _ => columns.to_vec(),
    }
}

/// Adds an array whose name must be new.
fn push_new(arrays: &mut Vec<NamedArray>, array: NamedArray) -> Result<(), String> {
    if arrays.iter().any(|other| other.name == array.name) {
        return Err(format!("it has two arrays `{}`; expected one", array.name));
    }
    arrays.push(array);
    Ok(())
}
