//! The engine as a Python package: the module `libration._native`, which `python/libration` makes pleasant.
//!
//! Nothing is computed here. What Python hands over becomes a recipe, and what environments lead to becomes NumPy arrays.

mod acts;
mod array;
mod bench;
mod error;
mod held;
mod layer;
mod rollout;
mod settings;
mod step;
mod tensors;

/// What `libration` is made of.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::bench::_seconds_of_steps;
    #[pymodule_export]
    use crate::layer::Batch;
    #[pymodule_export]
    use crate::rollout::Memory;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "as Python names it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
