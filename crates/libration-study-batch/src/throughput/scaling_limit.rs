//! The limit of an implementation at a number of trajectories, from its rates.

use libration_report::record::{Finding, Record, RecordError, Table};
use libration_study::{Cache, Machine};

use super::comparison::arrays_of_a_step;
use super::scaling::{arrays, series_name};
use crate::bench::{BenchFloat, Implementation};
use crate::scaling_regime::{Limit, regimes};

/// A pass that moves no more than so many times the bytes of the loops over memory is bound by it.
const MEMORY: f64 = 1.2;

/// Divides every curve of the record into regimes.
pub(super) fn detect(record: &mut Record) -> Result<(), RecordError> {
    let caches = Machine::detect().caches;
    let memory = 1e9 * record.finding("throughput.bandwidth.update.one-core")?.measured;
    let mut table = Table::new(
        "regimes",
        &["implementation", "float", "from N", "to N", "limited by", "best rate (10⁹ steps/s)"],
    );
    for implementation in Implementation::ALL {
        for float in BenchFloat::ALL {
            let Ok(series) = record.series(&series_name(implementation, float)) else { continue };
            let (counts, rates) =
                (series.column("trajectories")?, series.column("steps_per_second")?);
            let bytes = arrays(implementation) * float.bytes();
            let moved = traffic(implementation, float);
            let held = |count: f64, rate: f64| match rate * moved <= MEMORY * memory {
                true => None,
                false => level(&caches, count * bytes as f64),
            };
            let all = regimes(counts, rates, held);
            for regime in &all {
                table.push([
                    implementation.title().into(),
                    float.name().into(),
                    (regime.from as u64).into(),
                    (regime.to as u64).into(),
                    limit_label(implementation, regime.limit, caches.len()).into(),
                    (regime.rate / 1e9).into(),
                ]);
            }
            let overhead = all.iter().filter(|regime| regime.is_overhead());
            let text = format!(
                "{}, {}: trajectories up to which the cost of a pass outweighs that of the trajectories",
                implementation.title(),
                float.name()
            );
            let last = overhead.map(|regime| regime.to).fold(0.0, f64::max);
            let id = format!("throughput.overhead.{}.{}", implementation.name(), float.name());
            record.find(Finding::measured(id, text, "1", last));
        }
    }
    record.tables.push(table);
    Ok(())
}

/// The smallest cache that holds so many bytes.
fn level(caches: &[Cache], bytes: f64) -> Option<u32> {
    caches.iter().find(|cache| cache.bytes as f64 >= bytes).map(|cache| cache.level)
}

/// Returns a label for the limit of a regime.
fn limit_label(implementation: Implementation, limit: Limit<Option<u32>>, caches: usize) -> String {
    match limit {
        Limit::Overhead if implementation.is_fused() => {
            "latency: a block takes as long, however few trajectories are in it".into()
        }
        Limit::Overhead => "the cost of a pass".into(),
        Limit::Plateau(_) if implementation.is_lone() => "one trajectory at a time".into(),
        Limit::Plateau(_) if implementation.is_fused() => {
            "arithmetic: no memory is waited for".into()
        }
        Limit::Plateau(Some(level)) => format!("its passes over cache {level}"),
        Limit::Plateau(None) if caches == 0 => "its passes over caches or memory".into(),
        Limit::Plateau(None) => "its passes over the memory".into(),
    }
}

/// Bytes that a step moves.
fn traffic(implementation: Implementation, float: BenchFloat) -> f64 {
    arrays_of_a_step(implementation) * float.bytes() as f64
}
