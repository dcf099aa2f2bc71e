//! What limits an implementation at a number of trajectories, read off its rates.

use super::comparison::arrays_of_a_step;
use super::scaling::{arrays, series_name};
use crate::bench::{BenchFloat, Implementation};
use crate::machine::{Cache, Machine};
use crate::record::{Finding, Record, RecordError, Table};

/// A rate that more trajectories reach so many times over is that of an overhead.
const OVERHEAD: f64 = 2.0;

/// A pass that moves no more than so many times the bytes of the loops over memory is bound by it.
const MEMORY: f64 = 1.2;

/// Rates within this factor of each other belong to one plateau.
const PLATEAU: f64 = 1.3;

/// A run of numbers of trajectories over which one thing limits the rate.
#[derive(Clone, Debug, PartialEq)]
struct Regime {
    from: f64,
    to: f64,
    limit: Limit,
    /// The largest rate in it, in steps a second.
    rate: f64,
}

/// What limits a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Limit {
    /// What a pass costs whatever the number of trajectories.
    Overhead,
    /// The arrays are in the cache of this level, or beyond all of them.
    Plateau(Option<u32>),
}

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
                    words(implementation, regime.limit, caches.len()).into(),
                    (regime.rate / 1e9).into(),
                ]);
            }
            let overhead = all.iter().filter(|regime| regime.limit == Limit::Overhead);
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

/// What a regime is limited by, as far as its rates and its arrays tell.
fn words(implementation: Implementation, limit: Limit, caches: usize) -> String {
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

/// Divides one curve: first where many more trajectories have a higher rate, then into plateaus, and where two
/// neighbours lie in different caches and their rates apart.
fn regimes(counts: &[f64], rates: &[f64], held: impl Fn(f64, f64) -> Option<u32>) -> Vec<Regime> {
    let mut all: Vec<Regime> = Vec::new();
    for (i, (&count, &rate)) in counts.iter().zip(rates).enumerate() {
        let best = rates[i..].iter().copied().fold(0.0, f64::max);
        let limit = match best >= OVERHEAD * rate {
            true => Limit::Overhead,
            false => Limit::Plateau(held(count, rate)),
        };
        match all.last_mut() {
            Some(last) if last.limit == Limit::Overhead && limit == Limit::Overhead => {
                last.to = count;
                last.rate = last.rate.max(rate);
            }
            Some(last)
                if last.limit != Limit::Overhead
                    && limit != Limit::Overhead
                    && last.rate.max(rate) < PLATEAU * last.rate.min(rate) =>
            {
                last.to = count;
                last.rate = last.rate.max(rate);
                // A plateau that reaches into a farther cache is not limited by the nearer.
                last.limit = limit;
            }
            _ => all.push(Regime { from: count, to: count, limit, rate }),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_cut_where_it_stops_growing_and_where_it_falls() {
        let counts = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];
        let rates = [1.0, 10.0, 90.0, 500.0, 480.0, 510.0, 100.0];
        let held = |count: f64, _| (count < 3e5).then_some(if count < 5e3 { 1 } else { 2 });
        let regime = |from, to, limit, rate| Regime { from, to, limit, rate };
        assert_eq!(
            regimes(&counts, &rates, held),
            [
                regime(1.0, 100.0, Limit::Overhead, 90.0),
                regime(1e3, 1e5, Limit::Plateau(Some(2)), 510.0),
                regime(1e6, 1e6, Limit::Plateau(None), 100.0),
            ]
        );
    }

    #[test]
    fn numbers_that_lie_close_or_far_apart_are_told_by_their_rates() {
        let all = regimes(&[1e3, 1.001e3, 1e6], &[5.0, 7.0, 6.0], |_, _| None);
        assert!(all.iter().all(|regime| regime.limit == Limit::Plateau(None)), "{all:?}");
        let all = regimes(&[3.0, 4.0, 1e6], &[0.2, 0.3, 9.0], |_, _| None);
        assert_eq!((all[0].to, all[0].limit), (4.0, Limit::Overhead), "{all:?}");
    }

    #[test]
    fn a_flat_curve_is_one_plateau() {
        let all = regimes(&[1.0, 10.0, 100.0], &[5.0, 5.1, 4.9], |_, _| Some(1));
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].from, all[0].to), (1.0, 100.0));
    }
}
