//! The limit of a rollout, from its rates.

use libration_report::record::{Finding, Record, RecordError, Series, Table};

use super::scaling::{EXECUTIONS, Varied, series_name};
use crate::scaling_regime::{Limit, regimes};

/// Least share of a fill for a limit by stores.
const STORES: f64 = 0.75;

/// The limit of a plateau.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bound {
    /// A fill of as much memory is hardly faster.
    Stores,
    /// The rate is far above that of the memory.
    Steps,
}

/// Divides every curve of the record into regimes.
pub(super) fn detect(record: &mut Record) -> Result<(), RecordError> {
    let columns = ["varied", "cores", "from", "to", "limited by", "best (10⁶/s)"];
    let mut table = Table::new("regimes", &columns);
    for varied in Varied::ALL {
        for execution in EXECUTIONS {
            let Ok(series) = record.series(&series_name(varied, execution)) else { continue };
            let counts = series.column(varied.name())?;
            let rates = series.column("transitions_per_second")?;
            let fills = series.column("fill")?;
            let bound = |count: f64, rate: f64| {
                let at = counts.iter().position(|&n| n == count);
                let fill = at.map_or(f64::NAN, |at| fills[at]);
                if rate >= STORES * fill { Bound::Stores } else { Bound::Steps }
            };
            for regime in regimes(counts, rates, bound) {
                table.push([
                    varied.name().into(),
                    execution.into(),
                    (regime.from as u64).into(),
                    (regime.to as u64).into(),
                    limit_label(varied, regime.limit).into(),
                    (regime.rate / 1e6).into(),
                ]);
            }
        }
    }
    record.tables.push(table);
    steps(record)
}

/// In words.
fn limit_label(varied: Varied, limit: Limit<Bound>) -> &'static str {
    match (limit, varied) {
        (Limit::Overhead, Varied::Environments) => "what a step costs at all",
        (Limit::Overhead, Varied::Horizon) => "what a rollout costs at all",
        (Limit::Plateau(Bound::Stores), _) => "stores: a fill is hardly faster",
        (Limit::Plateau(Bound::Steps), _) => "steps: a fill is much faster",
    }
}

/// The time of a step of all environments on one core.
fn steps(record: &mut Record) -> Result<(), RecordError> {
    let series = record.series(&series_name(Varied::Environments, EXECUTIONS[0]))?;
    let environments = series.column("environments")?.to_vec();
    let rates = series.column("transitions_per_second")?;
    let times: Vec<f64> = environments.iter().zip(rates).map(|(n, rate)| n / rate).collect();
    let ends =
        |values: &[f64]| [values.first(), values.last()].map(|x| x.copied().unwrap_or(f64::NAN));
    let ([least, _], [slowest, fastest]) = (ends(&times), ends(rates));
    let [fewest, _] = ends(&environments);
    record.find(Finding::measured(
        "rollout.step.least",
        format!("one core: time of a step of {fewest} environments, the fewest"),
        "s",
        least,
    ));
    record.find(Finding::measured(
        "rollout.step.fall",
        "one core: time of a transition of the fewest environments over that of the most",
        "1",
        fastest / slowest,
    ));
    let series = Series::new("steps").with("environments", "1", environments);
    record.series.push(series.with("seconds", "s", times));
    Ok(())
}
