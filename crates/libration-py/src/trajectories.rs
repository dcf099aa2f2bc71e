//! The Python class `Trajectories`: an ensemble of a system.

use libration::Method;
use libration::ensemble::{AnyEnsemble, BatchFloat, EnsembleError, Execution};
use libration::rl::EnvironmentError;
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::array::{Array, Number, allocate, view_mut};
use crate::checked_mutex::CheckedMutex;
use crate::equations::{Description, any_system};
use crate::error::Raised;
use crate::request::{method, warn_of};
use crate::time_slices::run_in_slices;

/// Trajectories of a system, which the engine steps together.
#[pyclass(frozen, module = "libration._native")]
pub(crate) struct Trajectories {
    ensemble: CheckedMutex<(AnyTrajectories, Threads)>,
    method: Method,
    dt: f64,
}

/// Number of threads, and the process that owns them.
struct Threads {
    count: usize,
    process: u32,
}

impl Threads {
    /// Threads of this process (0: one per core).
    fn start(count: usize) -> PyResult<(Execution, Self)> {
        let execution = Execution::serial().threads(count).map_err(Raised::raised)?;
        let threads = Threads { count: execution.thread_count(), process: std::process::id() };
        Ok((execution, threads))
    }
}

enum AnyTrajectories {
    F32(AnyEnsemble<f32>),
    F64(AnyEnsemble<f64>),
}

/// Evaluates an expression for trajectories of either float type.
macro_rules! with_all {
    ($trajectories:expr, $all:ident => $work:expr) => {
        match $trajectories {
            AnyTrajectories::F32($all) => $work,
            AnyTrajectories::F64($all) => $work,
        }
    };
}

/// Coordinates that are stepped before it is known how long they take: some milliseconds of work as a rule.
const FIRST: u64 = 1 << 18;

#[pymethods]
impl Trajectories {
    /// Creates trajectories from `q` and `v`, `(len, degrees of freedom)` each.
    #[new]
    fn new(
        system: Description,
        integrator: &str,
        dt: f64,
        q: PyReadonlyArray2<'_, f64>,
        v: PyReadonlyArray2<'_, f64>,
        single: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let py = q.py();
        let (q, v) = (q.as_array(), v.as_array());
        let [len, degrees] = [q.nrows(), q.ncols()];
        // The catalogue has some systems in several dimensions.
        let origin = matches!(system, Description::Name(_)).then(|| vec![0.0; degrees]);
        let system = any_system(&(system, origin, None))?;
        let method = method(integrator)?;
        warn_of(py, system.caveat(method))?;
        let of = |n: usize, i: usize| if i < degrees { q[[n, i]] } else { v[[n, i - degrees]] };
        let (execution, threads) = Threads::start(threads)?;
        let refused = |error: EnsembleError| EnvironmentError::from(error).raised();
        let (dynamics, twin) = (system.equations.dynamics(), system.twin.map(|twin| twin.system));
        let ensemble = if single {
            let start = |n, i| of(n, i) as f32;
            let all = AnyEnsemble::new(dynamics, twin, len, execution, start);
            AnyTrajectories::F32(all.map_err(refused)?)
        } else {
            let all = AnyEnsemble::new(dynamics, twin, len, execution, of);
            AnyTrajectories::F64(all.map_err(refused)?)
        };
        let ensemble = CheckedMutex::new((ensemble, threads));
        Ok(Trajectories { ensemble, method, dt })
    }

    /// Takes `steps` steps.
    fn _advance(&self, py: Python<'_>, steps: u64) -> PyResult<()> {
        let mut inside = self.ensemble.lock(py)?;
        let (ensemble, threads) = &mut *inside;
        // A process that was forked has none of them.
        if threads.count > 1 && threads.process != std::process::id() {
            let execution = Execution::serial().threads(threads.count).map_err(Raised::raised)?;
            with_all!(ensemble, all => all.execute(execution));
            threads.process = std::process::id();
        }
        let many = with_all!(ensemble, all => (all.len() * all.dimension()).max(1) as u64);
        run_in_slices(py, steps, FIRST / many, |piece| {
            let steps = piece.end - piece.start;
            py.detach(|| match ensemble {
                AnyTrajectories::F32(all) => all.advance(self.method, self.dt as f32, steps),
                AnyTrajectories::F64(all) => all.advance(self.method, self.dt, steps),
            });
            Ok(())
        })
    }

    /// Returns the number of steps taken.
    fn _step(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(with_all!(&self.ensemble.lock(py)?.0, all => all.step()))
    }

    /// Returns positions and velocities, `(len, dimension)` each.
    fn _states<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 2]> {
        fn states<'a, 'py, T: Number + BatchFloat>(
            py: Python<'py>,
            all: &'a AnyEnsemble<T>,
        ) -> PyResult<[Bound<'py, PyAny>; 2]> {
            let [len, dimension] = [all.len(), all.dimension()];
            let array = |plane: &dyn Fn(usize) -> Option<&'a [T]>| -> PyResult<_> {
                let array: Bound<'py, Array<T, 2>> = allocate(py, [len, dimension])?;
                let to = view_mut(&array);
                for i in 0..dimension {
                    for (n, x) in plane(i).unwrap_or_default().iter().enumerate() {
                        to[n * dimension + i] = *x;
                    }
                }
                Ok(array.into_any())
            };
            Ok([array(&|i| all.q(i))?, array(&|i| all.v(i))?])
        }
        let inside = self.ensemble.lock(py)?;
        with_all!(&inside.0, all => states(py, all))
    }

    /// Returns the energies per unit mass, `(len,)`, in the unit of a velocity squared.
    fn _energies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        fn energies<T: Number + BatchFloat>(all: &AnyEnsemble<T>) -> Vec<T> {
            all.energies().unwrap_or_else(|| vec![T::from_f64(f64::NAN); all.len()])
        }
        Ok(match &self.ensemble.lock(py)?.0 {
            AnyTrajectories::F32(all) => PyArray1::from_vec(py, energies(all)).into_any(),
            AnyTrajectories::F64(all) => PyArray1::from_vec(py, energies(all)).into_any(),
        })
    }
}
