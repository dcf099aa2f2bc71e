//! Every implementation at every number of trajectories.

use libration::ensemble::Execution;

use super::desk::Desk;
use crate::bench::{
    Bench, BenchFloat, Contestant, Implementation, Rates, Task, prepare, with_float,
};
use crate::machine::has_room;
use crate::record::{Record, Series};
use crate::study::StudyError;

/// Steps that the fused implementations take in a pass.
const FUSED: u64 = 200;

/// Steps that the lone ones take with a trajectory before the next.
const LONE: u64 = 16;

/// The most trajectories that are taken one by one: their rate does not depend on the number.
const LONE_COUNT: usize = 1_000_000;

/// A rate, and what it is the rate of.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) implementation: Implementation,
    pub(crate) float: BenchFloat,
    pub(crate) count: usize,
    /// Steps a second of all trajectories together.
    pub(crate) rates: Rates,
}

/// Measures what the configuration asks for, as far as effort and memory go.
pub(super) fn measure(desk: &Desk<'_>, record: &mut Record) -> Result<(), StudyError> {
    let most = desk.lab.effort.choose(1_000_000, 10_000_000, usize::MAX);
    let counts = desk.lab.config.throughput.counts.iter();
    let counts = counts.map(|&count| usize::try_from(count).unwrap_or(usize::MAX));
    let counts: Vec<usize> = counts.filter(|&count| count <= most).collect();
    for &implementation in &desk.lab.config.throughput.implementations {
        for float in BenchFloat::ALL {
            let mut points = Vec::new();
            for &count in &counts {
                let room = has_room(bytes_needed(implementation, float, count)).is_ok();
                if room && !(implementation.is_lone() && count > LONE_COUNT) {
                    points.push(point(desk, implementation, float, count)?);
                }
            }
            if !points.is_empty() {
                record.series.push(series(implementation, float, &points));
            }
        }
    }
    Ok(())
}

/// The points that a caller asks for, one after another.
///
/// # Errors
/// If the run is to stop, or memory or instruction set are not to be had.
pub(crate) fn ladder(
    desk: &Desk<'_>,
    wanted: impl IntoIterator<Item = (Implementation, BenchFloat, usize)>,
) -> Result<Vec<Point>, StudyError> {
    wanted.into_iter().map(|(one, float, count)| point(desk, one, float, count)).collect()
}

/// Bytes that an implementation takes, temporaries included.
pub(crate) fn bytes_needed(
    implementation: Implementation,
    float: BenchFloat,
    count: usize,
) -> u128 {
    arrays(implementation) as u128 * count as u128 * float.bytes() as u128
}

/// Arrays, one number for each trajectory, that an implementation holds at once.
pub(super) fn arrays(implementation: Implementation) -> usize {
    match implementation {
        // Two results before the new velocity is there, and that.
        Implementation::Temporaries => 5,
        Implementation::InPlace => 3,
        _ => 2,
    }
}

fn point(
    desk: &Desk<'_>,
    implementation: Implementation,
    float: BenchFloat,
    count: usize,
) -> Result<Point, StudyError> {
    let contestant = with_float!(float, T => {
        contestant::<T>(implementation, desk.task(count), &desk.parallel)
    })?;
    let mut rates = desk.look(&mut [contestant])?;
    let rates = rates.pop().ok_or(StudyError::Exact("a race of one has one rate".into()))?;
    Ok(Point { implementation, float, count, rates })
}

fn contestant<T: Bench>(
    implementation: Implementation,
    task: Task,
    execution: &Execution,
) -> Result<Contestant<'static>, StudyError> {
    let mut rung = prepare::<T>(implementation, task, execution)?;
    let steps = match implementation {
        Implementation::Fused | Implementation::Threads => FUSED,
        one if one.is_lone() => LONE,
        _ => 1,
    };
    Ok(Contestant::new(task.count as f64 * steps as f64, move |times| {
        for _ in 0..times {
            rung.advance(steps);
        }
        std::hint::black_box(rung.state(0));
    }))
}

/// The name of the series of an implementation.
pub(super) fn series_name(implementation: Implementation, float: BenchFloat) -> String {
    format!("scaling-{}-{}", implementation.name(), float.name())
}

fn series(implementation: Implementation, float: BenchFloat, points: &[Point]) -> Series {
    let column = |value: fn(&Point) -> f64| points.iter().map(value).collect();
    Series::new(series_name(implementation, float))
        .with("trajectories", "1", column(|p| p.count as f64))
        .with("steps_per_second", "1/s", column(|p| p.rates.median()))
        .with("spread", "1/s", column(|p| p.rates.spread()))
}
