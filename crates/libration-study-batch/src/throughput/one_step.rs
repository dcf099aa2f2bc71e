//! One step per pass, compared with a loop that moves the same memory.

use std::hint::black_box;

use libration::ensemble::{Buffer, Execution, InsufficientMemory, Pages};
use libration::{Ensemble, Method};
use libration_report::record::{Record, Table};
use libration_study::StudyError;

use crate::bench::{Contestant, Update, stepping};
use crate::measurement::{Measurement, judge};

/// Share of the update loop that one step a pass is to reach.
const BAR: f64 = 0.9;

/// Races ensembles far larger than the nearer caches against loops of the same traffic.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let counts: &[usize] = measurement.lab.effort.choose(
        &[1_000_000],
        &[10_000_000, 100_000_000],
        &[10_000_000, 100_000_000],
    );
    let mut table = Table::new(
        "one step a pass",
        &[
            "trajectories",
            "threads",
            "step (10⁹ steps/s)",
            "loop (10⁹ steps/s)",
            "step (GB/s)",
            "share",
        ],
    );
    for &count in counts {
        // The ensemble, and the planes of the loop.
        let bytes = Ensemble::<f32, 1>::bytes(count);
        if InsufficientMemory::check(2 * bytes).is_err() {
            continue;
        }
        for execution in [&measurement.serial, &measurement.parallel] {
            let threads = execution.thread_count();
            if threads == 1 && !std::ptr::eq(execution, &measurement.serial) {
                continue;
            }
            let step =
                stepping::<f32>(Method::SymplecticEuler, measurement.task(count), 1, execution)?;
            let [step, update] =
                measurement.compare_rates([step, update(measurement, count, execution)?])?;
            let share = step.over(&update);
            let power = (count as f64).log10();
            let on = if threads == 1 { "one core".into() } else { format!("{threads} threads") };
            judge(
                record,
                format!(
                    "throughput.one-step.1e{power}{}",
                    if threads == 1 { "" } else { ".threads" }
                ),
                format!(
                    "symplectic Euler, f32, N = 10^{power}, one step a pass, {on}: steps a second over \
                     those of a loop that reads and writes the same memory"
                ),
                Some(BAR),
                &share,
            );
            table.push([
                (count as u64).into(),
                (threads as u64).into(),
                (step.median() / 1e9).into(),
                (update.median() / 1e9).into(),
                (step.median() * BYTES / 1e9).into(),
                share.median().into(),
            ]);
        }
    }
    record.tables.push(table);
    Ok(())
}

/// Bytes that a step must move: position and velocity, read and written.
const BYTES: f64 = 4.0 * size_of::<f32>() as f64;

/// One pass of the update loop over planes of the same size, each thread with its own part.
pub(super) fn update<'a>(
    measurement: &Measurement<'_>,
    count: usize,
    execution: &Execution,
) -> Result<Contestant<'a>, StudyError> {
    let set = measurement.set();
    let task = measurement.task(count);
    let (s, t) = (-(task.omega2 * task.dt) as f32, task.dt as f32);
    let mut x = Buffer::<f32>::new(count, Pages::Huge)?;
    let mut y = Buffer::<f32>::new(count, Pages::Huge)?;
    let part = count.div_ceil(execution.thread_count()).next_multiple_of(64);
    // Each part is first written by the thread that will work on it.
    let execution = execution.clone();
    let parts = x.chunks_mut(part).zip(y.chunks_mut(part)).collect();
    execution.each(parts, |(x, y): (&mut [f32], &mut [f32])| {
        x.fill(1.0);
        y.fill(0.0);
    });
    Ok(Contestant::new(count as f64, move |times| {
        for _ in 0..times {
            let (s, t) = (black_box(s), black_box(t));
            let parts = x.chunks_mut(part).zip(y.chunks_mut(part)).collect();
            execution.each(parts, |(x, y)| set.vectorize(Update { x, y, s, t }));
        }
        black_box(&*x);
    }))
}
