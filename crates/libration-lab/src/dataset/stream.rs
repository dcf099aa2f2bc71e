//! A data set on its way to the disk.

use std::path::Path;
use std::sync::mpsc::{Receiver, channel, sync_channel};
use std::thread;

use libration::ensemble::Execution;
use libration::rl::{Environments, Plan, Rollout, World};
use libration_data::{Folder, Manifest};
use serde_json::{Map, Value, json};

use super::actor::Actor;
use super::chunk::{Done, Rows};
use super::episodes::Episodes;
use super::world::{Group, Number, Visit};
use super::{DataFormat, Dataset, DatasetError};

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

/// Who watches a data set being written or read.
pub trait Watch: Sync {
    /// So many more transitions, in so many bytes, are done; those that were there before are told first.
    fn done(&self, transitions: u64, bytes: u64);

    /// Whether to stop.
    fn stops(&self) -> bool {
        false
    }
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
/// # Errors
/// See [`DatasetError`]; whatever the error, the chunks that were told as done are on the disk, and a run with `resume` goes on
/// after them.
pub fn write(job: &Job<'_>, watch: &dyn Watch) -> Result<Manifest, DatasetError> {
    let Job { dataset, format, shard, out, resume, ref execution } = *job;
    let [first, end] = groups(dataset, format, shard)?;
    // Whatever cannot be is said before a folder is made.
    dataset.with(dataset.group(first), &Execution::serial(), Try)??;
    let mut folder = Folder::open(out, &head(dataset, format, [first, end]), resume)?;
    let chunks = dataset.chunks();
    let mut there = folder.manifest().chunks.len() as u64;
    for (i, chunk) in folder.manifest().chunks.iter().enumerate() {
        let number = |name: &str| chunk.holds.get(name).and_then(Value::as_u64).unwrap_or(0);
        watch.done(number("transitions"), chunk.files.iter().map(|file| file.bytes).sum());
        let (group, k) = (first as u64 + i as u64 / chunks, i as u64 % chunks);
        let wanted = format!("{group:06}-{k:08}");
        if chunk.chunk != wanted || group >= end as u64 {
            let what = format!("chunk {} stands where {wanted} should", chunk.chunk);
            return Err(DatasetError::settings(out)(&what));
        }
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

/// Takes a step, if there is memory and the policy fits.
struct Try;

impl Visit for Try {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, E: World<T, O, 1>, const O: usize>(
        self,
        mut all: Environments<T, E, O, 1>,
        actor: Actor<O>,
    ) -> Self::Output {
        let mut rollout = Rollout::new(Plan::new(1, all.len()).truncated())?;
        Ok(all.rollout(actor, &mut rollout)?)
    }
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
pub(super) struct Course<'a, T: Number, E: World<T, O, 1>, const O: usize> {
    pub(super) dataset: &'a Dataset,
    pub(super) group: Group,
    pub(super) all: Environments<T, E, O, 1>,
    pub(super) actor: Actor<O>,
    format: DataFormat,
    /// Where they are wanted.
    episodes: Option<Episodes<T, O>>,
}

impl<'a, T: Number, E: World<T, O, 1>, const O: usize> Course<'a, T, E, O> {
    /// From the first step on.
    pub(super) fn new(
        dataset: &'a Dataset,
        format: DataFormat,
        group: Group,
        all: Environments<T, E, O, 1>,
        actor: Actor<O>,
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
            done.episodes = episodes.take(first, &done.rollout);
            if self.all.step() == steps {
                done.episodes.extend(episodes.cut(&done.next));
            }
        }
        Ok(done)
    }
}

impl Visit for Stream<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, E: World<T, O, 1>, const O: usize>(
        self,
        all: Environments<T, E, O, 1>,
        actor: Actor<O>,
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
        let (send, full) = sync_channel::<Done<T, O>>(1);
        let (give_back, free) = channel();
        thread::scope(|scope| {
            let writer = scope.spawn(move || {
                for mut done in full {
                    let bytes = commit(&mut done, dataset, format, threads, folder)?;
                    watch.done(done.rollout.plan().transitions() as u64, bytes);
                    // Whoever computes may have come to the end.
                    let _ = give_back.send(done);
                }
                Ok(())
            });
            let computed = compute(&mut course, from, used, &send, &free, watch);
            drop(send);
            let written = writer.join().unwrap_or(Err(DatasetError::Interrupted));
            // What went wrong first is what the other heard of.
            written.and(computed)
        })
    }
}

/// Computes chunk after chunk, in two pieces of memory.
fn compute<T: Number, E: World<T, O, 1>, const O: usize>(
    course: &mut Course<'_, T, E, O>,
    from: u64,
    mut used: Option<Done<T, O>>,
    send: &std::sync::mpsc::SyncSender<Done<T, O>>,
    free: &Receiver<Done<T, O>>,
    watch: &dyn Watch,
) -> Result<(), DatasetError> {
    for k in from..course.dataset.chunks() {
        if watch.stops() {
            return Err(DatasetError::Interrupted);
        }
        if used.is_none() && k >= from + 3 {
            // One is written, one waits, and one is free soon.
            used = free.recv().ok();
        }
        let done = course.next(used.take())?;
        if send.send(done).is_err() {
            break;
        }
        used = free.try_recv().ok();
    }
    Ok(())
}

/// Writes a chunk; gives how many bytes it has.
fn commit<T: Number, const O: usize>(
    done: &mut Done<T, O>,
    dataset: &Dataset,
    format: DataFormat,
    threads: usize,
    folder: &mut Folder,
) -> Result<u64, DatasetError> {
    let before = &folder.manifest().chunks;
    let (name, holds) = (done.name(), done.holds(dataset, format, before));
    let files = done.files(dataset, format, threads, before)?;
    let list = files.list();
    folder.commit(&name, holds, &list)?;
    Ok(list.iter().flat_map(|file| &file.pieces).map(|piece| piece.len() as u64).sum())
}
