//! Writer of data sets.

use std::path::Path;
use std::sync::mpsc::{channel, sync_channel};
use std::thread::{Builder, ScopedJoinHandle};
use std::{io, thread};

use libration::ensemble::{EnsembleError, Execution};
use libration_data::{Comparison, Flaw, Folder, Manifest, Stored, write_files};
use serde_json::{Map, Value};

use super::chunk_files::ChunkRollout;
use super::chunk_order::find_misplaced;
use super::group::{Group, GroupVisitor, Number};
use super::group_rollout::GroupRollout;
use super::manifest_settings::manifest_head;
use super::memory_check::TrialStep;
use super::minari::Totals;
use super::repair::{DatasetPart, find_broken, repair};
use super::resume_state::ResumeState;
use super::{DataFormat, Dataset, DatasetError, Monitor};
use crate::environments::AnyEnvironments;

/// A data set to write.
#[derive(Clone, Debug)]
pub struct WriteJob<'a> {
    /// The data set.
    pub dataset: &'a Dataset,
    /// The format.
    pub format: DataFormat,
    /// The number of the shard, from 1, and the number of shards.
    pub shard: [usize; 2],
    /// The folder.
    pub out: &'a Path,
    /// Whether to resume an interrupted data set.
    pub resume: bool,
    /// The execution of environments; as many threads encode chunks.
    pub execution: Execution,
}

/// The range of groups of a shard.
pub(super) fn groups(
    dataset: &Dataset,
    format: DataFormat,
    [index, of]: [usize; 2],
) -> Result<[usize; 2], DatasetError> {
    let groups = dataset.groups();
    if index == 0 || index > of || of > groups {
        return Err(DatasetError::Shard { index, of, groups });
    }
    if of > 1 && format == DataFormat::Minari {
        return Err(DatasetError::Whole { of });
    }
    Ok([groups * (index - 1) / of, groups * index / of])
}

/// Writes a data set or a shard: computes a chunk while it writes the one before. Returns the manifest.
///
/// With `resume` it continues from the state that the interrupted run wrote last. It compares the lengths of all files with the manifest, and
/// recomputes files that are missing or have another length; it reads none of them ([`verify`](super::verify) does).
///
/// # Errors
/// See [`DatasetError`]. After an error the reported chunks are on the disk, and a run with `resume` continues after them.
pub fn write(job: &WriteJob<'_>, monitor: &dyn Monitor) -> Result<Manifest, DatasetError> {
    let WriteJob { dataset, format, shard, out, resume, ref execution } = *job;
    let [first, end] = groups(dataset, format, shard)?;
    let (all, most) = ((end - first) as u64, Manifest::most_chunks(format.files()));
    let all = all.saturating_mul(dataset.chunks());
    if all > most {
        return Err(DatasetError::Chunks { chunks: all, most });
    }
    // Invalid settings fail before the folder is created.
    let attempt = TrialStep { dataset, format, threads: execution.thread_count() };
    dataset.with(dataset.group(first), &Execution::serial(), attempt)??;
    let mut folder = Folder::open(out, &manifest_head(dataset, format, [first, end]), resume)?;
    let chunks = dataset.chunks();
    let mut there = folder.manifest().chunks.len() as u64;
    if let Some(what) = find_misplaced(&folder.manifest().chunks, [first, end], chunks) {
        return Err(DatasetError::Order { folder: out.to_owned(), what });
    }
    for chunk in &folder.manifest().chunks {
        let number = |name: &str| chunk.holds.get(name).and_then(Value::as_u64).unwrap_or(0);
        monitor.on_present(number("transitions"), chunk.bytes());
    }
    let flaws = find_broken(out, folder.manifest(), Comparison::Length, monitor)?;
    let part = DatasetPart { dataset, format, groups: [first, end] };
    let mut lost = repair(&folder, &part, &flaws, execution, monitor)?.into_iter();
    if let Some(Flaw { path, what, .. }) = lost.next() {
        return Err(DatasetError::Unrepairable { path: out.join(path), what });
    }
    for number in first..end {
        if there >= chunks {
            there -= chunks;
            continue;
        }
        let group = dataset.group(number);
        let stream = Stream {
            dataset,
            format,
            group,
            from: there,
            folder: &mut folder,
            threads: execution.thread_count(),
            monitor,
        };
        dataset.with(group, execution, stream)??;
        there = 0;
    }
    ResumeState::remove(out)?;
    Ok(folder.manifest().clone())
}

/// The writer of the chunks of a group, from chunk `from` on.
struct Stream<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    from: u64,
    folder: &'a mut Folder,
    threads: usize,
    monitor: &'a dyn Monitor,
}

impl GroupVisitor for Stream<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number>(self, all: Box<dyn AnyEnvironments<T>>) -> Self::Output {
        let Stream { dataset, format, group, from, folder, threads, monitor } = self;
        let mut rollout = GroupRollout::new(dataset, format, group, all);
        let head = folder.manifest().settings.clone();
        let state = if from > 0 { ResumeState::load(folder.path(), &head) } else { None };
        let state = state.filter(|state| {
            state.group == group.number
                && state.chunks <= from
                && rollout.restore(state.bytes(), state.chunks)
        });
        let mut used = None;
        for _ in state.map_or(0, |state| state.chunks)..from {
            used = Some(rollout.next(used)?);
            monitor.on_recomputed();
            if monitor.should_stop() {
                return Err(DatasetError::Interrupted);
            }
        }
        let mut before = Totals::of_chunks(&folder.manifest().chunks);
        let path = folder.path().to_owned();
        let write = |done: ChunkRollout<T>, before: Totals, state: Option<ResumeState>| {
            let written = stored(done, before, dataset, format, threads, &path)?;
            Ok(Written { state, ..written })
        };
        let write = &write;
        thread::scope(|scope| {
            // Up to three chunks are encoded and written while one is computed, so that the disk and the cores stay busy.
            let (send, turns) = sync_channel::<Turn<'_, T>>(1);
            let (give_back, free) = channel();
            let tell = move || {
                for turn in turns {
                    let turn = turn.join().unwrap_or(Err(DatasetError::Interrupted))?;
                    let Written { done, after, holds, files, state } = turn;
                    let bytes = files.iter().map(|file| file.bytes).sum();
                    folder.record(&done.name(), holds, files)?;
                    // Never ahead of the manifest.
                    state.map_or(Ok(()), |state| state.save(folder.path()))?;
                    monitor.on_written(done.rollout.plan().transitions() as u64, bytes);
                    // The receiver may have finished.
                    let _ = give_back.send((done, after));
                }
                Ok(())
            };
            let teller = Builder::new().spawn_scoped(scope, tell).map_err(no_thread)?;
            let mut due = StateDue::default();
            let mut compute = || {
                for chunk in from..dataset.chunks() {
                    if monitor.should_stop() {
                        return Err(DatasetError::Interrupted);
                    }
                    let done = rollout.next(used.take())?;
                    // The group after the last chunk begins anew.
                    let is_due = due.after(done.bytes()) && chunk + 1 < dataset.chunks();
                    let state = is_due.then(|| {
                        let bytes = due.taken(rollout.to_bytes());
                        ResumeState::new(&head, group.number, chunk + 1, bytes)
                    });
                    let turn = move || write(done, before, state);
                    let writer = Builder::new().spawn_scoped(scope, turn);
                    if send.send(writer.map_err(no_thread)?).is_err() {
                        break;
                    }
                    if format == DataFormat::Minari {
                        // Episodes are numbered one chunk after the other.
                        let Ok((done, after)) = free.recv() else { break };
                        (used, before) = (Some(done), after);
                    } else {
                        used = free.try_recv().ok().map(|(done, _)| done);
                    }
                }
                Ok(())
            };
            let computed = compute();
            drop(send);
            let written = teller.join().unwrap_or(Err(DatasetError::Interrupted));
            // An error of the writer ends the computation, so it is the first error.
            written.and(computed)
        })
    }
}

/// The error of a thread that cannot be created.
fn no_thread(error: io::Error) -> DatasetError {
    EnsembleError::Threads { threads: 1, reason: error.to_string() }.into()
}

/// The thread that writes a chunk.
type Turn<'scope, T> = ScopedJoinHandle<'scope, Result<Written<T>, DatasetError>>;

/// A chunk with its files on the disk.
struct Written<T> {
    done: ChunkRollout<T>,
    /// The totals before the next chunk.
    after: Totals,
    holds: Map<String, Value>,
    files: Vec<Stored>,
    /// The state after the chunk, if it is written.
    state: Option<ResumeState>,
}

/// Decides after which chunks the state is written: when the chunks since the last one hold as many bytes as it.
///
/// To write states then takes at most as long as to write chunks, also where an episode of Minari stays open for a long time.
#[derive(Default)]
struct StateDue {
    state: u64,
    since: u64,
}

impl StateDue {
    /// Counts a chunk of `bytes` bytes. Returns whether the state after it is due.
    fn after(&mut self, bytes: u64) -> bool {
        self.since += bytes;
        self.since >= self.state
    }

    /// Counts a state, and returns it.
    fn taken(&mut self, state: Vec<u8>) -> Vec<u8> {
        (self.state, self.since) = (state.len() as u64, 0);
        state
    }
}

/// Writes the files of a chunk.
fn stored<T: Number>(
    mut done: ChunkRollout<T>,
    before: Totals,
    dataset: &Dataset,
    format: DataFormat,
    threads: usize,
    folder: &Path,
) -> Result<Written<T>, DatasetError> {
    let holds = done.manifest_entry(dataset, format, before);
    let files = done.files(dataset, format, threads, before)?;
    let (after, files) = (files.after, write_files(folder, &files.list())?);
    Ok(Written { done, after, holds, files, state: None })
}
