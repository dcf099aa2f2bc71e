//! The memory bandwidth of the machine.

use std::hint::black_box;

use libration::ensemble::{Buffer, Execution, Pages, available_memory, stream};
use libration_report::record::{Finding, Record, Table};
use libration_study::{Machine, StudyError};

use crate::bench::{Contestant, Rates, Triad, Update};
use crate::measurement::Measurement;

/// Element type of the arrays.
type Number = f32;

/// Three arrays together are this many times as large as the last cache.
const FAR: u64 = 6;

/// The size of all arrays of a measurement, in bytes: larger than the last cache, if the effort and
/// the memory allow.
pub(super) fn footprint(measurement: &Measurement<'_>) -> u64 {
    let last = Machine::detect().caches.last().map_or(32 << 20, |cache| cache.bytes);
    let most = measurement.lab.effort.choose(256 << 20, 2 << 30, 8 << 30);
    let free = available_memory().unwrap_or(1 << 30);
    (FAR * last).max(256 << 20).min(most).min(free / 4)
}

/// A loop over memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kernel {
    Copy,
    Stream,
    Triad,
    Update,
}

impl Kernel {
    const ALL: [Kernel; 4] = [Kernel::Copy, Kernel::Stream, Kernel::Triad, Kernel::Update];

    fn name(self) -> &'static str {
        match self {
            Kernel::Copy => "copy",
            Kernel::Stream => "stream",
            Kernel::Triad => "triad",
            Kernel::Update => "update",
        }
    }

    fn formula(self) -> &'static str {
        match self {
            Kernel::Copy => "b = a",
            Kernel::Stream => "b = a, past the caches",
            Kernel::Triad => "a = b + s·c",
            Kernel::Update => "y += s·x, x += t·y",
        }
    }

    /// Arrays that the program reads or writes; what a processor reads before it writes is not counted.
    fn arrays(self) -> usize {
        match self {
            Kernel::Copy | Kernel::Stream => 2,
            Kernel::Triad => 3,
            Kernel::Update => 4,
        }
    }
}

/// Measures bandwidths on one core and on all.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let mut table = Table::new(
        "bandwidth",
        &["loop", "formula", "arrays of (MiB)", "one core (GB/s)", "all cores (GB/s)"],
    );
    let len =
        usize::try_from(footprint(measurement)).unwrap_or(usize::MAX) / 3 / size_of::<Number>();
    let mut planes = Vec::new();
    for _ in 0..3 {
        planes.push(Buffer::<Number>::new(len, Pages::Huge)?);
    }
    for kernel in Kernel::ALL {
        let mut rates = Vec::new();
        for execution in measurement.executions() {
            rates.push(bandwidth(measurement, kernel, &mut planes, execution)?);
        }
        let gigabytes: Vec<f64> = rates.iter().map(|rate| rate.median() / 1e9).collect();
        let all = gigabytes.last().copied().unwrap_or(f64::NAN);
        record.find(Finding::measured(
            format!("throughput.bandwidth.{}", kernel.name()),
            format!(
                "{} on all cores, arrays of {} MiB each: bytes that the program reads and writes",
                kernel.formula(),
                mebibytes(len)
            ),
            "GB/s",
            all,
        ));
        record.find(Finding::measured(
            format!("throughput.bandwidth.{}.one-core", kernel.name()),
            format!(
                "{} on one core, arrays of {} MiB each: bytes that the program reads and writes",
                kernel.formula(),
                mebibytes(len)
            ),
            "GB/s",
            gigabytes[0],
        ));
        table.push([
            kernel.name().into(),
            kernel.formula().into(),
            (mebibytes(len) as u64).into(),
            gigabytes[0].into(),
            all.into(),
        ]);
    }
    record.tables.push(table);
    Ok(())
}

fn mebibytes(len: usize) -> usize {
    (len * size_of::<Number>()) >> 20
}

/// Bytes a second that `kernel` reads and writes on the threads of `execution`, each with its part of the planes.
fn bandwidth(
    measurement: &Measurement<'_>,
    kernel: Kernel,
    planes: &mut [Buffer<Number>],
    execution: &Execution,
) -> Result<Rates, StudyError> {
    let set = measurement.set();
    let [a, b, c] = planes else { return Err(StudyError::Exact("there are three planes".into())) };
    let len = a.len();
    let part = len.div_ceil(execution.thread_count()).next_multiple_of(64);
    // What was never written is all the same page of zeros, which a cache holds.
    for plane in [&mut *a, &mut *b, &mut *c] {
        execution.each(plane.chunks_mut(part).collect(), |part: &mut [Number]| part.fill(1.0));
    }
    let mut work = || {
        let planes = a.chunks_mut(part).zip(b.chunks_mut(part)).zip(c.chunks_mut(part));
        execution.each(planes.collect(), |((a, b), c)| match kernel {
            Kernel::Copy => b.copy_from_slice(a),
            Kernel::Stream => stream(a, b),
            Kernel::Triad => set.vectorize(Triad { a, b, c, s: black_box(0.5) }),
            Kernel::Update => {
                // Small enough for nothing to overflow, and unknown to the compiler.
                set.vectorize(Update { x: a, y: b, s: black_box(-1e-3), t: black_box(1e-3) });
            }
        });
        black_box(&*b);
    };
    let bytes = (kernel.arrays() * len * size_of::<Number>()) as f64;
    let contestant = Contestant::new(bytes, |times| (0..times).for_each(|_| work()));
    let [rates] = measurement.sweep_rates([contestant])?;
    Ok(rates)
}
