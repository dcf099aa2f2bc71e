//! Rollouts against fills of as much memory: in both layouts, written through the caches and past them.

use libration::rl::{Layout, Writes};

use crate::Effort;
use crate::bench::{RolloutCase, RolloutTask, fill, rollout};
use crate::machine::Machine;
use crate::record::{Cell, Finding, Record, Table};
use crate::studies::desk::{Desk, aim};
use crate::study::StudyError;

/// Bytes of a rollout that is too large for a quick run.
const LARGE: usize = 1 << 28;

const LAYOUTS: [(Layout, &str); 2] =
    [(Layout::Interleaved, "interleaved"), (Layout::Planes, "planes")];

const WAYS: [(Writes, &str); 2] = [(Writes::Plain, "plain"), (Writes::Past, "past the caches")];

/// The share of a fill that a rollout is to reach on so many threads, if it is to reach one.
fn bar(case: RolloutCase, threads: usize) -> Option<f64> {
    match (case.task, case.environments, case.horizon) {
        (RolloutTask::SwingUp, ..) => None,
        // What no cache holds.
        (_, 4096, 1024) | (_, 16_384, 2048) => Some(0.9),
        // What the last one holds; less than that is not worth a second thread.
        (_, 256, 16) | (_, 512, 64) | (_, 1024, 512) if threads == 1 => Some(0.6),
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

/// What identifiers end with on so many threads.
pub(super) fn on(threads: usize) -> &'static str {
    if threads == 1 { "" } else { ".threads" }
}

/// As the page says it.
pub(super) fn on_cores(threads: usize) -> String {
    if threads == 1 { "one core".into() } else { format!("up to {threads} threads") }
}

/// How a rollout of so many bytes is best written on this machine.
pub(super) fn suited(bytes: usize) -> Writes {
    let last = Machine::detect().caches.last().map_or(32 << 20, |cache| cache.bytes);
    Writes::suited(bytes as u128, last)
}

/// Times all of them, as far as effort and memory go.
pub(super) fn measure(desk: &Desk<'_>, record: &mut Record) -> Result<(), StudyError> {
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
            "past (10⁶/s)",
            "share of such a fill",
        ],
    );
    for case in RolloutCase::ALL {
        let refused = match case.check() {
            _ if desk.lab.effort == Effort::Quick && case.bytes() >= LARGE => {
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
        timed(desk, case, record, &mut table)?;
    }
    record.tables.push(table);
    record.tables.push(missing);
    Ok(())
}

/// Races one case against its fills.
fn timed(
    desk: &Desk<'_>,
    case: RolloutCase,
    record: &mut Record,
    table: &mut Table,
) -> Result<(), StudyError> {
    for execution in desk.executions() {
        let threads = execution.thread_count();
        let mut best = [0.0_f64; 2];
        for (l, (layout, layout_name)) in LAYOUTS.into_iter().enumerate() {
            let mut contestants = Vec::new();
            for (writes, _) in WAYS {
                let plan = case.plan().layout(layout).writes(writes);
                contestants.push(rollout(case, plan, execution)?);
                contestants.push(fill(case, writes, execution)?);
            }
            let rates = desk.race_of(&mut contestants)?;
            let mut row: Vec<Cell> = vec![
                case.task.name().into(),
                (case.environments as u64).into(),
                (case.horizon as u64).into(),
                (threads as u64).into(),
                layout_name.into(),
            ];
            for ((writes, way), pair) in WAYS.into_iter().zip(rates.chunks_exact(2)) {
                let (rate, share) = (pair[0].median(), pair[0].over(&pair[1]));
                best[l] = best[l].max(rate);
                row.extend([(rate / 1e6).into(), share.median().into()]);
                if layout == Layout::Interleaved && writes == suited(case.bytes()) {
                    let id = format!("rollout.{}{}", name(case), on(threads));
                    let text = format!(
                        "{}, {} × {}, {}, written {way}: transitions a second over those of a fill of as \
                         much memory",
                        case.task.name(),
                        case.environments,
                        case.horizon,
                        on_cores(threads)
                    );
                    let reason = "a fill waits for its stores alone, a rollout for its steps as well; the \
                                  table of layouts has other ways to write";
                    aim(record, id, text, bar(case, threads), &share, reason);
                }
            }
            table.push(row);
        }
        tell(record, case, threads, best);
    }
    Ok(())
}

/// The rates of both layouts, in the faster way to write them.
fn tell(record: &mut Record, case: RolloutCase, threads: usize, [one, planes]: [f64; 2]) {
    let (name, on) = (name(case), on(threads));
    let what = format!("{} × {}, {}", case.environments, case.horizon, on_cores(threads));
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
