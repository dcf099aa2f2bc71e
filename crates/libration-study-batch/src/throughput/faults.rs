//! The cost of page faults of new memory.

use std::hint::black_box;

use libration::ensemble::{Buffer, Pages};
use libration_report::record::{Cell, Finding, Record, Relation, Table, Tolerance};
use libration_study::StudyError;

use super::scaling::Wanted;
use crate::bench::{BenchFloat, Contestant, Implementation, PAGE, Task, count_faults, prepare};
use crate::measurement::Measurement;

/// Numbers in the buffer that is written.
const LEN: usize = 16 << 20;

/// A huge page of x86-64.
const HUGE_PAGE: usize = 2 << 20;

/// Trajectories of the arrays whose temporaries are counted: too large for the allocator to keep.
const TRAJECTORIES: usize = 10_000_000;

/// Times writes to fresh and to warm memory, and counts the faults.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let mut table =
        Table::new("page faults", &["memory", "pages", "faults", "written (GB/s)", "over warm"]);
    let mut warm = Buffer::<f32>::new(LEN, Pages::Huge)?;
    let bytes = size_of_val(&*warm) as f64;
    let fresh = |pages: Pages| {
        Contestant::new(bytes, move |times| {
            for _ in 0..times {
                // Memory that is refused would be a fault of its own; it is no larger than the warm one.
                if let Ok(mut buffer) = Buffer::<f32>::new(LEN, pages) {
                    buffer.fill(black_box(1.0));
                    black_box(&*buffer);
                }
            }
        })
    };
    let again = Contestant::new(bytes, move |times| {
        for _ in 0..times {
            warm.fill(black_box(1.0));
            black_box(&*warm);
        }
    });
    let contestants = [again, fresh(Pages::Ordinary), fresh(Pages::Huge)];
    let [again, ordinary, huge] = measurement.sweep_rates(contestants)?;
    table.push([
        "warm".into(),
        Cell::absent("—"),
        0.into(),
        (again.median() / 1e9).into(),
        1.0.into(),
    ]);
    for (name, pages, rate, size) in
        [("fresh", Pages::Ordinary, &ordinary, PAGE), ("fresh huge", Pages::Huge, &huge, HUGE_PAGE)]
    {
        let faults = count_faults(|| {
            let mut buffer = Buffer::<f32>::new(LEN, pages)?;
            buffer.fill(black_box(1.0));
            black_box(&*buffer);
            Ok(())
        })?;
        let share = rate.over(&again);
        table.push([
            name.into(),
            if size == PAGE { "4 KiB".into() } else { "2 MiB".into() },
            faults.map_or_else(|| Cell::absent("not told"), Into::into),
            (rate.median() / 1e9).into(),
            share.median().into(),
        ]);
        let id = if size == PAGE { "ordinary" } else { "huge" };
        record.find(Finding::measured(
            format!("throughput.fresh.{id}"),
            format!("64 MiB of {name} pages, written once, over warm ones"),
            "1",
            share.median(),
        ));
        if let (Some(faults), Pages::Ordinary) = (faults, pages) {
            record.find(Finding::related(
                "throughput.faults.fresh",
                "page faults as 64 MiB of fresh memory are written, beside one for each page of 4 KiB",
                "1",
                Relation::AtMost,
                bytes / PAGE as f64,
                faults as f64,
                Tolerance::relative(
                    0.01,
                    "other threads of the process; fewer where the system hands out larger pages",
                ),
            ));
        }
    }
    temporaries(measurement, record, &mut table)?;
    record.tables.push(table);
    Ok(())
}

/// The page faults of a step whose every result is a new array.
fn temporaries(
    measurement: &Measurement<'_>,
    record: &mut Record,
    table: &mut Table,
) -> Result<(), StudyError> {
    let count = TRAJECTORIES;
    let float = BenchFloat::F32;
    if (Wanted { implementation: Implementation::Temporaries, float, count }).check().is_err() {
        return Ok(());
    }
    for implementation in [Implementation::Temporaries, Implementation::InPlace] {
        let task = Task { count, ..measurement.task(count) };
        let mut rung = prepare::<f32>(implementation, task, &measurement.serial)?;
        // The first steps make the allocator learn what it is asked for.
        rung.advance(2);
        let steps = 4;
        let Some(faults) = count_faults(|| {
            rung.advance(steps);
            Ok(())
        })?
        else {
            return Ok(());
        };
        let each = faults as f64 / steps as f64;
        record.find(Finding::measured(
            format!("throughput.faults.{}", implementation.name()),
            format!("{}, f32, N = {count}: page faults a step", implementation.title()),
            "1",
            each,
        ));
        table.push([
            format!("{}, a step", implementation.title()).into(),
            Cell::absent("—"),
            each.into(),
            Cell::absent("—"),
            Cell::absent("—"),
        ]);
    }
    Ok(())
}
