//! Rates against the number of environments and against the horizon.

use libration_report::record::{Record, Series};
use libration_study::StudyError;

use crate::bench::{Rates, RolloutCase, RolloutTask, fill, rollout, suited};
use crate::measurement::Measurement;

/// Environments whose horizons are varied.
const ENVIRONMENTS: usize = 1024;

/// The variable of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Varied {
    Environments,
    Horizon,
}

impl Varied {
    pub(super) const ALL: [Varied; 2] = [Varied::Environments, Varied::Horizon];

    /// Its column.
    pub(super) fn name(self) -> &'static str {
        match self {
            Varied::Environments => "environments",
            Varied::Horizon => "horizon",
        }
    }

    /// Returns the case of a rollout.
    fn cases(self, measurement: &Measurement<'_>) -> Vec<RolloutCase> {
        let effort = measurement.lab.effort;
        let of = |environments, horizon| RolloutCase {
            task: RolloutTask::Regulate,
            environments,
            horizon,
        };
        let powers = |base: usize, most: u32| (0..=most).map(move |power| base.pow(power));
        match self {
            Varied::Environments => {
                let horizon = effort.choose(64, 256, 256);
                let (base, most) = effort.choose((4, 4), (2, 10), (2, 10));
                powers(base, most).map(|n| of(16 * n, horizon)).collect()
            }
            Varied::Horizon => {
                let most = effort.choose(4, 6, 6);
                powers(4, most).map(|horizon| of(ENVIRONMENTS, horizon)).collect()
            }
        }
    }
}

/// Names of the two executions in series.
pub(super) const EXECUTIONS: [&str; 2] = ["one", "all"];

/// The name of the series of an execution.
pub(super) fn series_name(varied: Varied, execution: &str) -> String {
    format!("scaling-{}-{execution}", varied.name())
}

/// Times both sweeps, on one core and on all, in turn with fills.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    for varied in Varied::ALL {
        let cases = varied.cases(measurement);
        let cases: Vec<_> = cases.into_iter().filter(|case| case.check().is_ok()).collect();
        for (execution, name) in measurement.executions().zip(EXECUTIONS) {
            let mut rates: Vec<[Rates; 2]> = Vec::new();
            for &case in &cases {
                let writes = suited(case.bytes());
                let plan = case.plan().writes(writes);
                let contestants = [rollout(case, plan, execution)?, fill(case, writes, execution)?];
                rates.push(measurement.sweep_rates(contestants)?);
            }
            let count =
                |of: fn(&RolloutCase) -> usize| cases.iter().map(|c| of(c) as f64).collect();
            let rate = |of: fn(&[Rates; 2]) -> f64| rates.iter().map(of).collect();
            record.series.push(
                Series::new(series_name(varied, name))
                    .with("environments", "1", count(|case| case.environments))
                    .with("horizon", "1", count(|case| case.horizon))
                    .with("transitions_per_second", "1/s", rate(|[own, _]| own.median()))
                    .with("spread", "1/s", rate(|[own, _]| own.spread()))
                    .with("fill", "1/s", rate(|[_, fill]| fill.median())),
            );
        }
    }
    Ok(())
}
