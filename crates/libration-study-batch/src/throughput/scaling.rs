//! Every implementation at every number of trajectories.

use libration::ensemble::{Execution, InsufficientMemory};
use libration_report::record::{Record, Series, Table};
use libration_study::{Lab, StudyError};

use crate::bench::{Bench, BenchFloat, Contestant, Implementation, Task, prepare, with_float};
use crate::measurement::Measurement;
use crate::throughput::ThroughputSettings;

/// Steps that are taken with a block of trajectories before the next.
const FUSED: u64 = 200;

/// Steps that are taken with a lone trajectory before the next.
const LONE: u64 = 64;

/// The most trajectories that are taken one by one: their rate does not depend on their number.
const MOST_LONE: usize = 100_000;

/// An implementation, a float and a number of trajectories, to be timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The implementation.
    pub implementation: Implementation,
    /// The float.
    pub float: BenchFloat,
    /// Number of trajectories.
    pub count: usize,
}

impl Wanted {
    /// Whether there is memory enough.
    ///
    /// # Errors
    /// [`InsufficientMemory`] if not.
    pub fn check(self) -> Result<(), InsufficientMemory> {
        let numbers = arrays(self.implementation) as u128 * self.count as u128;
        InsufficientMemory::check(numbers * self.float.bytes() as u128)
    }
}

/// Rate of an implementation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// The implementation.
    pub implementation: Implementation,
    /// The float.
    pub float: BenchFloat,
    /// Number of trajectories.
    pub count: usize,
    /// Steps a second of all of them together, the median of the repeats.
    pub median: f64,
    /// The distance between the quartiles of the repeats.
    pub spread: f64,
}

/// Times what is wanted, one after another, as `lab` is configured.
///
/// # Errors
/// If the run is to stop, or memory, threads or instruction set are not to be had.
pub fn ladder(lab: &Lab<'_>, wanted: &[Wanted]) -> Result<Vec<Rate>, StudyError> {
    let measurement = Measurement::new(lab)?;
    wanted.iter().map(|&wanted| rate(&measurement, wanted)).collect()
}

/// Measures what the configuration asks for, as far as effort and memory go.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let most = measurement.lab.effort.choose(1_000_000, 10_000_000, usize::MAX);
    let counts = measurement.lab.config.get::<ThroughputSettings>().counts.into_iter();
    let counts = counts.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
    let (counts, beyond): (Vec<usize>, Vec<usize>) = counts.partition(|&count| count <= most);
    let mut missing =
        Table::new("not timed", &["implementation", "float", "trajectories", "because"]);
    for &count in &beyond {
        let because = format!("a run of this effort goes to {most}");
        missing.push(["all".into(), "both".into(), (count as u64).into(), because.into()]);
    }
    for &implementation in &measurement.lab.config.get::<ThroughputSettings>().implementations {
        for &count in counts.iter().filter(|&&n| implementation.is_lone() && n > MOST_LONE) {
            let because = format!("one by one, more than {MOST_LONE} take as long each");
            let name = implementation.title().into();
            missing.push([name, "both".into(), (count as u64).into(), because.into()]);
        }
        for float in BenchFloat::ALL {
            let mut points = Vec::new();
            for &count in &counts {
                let wanted = Wanted { implementation, float, count };
                if implementation.is_lone() && count > MOST_LONE {
                    continue;
                }
                match wanted.check() {
                    Ok(()) => points.push(rate(measurement, wanted)?),
                    Err(no_room) => missing.push([
                        implementation.title().into(),
                        float.name().into(),
                        (count as u64).into(),
                        no_room.to_string().into(),
                    ]),
                }
            }
            if !points.is_empty() {
                record.series.push(series(implementation, float, &points));
            }
        }
    }
    record.tables.push(missing);
    Ok(())
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

fn rate(measurement: &Measurement<'_>, wanted: Wanted) -> Result<Rate, StudyError> {
    let Wanted { implementation, float, count } = wanted;
    let contestant = with_float!(float, T => {
        contestant::<T>(implementation, measurement.task(count), &measurement.parallel)
    })?;
    let [rates] = measurement.sweep_rates([contestant])?;
    Ok(Rate { implementation, float, count, median: rates.median(), spread: rates.spread() })
}

fn contestant<T: Bench>(
    implementation: Implementation,
    task: Task,
    execution: &Execution,
) -> Result<Contestant<'static>, StudyError> {
    let mut rung = prepare::<T>(implementation, task, execution)?;
    let steps = match implementation {
        // Enough for the chain to take the time; of many a turn is long as it is.
        one if one.is_lone() && task.count <= MOST_LONE => LONE,
        one if one.is_fused() => FUSED,
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

fn series(implementation: Implementation, float: BenchFloat, rates: &[Rate]) -> Series {
    let column = |value: fn(&Rate) -> f64| rates.iter().map(value).collect();
    Series::new(series_name(implementation, float))
        .with("trajectories", "1", column(|rate| rate.count as f64))
        .with("steps_per_second", "1/s", column(|rate| rate.median))
        .with("spread", "1/s", column(|rate| rate.spread))
}
