//! Comparison of implementations, from the curves of the record.

use libration_report::record::{Finding, Record, RecordError, Series, Table};

use super::scaling::series_name;
use crate::bench::{BenchFloat, Implementation, PASSES, Traffic};

/// Numbers of trajectories at which the source compares (§5.1), and one that no near cache holds.
const MANY: [f64; 3] = [1e3, 1e5, 1e6];

/// Arrays that formula 5.6 says a step reads or writes.
const FORMULA: f64 = 4.0;

/// Compares what the curves have in common.
pub(super) fn compare(record: &mut Record) -> Result<(), RecordError> {
    gains(record);
    shapes(record);
    traffic(record)
}

/// Records the speedups between implementations at several numbers of trajectories.
fn gains(record: &mut Record) {
    use Implementation::{Fused, InPlace, OneStep, Scalar, Temporaries};
    for (one, other) in
        [(InPlace, Temporaries), (Fused, InPlace), (InPlace, Scalar), (Fused, OneStep)]
    {
        for float in BenchFloat::ALL {
            for count in std::iter::once(1.0).chain(MANY) {
                let rate = |implementation| rate(record, implementation, float, count);
                let Some(gain) = rate(one).zip(rate(other)).map(|(one, other)| one / other) else {
                    continue;
                };
                record.find(Finding::measured(
                    gain_id(one, other, float, count),
                    format!(
                        "{}, N = {}: steps a second, {} over {}",
                        float.name(),
                        libration_report::notation::number(count, 3),
                        one.title(),
                        other.title()
                    ),
                    "1",
                    gain,
                ));
            }
        }
    }
    for implementation in Implementation::ALL {
        for count in MANY {
            let rate = |float| rate(record, implementation, float, count);
            let Some((single, double)) = rate(BenchFloat::F32).zip(rate(BenchFloat::F64)) else {
                continue;
            };
            record.find(Finding::measured(
                format!("throughput.single-over-double.{}.{count:e}", implementation.name()),
                format!(
                    "{}, N = {}: steps a second in f32 over f64",
                    implementation.title(),
                    libration_report::notation::number(count, 3)
                ),
                "1",
                single / double,
            ));
        }
    }
}

/// The identifier of a gain.
pub(super) fn gain_id(
    one: Implementation,
    other: Implementation,
    float: BenchFloat,
    count: f64,
) -> String {
    format!("throughput.{}-over-{}.{}.{count:e}", one.name(), other.name(), float.name())
}

/// Records the growth of rates with the number of trajectories, and their maxima.
fn shapes(record: &mut Record) {
    for implementation in [Implementation::Scalar, Implementation::InPlace, Implementation::Fused] {
        let name = implementation.name();
        let rate = |count| rate(record, implementation, BenchFloat::F32, count);
        let growth =
            |from: f64, to: f64| Some((rate(to)? / rate(from)?).log10() / (to / from).log10());
        let all = [("few", 1.0, 100.0), ("many", 1e3, 1e5)];
        let all = all.map(|(which, from, to)| (which, from, to, growth(from, to)));
        let most = record.series(&series_name(implementation, BenchFloat::F32));
        let most = most.ok().and_then(|s| s.column("steps_per_second").ok()).map(<[f64]>::to_vec);
        for (which, from, to, growth) in all {
            let Some(growth) = growth else { continue };
            record.find(Finding::measured(
                format!("throughput.growth.{name}.{which}"),
                format!(
                    "{}, f32: the power of N with which steps a second grow from {from} to {to}",
                    implementation.title()
                ),
                "1",
                growth,
            ));
        }
        if let Some(most) = most {
            record.find(Finding::measured(
                format!("throughput.best.{name}"),
                format!("{}, f32: the most steps a second, at any N", implementation.title()),
                "1/s",
                most.into_iter().fold(0.0, f64::max),
            ));
        }
    }
}

/// Bytes that are really moved, beside those of formula 5.6.
fn traffic(record: &mut Record) -> Result<(), RecordError> {
    let mut table = Table::new(
        "bytes of a step",
        &[
            "implementation",
            "float",
            "arrays read or written",
            "by formula 5.6",
            "largest N",
            "moved there (GB/s)",
            "by formula 5.6 (GB/s)",
        ],
    );
    for implementation in
        [Implementation::Temporaries, Implementation::InPlace, Implementation::OneStep]
    {
        let arrays = arrays_of_a_step(implementation);
        for float in BenchFloat::ALL {
            let Ok(series) = record.series(&series_name(implementation, float)) else { continue };
            let (count, rate) = largest(series)?;
            let gigabytes = |arrays: f64| rate * arrays * float.bytes() as f64 / 1e9;
            table.push([
                implementation.title().into(),
                float.name().into(),
                arrays.into(),
                FORMULA.into(),
                (count as u64).into(),
                gigabytes(arrays).into(),
                gigabytes(FORMULA).into(),
            ]);
            let name = format!("{}.{}", implementation.name(), float.name());
            record.find(Finding::measured(
                format!("throughput.formula.{name}"),
                format!(
                    "{}, {}, N = {}: bytes a second by formula 5.6",
                    implementation.title(),
                    float.name(),
                    libration_report::notation::number(count, 3)
                ),
                "GB/s",
                gigabytes(FORMULA),
            ));
        }
        record.find(Finding::measured(
            format!("throughput.arrays.{}", implementation.name()),
            format!(
                "{}: arrays that a step reads or writes, counted pass by pass, over the four of \
                 formula 5.6",
                implementation.title()
            ),
            "1",
            arrays / FORMULA,
        ));
    }
    record.tables.push(table);
    Ok(())
}

/// Arrays that a step reads or writes.
pub(super) fn arrays_of_a_step(implementation: Implementation) -> f64 {
    match implementation {
        Implementation::Temporaries | Implementation::InPlace => {
            PASSES.map(Traffic::arrays).iter().sum::<usize>() as f64
        }
        // Position and velocity, each read and written.
        _ => FORMULA,
    }
}

/// The last point of a curve: number of trajectories and rate.
fn largest(series: &Series) -> Result<(f64, f64), RecordError> {
    let last = |column: &str| -> Result<f64, RecordError> {
        Ok(series.column(column)?.last().copied().unwrap_or(f64::NAN))
    };
    Ok((last("trajectories")?, last("steps_per_second")?))
}

/// The rate of an implementation at a number of trajectories, if it was measured.
fn rate(
    record: &Record,
    implementation: Implementation,
    float: BenchFloat,
    count: f64,
) -> Option<f64> {
    let series = record.series(&series_name(implementation, float)).ok()?;
    let counts = series.column("trajectories").ok()?;
    let at = counts.iter().position(|&n| n == count)?;
    series.column("steps_per_second").ok()?.get(at).copied()
}
