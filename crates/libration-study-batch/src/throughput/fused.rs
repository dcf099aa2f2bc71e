//! Fused steps on one core, compared with independent arithmetic in the same proportion.

use std::hint::black_box;

use libration::analysis::{DataFlow, Operation};
use libration::ensemble::{Execution, InstructionSet};
use libration::system::Oscillator;
use libration::{Method, with_method};
use libration_report::record::{Record, Table};
use libration_study::StudyError;

use crate::bench::{Bench, BenchFloat, Contestant, Mix, Rates, VECTORS, stepping, with_float};
use crate::measurement::{Measurement, judge};

/// Trajectories whose states stay in a cache of the core, in whole blocks of most widths.
pub(super) const RESIDENT: usize = 49_920;

/// Steps of a pass: enough that loading a block costs nothing.
pub(super) const STEPS: u64 = 200;

/// Rounds of a loop between two looks at the clock.
const ROUNDS: u64 = 10_000;

/// Share of independent arithmetic that a method is to reach, where 32 registers hold a block.
fn bar(method: Method, set: InstructionSet) -> Option<f64> {
    match method {
        _ if set.registers() < 32 => None,
        Method::SymplecticEuler => Some(0.85),
        Method::VelocityVerlet | Method::Rk4 => Some(0.75),
        _ => None,
    }
}

/// The operations of a step of a method, and the loop that does as much with independent operands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    mix: Mix,
    /// Vectors at which that loop is fastest, and their lanes.
    vectors: usize,
    lanes: usize,
    /// Operations of a step.
    operations: usize,
}

/// The peak for steps of `flow` on floats of type `T`: the fastest of all numbers of vectors.
pub(super) fn peak<T: Bench>(
    measurement: &Measurement<'_>,
    flow: &DataFlow,
) -> Result<Peak, StudyError> {
    let (set, mix) = (measurement.set(), Mix::of(flow));
    let operations = arithmetic(flow);
    let peaks = VECTORS.map(|vectors| {
        let lanes = vectors * set.vector_bytes() / size_of::<T>();
        Peak { mix, vectors, lanes, operations }
    });
    let mut contestants: Vec<_> = peaks.iter().map(|peak| peak.contestant::<T>(set)).collect();
    let rates = measurement.sweep_rates_of(&mut contestants)?;
    let fastest = rates.iter().zip(peaks).max_by(|a, b| a.0.median().total_cmp(&b.0.median()));
    let (_, peak) = fastest.ok_or(StudyError::Exact("no loop fits the registers".into()))?;
    Ok(peak)
}

impl Peak {
    /// Returns the peak with additional operations per step.
    pub(super) fn with(self, operations: usize) -> Self {
        Peak { operations: self.operations + operations, ..self }
    }

    /// Steps a second that this arithmetic amounts to.
    pub(super) fn contestant<T: Bench>(self, set: InstructionSet) -> Contestant<'static> {
        Contestant::new(self.work(), move |times| {
            black_box(self.mix.run::<T>(set, self.vectors, times * ROUNDS));
        })
    }

    /// Returns the peak on all threads of `execution`.
    pub(super) fn run_on_threads<T: Bench>(self, execution: &Execution) -> Contestant<'static> {
        let execution = execution.clone();
        let (set, threads) = (execution.instruction_set(), execution.thread_count());
        Contestant::new(self.work() * threads as f64, move |times| {
            execution.each(vec![(); threads], |()| {
                black_box(self.mix.run::<T>(set, self.vectors, times * ROUNDS));
            });
        })
    }

    /// Steps in `ROUNDS` rounds.
    fn work(self) -> f64 {
        let operations = ROUNDS as usize * self.lanes * self.mix.operations();
        operations as f64 / self.operations as f64
    }

    /// Operations of a step.
    pub(super) fn operations(self) -> usize {
        self.operations
    }
}

/// Races every method against its peak, and leaves the rates of the peaks in a table.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let mut table = Table::new(
        "fused steps",
        &[
            "integrator",
            "float",
            "× and + a step",
            "fused (10⁹ steps/s)",
            "independent arithmetic (10⁹ steps/s)",
            "share",
            "spread",
        ],
    );
    for &method in &measurement.lab.config.integrators {
        for float in BenchFloat::ALL {
            let (peak, rates) = with_float!(float, T => against_peak::<T>(measurement, method))?;
            let [fused, arithmetic] = &rates;
            let share = fused.over(arithmetic);
            let name = float.name();
            judge(
                record,
                format!("throughput.{}.{name}", method.name()),
                format!(
                    "{}, {name}, one core: steps a second, all of a pass fused, over those that \
                     independent multiplications and additions amount to",
                    method.title()
                ),
                bar(method, measurement.set()),
                &share,
            );
            table.push([
                method.title().into(),
                name.into(),
                (peak.operations() as u64).into(),
                (fused.median() / 1e9).into(),
                (arithmetic.median() / 1e9).into(),
                share.median().into(),
                share.spread().into(),
            ]);
        }
    }
    record.tables.push(table);
    Ok(())
}

/// Multiplications and additions.
pub(super) fn arithmetic(flow: &DataFlow) -> usize {
    [Operation::Multiplication, Operation::Addition].map(|op| flow.count(op)).iter().sum()
}

/// The operations of a step of `method` on an oscillator.
pub(super) fn flow(measurement: &Measurement<'_>, method: Method) -> DataFlow {
    let task = measurement.task(1);
    let system = Oscillator { omega2: task.omega2 };
    with_method!(method, |m| DataFlow::of_step::<_, 1>(m, &system, task.dt))
}

/// The peak of a method, and its rates: fused steps, and the peak.
fn against_peak<T: Bench>(
    measurement: &Measurement<'_>,
    method: Method,
) -> Result<(Peak, [Rates; 2]), StudyError> {
    let peak = peak::<T>(measurement, &flow(measurement, method))?;
    let fused = stepping::<T>(method, measurement.task(RESIDENT), STEPS, &measurement.serial)?;
    let rates = measurement.compare_rates([fused, peak.contestant::<T>(measurement.set())])?;
    Ok((peak, rates))
}
