//! Rollouts relative to fills of the same memory, in both layouts, with stores through and past the caches.

use libration::ensemble::Execution;
use libration::rl::{Layout, TransitionWork, Writes};
use libration_report::record::{Cell, Finding, Record, Table};
use libration_study::{Effort, StudyError};

use crate::bench::{Rates, RolloutCase, RolloutTask, fill, rollout, suited};
use crate::measurement::{Measurement, aim};

/// Bytes of a rollout that is too large for a quick run.
const LARGE: usize = 1 << 28;

const LAYOUTS: [(Layout, &str); 2] =
    [(Layout::Interleaved, "interleaved"), (Layout::Planes, "planes")];

const WAYS: [(Writes, &str); 2] = [(Writes::Plain, "plain"), (Writes::Past, "past the caches")];

/// The share of a fill that a rollout is to reach on so many threads, if it is to reach one.
fn bar(case: RolloutCase, threads: usize) -> Option<f64> {
    match (case.task, case.environments, case.horizon) {
        (RolloutTask::SwingUp, ..) => None,
        // What few caches hold.
        (_, 4096, 1024) | (_, 16_384, 2048) => Some(0.9),
        (_, 1024, 512) => Some(0.6),
        // Less than that is not worth a second thread.
        (_, 256, 16) | (_, 512, 64) | (_, 256, 512) if threads == 1 => Some(0.6),
        _ => None,
    }
}

/// As identifiers name a case.
pub(super) fn name(case: RolloutCase) -> String {
    let task = match case.task {
        RolloutTask::Regulate => "",
        RolloutTask::SwingUp => "swing-up-",
    };
    format!("{task}{}x{}", case.environments, case.horizon)
}

/// Returns the suffix of identifiers for a number of threads.
pub(super) fn on(threads: usize) -> &'static str {
    if threads == 1 { "" } else { ".threads" }
}

/// As the page says it.
pub(super) fn on_cores(threads: usize) -> String {
    if threads == 1 { "one core".into() } else { format!("{threads} threads") }
}

/// Times all of them, as far as effort and memory go.
pub(super) fn measure(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), StudyError> {
    let mut missing = Table::new("not timed", &["task", "environments", "horizon", "because"]);
    let mut table = Table::new(
        "layouts",
        &[
            "task",
            "environments",
            "horizon",
            "threads",
            "layout",
            "plain (10⁶/s)",
            "share of a fill",
            "non-temporal (10⁶/s)",
            "share of a non-temporal fill",
        ],
    );
    for case in RolloutCase::ALL {
        let refused = match case.check() {
            _ if measurement.lab.effort == Effort::Quick && case.bytes() >= LARGE => {
                Some(format!("a run of this effort goes to {} MiB", LARGE >> 20))
            }
            Ok(()) => None,
            Err(error) => Some(error.to_string()),
        };
        if let Some(because) = refused {
            let [environments, horizon] = [case.environments, case.horizon].map(|n| n as u64);
            missing.push([
                case.task.name().into(),
                environments.into(),
                horizon.into(),
                because.into(),
            ]);
            continue;
        }
        timed(measurement, case, record, &mut table)?;
    }
    record.tables.push(table);
    record.tables.push(missing);
    Ok(())
}

/// Races one case against its fills.
fn timed(
    measurement: &Measurement<'_>,
    case: RolloutCase,
    record: &mut Record,
    table: &mut Table,
) -> Result<(), StudyError> {
    for execution in measurement.executions() {
        let mut best = [0.0_f64; 2];
        for (l, (layout, layout_name)) in LAYOUTS.into_iter().enumerate() {
            let mut contestants = Vec::new();
            for (writes, _) in WAYS {
                let plan = case.plan().layout(layout).writes(writes);
                contestants.push(rollout(case, plan, execution)?);
                contestants.push(fill(case, writes, execution)?);
            }
            let rates = measurement.compare_rates_of(&mut contestants)?;
            let mut row: Vec<Cell> = vec![
                case.task.name().into(),
                (case.environments as u64).into(),
                (case.horizon as u64).into(),
                (case.plan().threads(execution, TransitionWork::SHORTEST) as u64).into(),
                layout_name.into(),
            ];
            for pair in rates.chunks_exact(2) {
                let (rate, share) = (pair[0].median(), pair[0].over(&pair[1]));
                best[l] = best[l].max(rate);
                row.extend([(rate / 1e6).into(), share.median().into()]);
            }
            if layout == Layout::Interleaved {
                compare(record, case, execution, &rates);
            }
            table.push(row);
        }
        add_row(record, case, execution, best);
    }
    Ok(())
}

/// Writes in the order that suits the machine, relative to a fill of the same memory.
fn compare(record: &mut Record, case: RolloutCase, execution: &Execution, rates: &[Rates]) {
    let at = |writes| if writes == Writes::Past { 2 } else { 0 };
    let (own, by) = (suited(case.bytes()), case.against());
    let share = rates[at(own)].over(&rates[at(by) + 1]);
    let [own, by] = [own, by].map(|w| if w == Writes::Past { WAYS[1].1 } else { WAYS[0].1 });
    let allowed = execution.thread_count();
    let id = format!("rollout.{}{}", name(case), on(allowed));
    let text = format!(
        "{}, {} × {}, {}, written {own}: transitions a second over those of a fill of as much memory, written {by}",
        case.task.name(),
        case.environments,
        case.horizon,
        on_cores(case.plan().threads(execution, TransitionWork::SHORTEST)),
    );
    let reason = "a fill waits for its stores alone, a rollout for its steps as well; the table of layouts has other ways to write";
    aim(record, id, text, bar(case, allowed), &share, reason);
}

/// The rates of both layouts, in the faster way to write them.
fn add_row(record: &mut Record, case: RolloutCase, execution: &Execution, [one, planes]: [f64; 2]) {
    let (name, on) = (name(case), on(execution.thread_count()));
    let threads = on_cores(case.plan().threads(execution, TransitionWork::SHORTEST));
    let what = format!("{} × {}, {threads}", case.environments, case.horizon);
    record.find(Finding::measured(
        format!("rollout.rate.{name}{on}"),
        format!("{}, {what}: transitions a second", case.task.name()),
        "1/s",
        one,
    ));
    record.find(Finding::measured(
        format!("rollout.planes.{name}{on}"),
        format!("{}, {what}: planes over interleaved, each as it is faster", case.task.name()),
        "1",
        planes / one,
    ));
}
