//! The extension module `libration._native` of the Python package `libration`.
//!
//! It converts Python arguments to requests of the engine, and results to NumPy arrays.

mod actions;
mod any_batch;
mod array;
mod background;
mod batch;
mod bench;
mod bodies;
mod catalogue;
mod checked_mutex;
mod comparison;
mod datasets;
mod energy;
mod episode_states;
mod equations;
mod error;
mod identify;
mod laboratory;
mod linear_analysis;
mod linear_loops;
mod linear_plant;
mod observations;
mod policy;
mod probe;
mod program;
mod replay;
mod request;
mod rollout;
mod settings;
mod simulate;
mod step;
mod temperature;
mod time_slices;
mod trajectories;

/// The extension module.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::batch::Batch;
    #[pymodule_export]
    use crate::bench::{_seconds_of_rollouts, _seconds_of_steps};
    #[pymodule_export]
    use crate::bodies::{_check_bodies, _named_bodies, _read_bodies, _simulate_bodies};
    #[pymodule_export]
    use crate::catalogue::{
        _commanded, _implicit_integrators, _integrators, _parameters, _runge_kutta_methods,
        _splitting_methods, _studies, _systems, _task_expressions,
    };
    #[pymodule_export]
    use crate::checked_mutex::_forked;
    #[pymodule_export]
    use crate::comparison::_compare_integrators;
    #[pymodule_export]
    use crate::datasets::{_dataset_settings, _join_datasets, _verify_dataset, _write_dataset};
    #[pymodule_export]
    use crate::energy::_audit_energy;
    #[pymodule_export]
    use crate::equations::{_equation_plant, _equation_summary};
    #[pymodule_export]
    use crate::identify::_identify;
    #[pymodule_export]
    use crate::laboratory::{_advise, _advise_equations, _run_lab};
    #[pymodule_export]
    use crate::linear_analysis::_analyze_linear;
    #[pymodule_export]
    use crate::linear_loops::LinearLoops;
    #[pymodule_export]
    use crate::linear_plant::_linear_plant;
    #[pymodule_export]
    use crate::probe::{_first_difference, _gains, _jacobian, _probe};
    #[pymodule_export]
    use crate::program::_program;
    #[pymodule_export]
    use crate::replay::Buffer;
    #[pymodule_export]
    use crate::rollout::Memory;
    #[pymodule_export]
    use crate::simulate::{_analyze, _simulate};
    #[pymodule_export]
    use crate::temperature::_analyze_temperature;
    #[pymodule_export]
    use crate::trajectories::Trajectories;

    /// Steps of a simulation.
    #[pymodule_export]
    const _MOST_STEPS: u64 = *libration_settings::limits::TRAJECTORY_STEPS.end();

    /// Bytes of a file of settings.
    #[pymodule_export]
    const _SETTINGS_BYTES: u64 = libration_settings::limits::SETTINGS_BYTES;

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "as Python names it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
