//! Fused steps on one core, beside independent arithmetic in the same proportion.

use std::hint::black_box;

use libration::analysis::{DataFlow, Operation};
use libration::ensemble::{All, EnsembleError, Execution, InstructionSet};
use libration::system::Oscillator;
use libration::{Ensemble, Integrator, Method, State, with_method};

use super::desk::{Desk, judge};
use crate::bench::{Bench, BenchFloat, Contestant, Mix, Rates, Task, together, widths, with_float};
use crate::record::{Record, Table};
use crate::study::StudyError;

/// Trajectories whose states stay in a cache of the core, in whole blocks of most widths.
pub(super) const RESIDENT: usize = 49_920;

/// Steps of a pass: enough that loading a block costs nothing.
const STEPS: u64 = 200;

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

/// What a step of a method needs, and the loop that does as much with independent operands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    mix: Mix,
    /// Lanes at which that loop is fastest.
    width: usize,
    /// Operations of a step.
    operations: usize,
}

/// The peak for steps of `flow` on floats of type `T`: the fastest of all widths.
pub(super) fn peak<T: Bench>(desk: &Desk<'_>, flow: &DataFlow) -> Result<Peak, StudyError> {
    let (set, mix) = (desk.set(), Mix::of(flow));
    let counted = [Operation::Multiplication, Operation::Addition].map(|op| flow.count(op));
    let offered: Vec<usize> = widths::<T>(set, mix).collect();
    let peaks = offered.iter().map(|&width| Peak { mix, width, operations: counted.iter().sum() });
    let peaks: Vec<Peak> = peaks.collect();
    let mut contestants: Vec<_> = peaks.iter().map(|peak| peak.contestant::<T>(set)).collect();
    let rates = desk.look(&mut contestants)?;
    let fastest = rates.iter().zip(peaks).max_by(|a, b| a.0.median().total_cmp(&b.0.median()));
    let (_, peak) = fastest.ok_or(StudyError::Exact("no loop fits the registers".into()))?;
    Ok(peak)
}

impl Peak {
    /// Steps a second that this arithmetic amounts to.
    pub(super) fn contestant<T: Bench>(self, set: InstructionSet) -> Contestant<'static> {
        Contestant::new(self.work(), move |times| {
            black_box(self.mix.run::<T>(set, self.width, times * ROUNDS));
        })
    }

    /// The same on several threads at once.
    pub(super) fn on_threads<T: Bench>(
        self,
        set: InstructionSet,
        threads: usize,
    ) -> Contestant<'static> {
        Contestant::new(self.work() * threads as f64, move |times| {
            together(0..threads, |_| {
                black_box(self.mix.run::<T>(set, self.width, times * ROUNDS));
            });
        })
    }

    /// Steps in `ROUNDS` rounds.
    fn work(self) -> f64 {
        let operations = ROUNDS as usize * self.width * self.mix.operations();
        operations as f64 / self.operations as f64
    }

    /// Operations of a step.
    pub(super) fn operations(self) -> usize {
        self.operations
    }
}

/// `task` under `integrator`, all steps of a pass fused: steps a second.
pub(super) fn contestant<'a, T: Bench>(
    integrator: impl Integrator + 'a,
    task: Task,
    execution: &Execution,
) -> Result<Contestant<'a>, EnsembleError> {
    let start = |_| State { q: [T::one()], v: [T::zero()] };
    let mut ensemble = Ensemble::<T, 1>::from_fn(task.count, execution.clone(), start)?;
    let system = Oscillator { omega2: T::from_f64(task.omega2) };
    let dt = T::from_f64(task.dt);
    Ok(Contestant::new(task.count as f64 * STEPS as f64, move |times| {
        for _ in 0..times {
            // One value for all is never too few or too many.
            let outcome = ensemble.advance(integrator, All(system), All(dt), STEPS);
            debug_assert_eq!(outcome, Ok(()));
        }
        black_box(ensemble.q(0));
    }))
}

/// Races every method against its peak, and leaves the rates of the peaks in a table.
pub(super) fn measure(desk: &Desk<'_>, record: &mut Record) -> Result<(), StudyError> {
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
    for &method in &desk.lab.config.integrators {
        for float in BenchFloat::ALL {
            let (peak, rates) =
                with_float!(float, T => with_method!(method, |m| against_peak::<T>(desk, m)))?;
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
                bar(method, desk.set()),
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

/// The peak of a method, and its rates: fused steps, and the peak.
fn against_peak<T: Bench>(
    desk: &Desk<'_>,
    integrator: impl Integrator,
) -> Result<(Peak, [Rates; 2]), StudyError> {
    let task = desk.task(RESIDENT);
    let system = Oscillator { omega2: task.omega2 };
    let flow = DataFlow::of_step::<_, 1>(integrator, &system, task.dt);
    let peak = peak::<T>(desk, &flow)?;
    let fused = contestant::<T>(integrator, task, &desk.serial)?;
    let rates = desk.race(&mut [fused, peak.contestant::<T>(desk.set())])?;
    let [fused, arithmetic] = &rates[..] else {
        return Err(StudyError::Exact("a race of two has two rates".into()));
    };
    Ok((peak, [fused.clone(), arithmetic.clone()]))
}
