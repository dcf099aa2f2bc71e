//! A data set on its way to the disk.

use std::path::Path;
use std::sync::mpsc::{channel, sync_channel};
use std::thread::{Builder, ScopedJoinHandle};
use std::{io, thread};

use libration::ensemble::{EnsembleError, Execution};
use libration::rl::{Plan, Rollout};
use libration_data::{Flaw, Folder, Manifest, Stored, write_files};
use serde_json::{Map, Value, json};

use super::again::misplaced;
use super::chunk::{Done, Rows};
use super::episodes::Episodes;
use super::minari::Before;
use super::repair::{Described, broken, repair};
use super::room::{Try, missing};
use super::world::{Group, Number, Visit};
use super::{DataFormat, Dataset, DatasetError, Watch};
use crate::environments::{Actor, Batch};

/// What is to be written, and where.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// The data set.
    pub dataset: &'a Dataset,
    /// How.
    pub format: DataFormat,
    /// Which part of it, from 1 on, and of how many.
    pub shard: [usize; 2],
    /// The folder.
    pub out: &'a Path,
    /// Whether to go on where an earlier run stopped.
    pub resume: bool,
    /// Where environments are stepped, and as many threads encode.
    pub execution: Execution,
}

/// Groups of a shard.
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

/// What the manifest of a part says.
pub(super) fn head(
    dataset: &Dataset,
    format: DataFormat,
    groups: [usize; 2],
) -> Map<String, Value> {
    let mut head = dataset.settings(format);
    head.insert("groups".to_owned(), json!(groups));
    head
}

/// Writes a data set, or a shard of it: one chunk is computed while the one before is written. Gives what is there then.
///
/// With `resume` it first reads the chunks that are there, at the speed of the disk, compares their checksums, and computes broken
/// ones again.
///
/// # Errors
/// See [`DatasetError`]; whatever the error, the chunks that were told as done are on the disk, and a run with `resume` goes on
/// after them.
pub fn write(job: &Job<'_>, watch: &dyn Watch) -> Result<Manifest, DatasetError> {
    let Job { dataset, format, shard, out, resume, ref execution } = *job;
    let [first, end] = groups(dataset, format, shard)?;
    // Whatever cannot be is said before a folder is made.
    let attempt = Try { dataset, format, threads: execution.thread_count() };
    dataset.with(dataset.group(first), &Execution::serial(), attempt)??;
    let mut folder = Folder::open(out, &head(dataset, format, [first, end]), resume)?;
    let chunks = dataset.chunks();
    let mut there = folder.manifest().chunks.len() as u64;
    if let Some(what) = misplaced(&folder.manifest().chunks, [first, end], chunks) {
        return Err(DatasetError::Order { folder: out.to_owned(), what });
    }
    for chunk in &folder.manifest().chunks {
        let number = |name: &str| chunk.holds.get(name).and_then(Value::as_u64).unwrap_or(0);
        watch.there(number("transitions"), chunk.bytes());
    }
    let flaws = broken(out, folder.manifest(), watch)?;
    let described = Described { dataset, format, groups: [first, end] };
    let mut lost = repair(&folder, &described, &flaws, execution, watch)?.into_iter();
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
            watch,
        };
        dataset.with(group, execution, stream)??;
        there = 0;
    }
    Ok(folder.manifest().clone())
}

/// The chunks of a group, from one on.
struct Stream<'a> {
    dataset: &'a Dataset,
    format: DataFormat,
    group: Group,
    from: u64,
    folder: &'a mut Folder,
    threads: usize,
    watch: &'a dyn Watch,
}

/// Steps of a group through its chunks: what was done in each, into memory that is used again.
pub(super) struct Course<'a, T: Number, const O: usize> {
    pub(super) dataset: &'a Dataset,
    pub(super) group: Group,
    pub(super) all: Box<dyn Batch<T, O>>,
    pub(super) actor: Actor<'static, T, O>,
    format: DataFormat,
    /// Where they are wanted.
    episodes: Option<Episodes<T, O>>,
}

impl<'a, T: Number, const O: usize> Course<'a, T, O> {
    /// From the first step on.
    pub(super) fn new(
        dataset: &'a Dataset,
        format: DataFormat,
        group: Group,
        all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self {
        let episodes = || Episodes::new(group.first, group.len, dataset.longest());
        let episodes = (format == DataFormat::Minari).then(episodes);
        Course { dataset, group, all, actor, format, episodes }
    }

    /// The next chunk, in the memory of an older one where that is as large.
    pub(super) fn next(&mut self, used: Option<Done<T, O>>) -> Result<Done<T, O>, DatasetError> {
        let Dataset { chunk, steps, .. } = *self.dataset;
        let first = self.all.step();
        let horizon = (steps - first).min(chunk.steps as u64) as usize;
        let plan = Plan::new(horizon, self.group.len).truncated().layout(self.format.layout());
        let used = used.filter(|done| done.rollout.plan() == plan);
        let mut done = match used {
            Some(done) => done,
            None => Done {
                group: self.group,
                chunk: 0,
                first: 0,
                rollout: Rollout::new(plan)?,
                episodes: Vec::new(),
                next: vec![T::zero(); self.group.len * O],
                rows: Rows::default(),
            },
        };
        (done.chunk, done.first) = (first / chunk.steps as u64, first);
        self.all.rollout(self.actor, &mut done.rollout)?;
        self.all.observe(&mut done.next)?;
        if let Some(episodes) = &mut self.episodes {
            let ended = episodes.take(first, &done.rollout);
            done.episodes = ended.map_err(|room| missing(self.dataset, room))?;
            if self.all.step() == steps {
                done.episodes.extend(episodes.cut(&done.next));
            }
        }
        Ok(done)
    }
}

impl Visit for Stream<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, const O: usize>(
        self,
        all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output {
        let Stream { dataset, format, group, from, folder, threads, watch } = self;
        let mut course = Course::new(dataset, format, group, all, actor);
        // What follows from the settings is computed again faster than it is read.
        let mut used = None;
        for _ in 0..from {
            used = Some(course.next(used)?);
            if watch.stops() {
                return Err(DatasetError::Interrupted);
            }
        }
        let mut before = Before::of(&folder.manifest().chunks);
        let path = folder.path().to_owned();
        let write = |done: Done<T, O>, before: Before| {
            stored(done, before, dataset, format, threads, &path)
        };
        let write = &write;
        thread::scope(|scope| {
            // One chunk is waited for, two more may be written, and one is computed: the disk has no time to rest, and a chunk that
            // is encoded no need to wait for it.
            let (send, turns) = sync_channel::<Turn<'_, T, O>>(1);
            let (give_back, free) = channel();
            let tell = move || {
                for turn in turns {
                    let turn = turn.join().unwrap_or(Err(DatasetError::Interrupted))?;
                    let Written { done, after, holds, files } = turn;
                    let bytes = files.iter().map(|file| file.bytes).sum();
                    folder.record(&done.name(), holds, files)?;
                    watch.done(done.rollout.plan().transitions() as u64, bytes);
                    // Whoever computes may have come to the end.
                    let _ = give_back.send((done, after));
                }
                Ok(())
            };
            let teller = Builder::new().spawn_scoped(scope, tell).map_err(no_thread)?;
            let mut compute = || {
                for _ in from..dataset.chunks() {
                    if watch.stops() {
                        return Err(DatasetError::Interrupted);
                    }
                    let done = course.next(used.take())?;
                    let writer = Builder::new().spawn_scoped(scope, move || write(done, before));
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
            // What went wrong first is what the other heard of.
            written.and(computed)
        })
    }
}

/// That the system gives no thread to write a chunk.
fn no_thread(error: io::Error) -> DatasetError {
    EnsembleError::Threads { threads: 1, reason: error.to_string() }.into()
}

/// Somebody who writes a chunk.
type Turn<'scope, T, const O: usize> =
    ScopedJoinHandle<'scope, Result<Written<T, O>, DatasetError>>;

/// A chunk whose files are on the disk.
struct Written<T, const O: usize> {
    done: Done<T, O>,
    /// What is before the next one.
    after: Before,
    holds: Map<String, Value>,
    files: Vec<Stored>,
}

/// Writes the files of a chunk.
fn stored<T: Number, const O: usize>(
    mut done: Done<T, O>,
    before: Before,
    dataset: &Dataset,
    format: DataFormat,
    threads: usize,
    folder: &Path,
) -> Result<Written<T, O>, DatasetError> {
    let holds = done.holds(dataset, format, before);
    let files = done.files(dataset, format, threads, before)?;
    let (after, files) = (files.after, write_files(folder, &files.list())?);
    Ok(Written { done, after, holds, files })
}
