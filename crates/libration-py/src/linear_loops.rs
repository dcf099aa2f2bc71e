//! The Python class `LinearLoops`: many loops around a linear plant.

use libration::ensemble::Execution;
use libration::linear_loops::{LinearLoops as Loops, LinearLoopsError};
use libration_advise::linear;
use libration_settings::linear_loop::LinearControllerTable;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::array::{Array, allocate, view_mut};
use crate::checked_mutex::CheckedMutex;
use crate::error::{Raised, check_memory, value_error};
use crate::linear_plant::{Names, names};
use crate::time_slices::run_in_slices;

/// Loops around a linear plant, which the engine steps together.
#[pyclass(frozen, module = "libration._native")]
pub(crate) struct LinearLoops {
    loops: CheckedMutex<(Loops, Threads)>,
    names: Names,
    period: f64,
}

/// Number of threads, and the process that owns them.
struct Threads {
    count: usize,
    process: u32,
}

/// Periods of loops that are stepped before it is known how long they take.
const FIRST: u64 = 1 << 12;

/// Times, states, measurements, inputs and costs.
type Rows<'py> = (
    Bound<'py, Array<f64, 2>>,
    Bound<'py, Array<f64, 3>>,
    Bound<'py, Array<f64, 3>>,
    Bound<'py, Array<f64, 3>>,
    Bound<'py, Array<f64, 2>>,
);

impl Raised for LinearLoopsError {
    fn raised(self) -> PyErr {
        match self {
            LinearLoopsError::Memory(error) => PyMemoryError::new_err(error.to_string()),
            error => value_error(error.to_string()),
        }
    }
}

#[pymethods]
impl LinearLoops {
    /// Creates `count` loops from the text of a request file.
    #[new]
    fn new(config: &str, count: usize, threads: usize, noise: bool, open: bool) -> PyResult<Self> {
        let request = linear::parse_changed(config, "config.toml", |file| {
            if file.controller.is_none()
                && let Ok(plant) = file.system.linear.plant()
            {
                file.controller = Some(LinearControllerTable::open_loop(&plant));
            }
        });
        let request = request.map_err(Raised::raised)?;
        let timing = request.loop_timing().map_err(|error| value_error(error.to_string()))?;
        let linear = match noise {
            true => request.linear_loop().clone(),
            false => request.linear_loop().without_noise(),
        };
        let execution = Execution::serial().threads(threads).map_err(Raised::raised)?;
        let threads = Threads { count: execution.thread_count(), process: std::process::id() };
        let loops = Loops::new(&linear, &timing, request.recorded_periods(), count, execution);
        let loops = loops.map_err(Raised::raised)?;
        let loops = if open { loops.without_controller() } else { loops };
        let names = names(linear.plant());
        let period = linear.period();
        Ok(LinearLoops { loops: CheckedMutex::new((loops, threads)), names, period })
    }

    /// Returns names and units of states, inputs and outputs.
    fn _names(&self) -> Names {
        self.names.clone()
    }

    /// Returns the period in s.
    fn _period(&self) -> f64 {
        self.period
    }

    /// Returns the number of periods since the start.
    fn _step(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.loops.lock(py)?.0.step())
    }

    /// Begins anew from states, loops × states.
    fn _reset(&self, py: Python<'_>, seed: u64, x0: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let loops = &mut self.loops.lock(py)?.0;
        let wanted = [loops.count(), loops.sizes()[0]];
        if x0.shape() != wanted {
            let [given, wanted] = [x0.shape(), &wanted].map(|shape| format!("{shape:?}"));
            return Err(value_error(format!("x0 has shape {given}; expected {wanted}")));
        }
        let x0 = x0.as_array();
        loops.reset(seed, |n, i| x0[[n, i]]);
        Ok(())
    }

    /// Sets the reference of each output and the disturbance of each input.
    fn _set_constants(
        &self,
        py: Python<'_>,
        reference: Vec<f64>,
        disturbance: Vec<f64>,
    ) -> PyResult<()> {
        let loops = &mut self.loops.lock(py)?.0;
        loops.set_reference(&reference).map_err(Raised::raised)?;
        loops.set_disturbance(&disturbance).map_err(Raised::raised)
    }

    /// Goes on by so many periods.
    fn _advance(&self, py: Python<'_>, periods: u64) -> PyResult<()> {
        let mut inside = self.loops.lock(py)?;
        let loops = with_own_threads(&mut inside)?;
        let first = FIRST / loops.count() as u64;
        run_in_slices(py, periods, first, |piece| {
            py.detach(|| loops.advance(piece.end - piece.start));
            Ok(())
        })
    }

    /// Goes on by a period with commands, loops × inputs.
    fn _advance_by(&self, py: Python<'_>, commands: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let mut inside = self.loops.lock(py)?;
        let loops = with_own_threads(&mut inside)?;
        let commands = commands.as_array();
        let commands: Vec<f64> = commands.iter().copied().collect();
        py.detach(|| loops.advance_by(&commands)).map_err(Raised::raised)
    }

    /// Goes on by `rows - 1` times `every` periods and returns all rows, the present one first.
    fn _rollout<'py>(&self, py: Python<'py>, rows: u64, every: u64) -> PyResult<Rows<'py>> {
        let mut inside = self.loops.lock(py)?;
        let loops = with_own_threads(&mut inside)?;
        let (count, [n, m, p]) = (loops.count(), loops.sizes());
        check_memory(u128::from(rows) * (count * (n + m + p + 2) * size_of::<f64>()) as u128)?;
        let t = rows as usize;
        let times = allocate(py, [t, count])?;
        let states = allocate(py, [t, count, n])?;
        let measurements = allocate(py, [t, count, p])?;
        let inputs = allocate(py, [t, count, m])?;
        let costs = allocate(py, [t, count])?;
        let all = [
            (view_mut(&times), 1),
            (view_mut(&states), n),
            (view_mut(&measurements), p),
            (view_mut(&inputs), m),
            (view_mut(&costs), 1),
        ];
        let mut all = all;
        run_in_slices(py, rows, 1, |piece| {
            py.detach(|| {
                for row in piece {
                    if row > 0 {
                        loops.advance(every);
                    }
                    let numbers: [&dyn Fn(usize, usize) -> f64; 5] = [
                        &|k, _| loops.time(k),
                        &|k, i| loops.state(k, i),
                        &|k, j| loops.measurement(k, j),
                        &|k, i| loops.input(k, i),
                        &|k, _| loops.cost(k),
                    ];
                    for ((array, width), number) in all.iter_mut().zip(numbers) {
                        let size = count * *width;
                        let place = row as usize * size..(row as usize + 1) * size;
                        for (i, x) in array[place].iter_mut().enumerate() {
                            *x = number(i / *width, i % *width);
                        }
                    }
                }
            });
            Ok(())
        })?;
        Ok((times, states, measurements, inputs, costs))
    }
}

/// The loops, with threads of this process: one that was forked has none.
fn with_own_threads((loops, threads): &mut (Loops, Threads)) -> PyResult<&mut Loops> {
    if threads.count > 1 && threads.process != std::process::id() {
        loops.execute(Execution::serial().threads(threads.count).map_err(Raised::raised)?);
        threads.process = std::process::id();
    }
    Ok(loops)
}
