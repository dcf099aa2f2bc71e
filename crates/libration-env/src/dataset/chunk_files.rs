//! Files of chunks.

use std::borrow::Cow;
use std::path::PathBuf;

use libration::rl::{EpisodeEnd, EpisodeEnds, Layout};
use libration_data::{
    Column, NewFile, Table, TableError, Values, npy_array, write_npy, write_parquet,
};
use serde_json::{Map, Value, json};

use super::episodes::Episode;
use super::format::DataFormat;
use super::group::{Group, Number};
use super::minari;
use super::minari::Totals;
use super::settings::Dataset;
use crate::environments::AnyRollout;

/// The rollout of a chunk: some steps of a group.
pub(super) struct ChunkRollout<T> {
    pub(super) group: Group,
    /// The number of the chunk in the group, and its first step.
    pub(super) chunk: u64,
    pub(super) first: u64,
    pub(super) rollout: Box<dyn AnyRollout<T>>,
    pub(super) ends: EpisodeEnds<T>,
    /// The episodes that ended, for formats that store episodes.
    pub(super) episodes: Vec<Episode<T>>,
    /// The observations after the last step, `[n, i]`.
    pub(super) next: Vec<T>,
    /// The index columns of a table, reused by the next chunk.
    pub(super) rows: Rows,
}

/// The step and environment of each row of a table.
#[derive(Default)]
pub(super) struct Rows {
    steps: Vec<u64>,
    environments: Vec<u32>,
}

impl Rows {
    /// Fills in the rows of `steps` steps of a group.
    fn fill(&mut self, first: u64, steps: usize, group: Group) {
        let Group { first: from, len, .. } = group;
        if self.environments.len() != steps * len {
            let environments = from as u32..(from + len) as u32;
            self.environments = core::iter::repeat_n(environments, steps).flatten().collect();
            self.steps = vec![0; steps * len];
        }
        for (step, row) in (first..).zip(self.steps.chunks_mut(len.max(1))) {
            row.fill(step);
        }
    }
}

/// The path of a file relative to the folder, and the pieces of its bytes.
pub(super) type NamedFile<'a> = (PathBuf, Vec<Cow<'a, [u8]>>);

/// The files of a chunk, which borrow bytes of its rollout.
pub(super) struct Files<'a> {
    files: Vec<NamedFile<'a>>,
    /// The totals before the next chunk.
    pub(super) after: Totals,
}

impl Files<'_> {
    /// The files in the form that a folder stores.
    pub(super) fn list(&self) -> Vec<NewFile<'_>> {
        self.files
            .iter()
            .map(|(path, pieces)| NewFile {
                path: path.clone(),
                pieces: pieces.iter().map(|piece| &**piece).collect(),
            })
            .collect()
    }
}

/// The size of all files, in bytes.
fn bytes(files: &[NamedFile<'_>]) -> u64 {
    files.iter().flat_map(|(_, pieces)| pieces).map(|piece| piece.len() as u64).sum()
}

impl<T: Number> ChunkRollout<T> {
    /// The name of the chunk; names sort in the order of creation.
    pub(super) fn name(&self) -> String {
        format!("{:06}-{:08}", self.group.number, self.chunk)
    }

    /// The size of the rollout in memory, in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let [observations, actions] = self.rollout.sizes();
        let bytes = self.rollout.plan().bytes(observations, actions, size_of::<T>());
        u64::try_from(bytes).unwrap_or(u64::MAX)
    }

    /// The entry of the chunk in the manifest.
    pub(super) fn manifest_entry(
        &self,
        dataset: &Dataset,
        format: DataFormat,
        before: Totals,
    ) -> Map<String, Value> {
        let plan = self.rollout.plan();
        let mut value = json!({
            "seed": dataset.seed,
            "environments": [self.group.first, self.group.first + self.group.len],
            "steps": [self.first, self.first + plan.horizon as u64],
            "transitions": plan.horizon * plan.environments,
            "ends": self.ends.ends.len(),
        });
        if format == DataFormat::Minari {
            let with = before.and(&self.episodes, 0);
            value["episodes"] = json!([before.episodes, with.episodes]);
            value["actions"] = json!([before.actions, with.actions]);
        }
        match value {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }

    /// The files of the chunk in a format, encoded by `threads` threads.
    ///
    /// # Errors
    /// If the Parquet library fails.
    pub(super) fn files(
        &mut self,
        dataset: &Dataset,
        format: DataFormat,
        threads: usize,
        before: Totals,
    ) -> Result<Files<'_>, TableError> {
        if format == DataFormat::Minari {
            return self.minari(dataset, threads, before);
        }
        let name = self.name();
        let path = |folder: &str| PathBuf::from(format!("{folder}/{name}.{}", format.name()));
        if format == DataFormat::Parquet {
            self.rows.fill(self.first, self.rollout.plan().horizon, self.group);
        }
        let mut files = Vec::new();
        let ends = self.ends(dataset)?;
        match format {
            DataFormat::Minari => {}
            DataFormat::Npy => {
                for (folder, kind, wide, bytes) in self.arrays() {
                    let plan = self.rollout.plan();
                    let shape = [plan.horizon, plan.environments, wide];
                    let shape = &shape[..if wide == 0 { 2 } else { 3 }];
                    let header = Cow::Owned(npy_array(kind, shape));
                    files.push((path(folder), vec![header, Cow::Borrowed(bytes)]));
                }
                let mut bytes = Vec::new();
                write_npy(&ends, &mut bytes)?;
                files.push((path("ends"), vec![Cow::Owned(bytes)]));
            }
            DataFormat::Parquet => {
                for (folder, table) in [("transitions", self.transitions(dataset)?), ("ends", ends)]
                {
                    // Compressed data are rarely longer.
                    let mut bytes = Vec::with_capacity(table.bytes());
                    write_parquet(&table, &[("libration.chunk", &name)], threads, &mut bytes)?;
                    files.push((path(folder), vec![Cow::Owned(bytes)]));
                }
            }
        }
        let after = before.and::<T>(&[], bytes(&files));
        Ok(Files { files, after })
    }

    /// The files of its episodes, and with the last chunk those of the whole data set.
    fn minari(
        &self,
        dataset: &Dataset,
        threads: usize,
        before: Totals,
    ) -> Result<Files<'static>, TableError> {
        let mut files = minari::files(&self.episodes, before.episodes, threads, dataset)?;
        let after = before.and(&self.episodes, bytes(&files));
        if u128::from(after.chunks) == dataset.groups() as u128 * u128::from(dataset.chunks()) {
            let about = minari::metadata(dataset, after);
            files.push((PathBuf::from("data/metadata.json"), vec![Cow::Owned(about.into())]));
        }
        Ok(Files { files, after })
    }

    /// Name, type, numbers per transition (0 for a scalar) and bytes of each tensor.
    fn arrays(&self) -> [(&'static str, &'static str, usize, &[u8]); 5] {
        let rollout = &self.rollout;
        let [observations, actions] = rollout.sizes();
        let bytes = |numbers| bytemuck::cast_slice::<T, u8>(numbers);
        [
            ("observation", T::NUMPY, observations, bytes(rollout.observation())),
            ("action", T::NUMPY, actions, bytes(rollout.action())),
            ("reward", T::NUMPY, 0, bytes(rollout.reward())),
            ("terminated", "|b1", 0, rollout.terminated()),
            ("truncated", "|b1", 0, rollout.truncated()),
        ]
    }

    /// A table with a row per transition, step by step.
    fn transitions(&self, dataset: &Dataset) -> Result<Table<'_>, TableError> {
        let rollout = &self.rollout;
        let all = rollout.plan().horizon * self.group.len;
        let Rows { steps: step, environments } = &self.rows;
        let mut columns = vec![
            column("step", "1", Values::U64(step.into())),
            column("environment", "1", Values::U32(environments.into())),
        ];
        // One plane after the other, as Parquet is written.
        debug_assert_eq!(rollout.plan().layout, Layout::Planes);
        let named = [
            (dataset.environment.observed(), rollout.observation()),
            (dataset.environment.actions(), rollout.action()),
        ];
        for (names, numbers) in named {
            for (i, (name, unit)) in names.into_iter().enumerate() {
                columns.push(column(name, unit, T::view(&numbers[i * all..][..all])));
            }
        }
        columns.extend([
            column("reward", "1", T::view(rollout.reward())),
            column("terminated", "1", Values::Bool(rollout.terminated().into())),
            column("truncated", "1", Values::Bool(rollout.truncated().into())),
        ]);
        Table::new(columns)
    }

    /// The final observations of ended episodes, followed by the current observations of open ones.
    fn ends(&self, dataset: &Dataset) -> Result<Table<'static>, TableError> {
        let (rollout, n) = (&self.rollout, self.group.len);
        let last = (rollout.plan().horizon - 1) * n;
        let flag = |flags: &[u8], at: usize| flags.get(at).copied().unwrap_or(0);
        let goes_on = |i: &usize| {
            flag(rollout.terminated(), last + i) | flag(rollout.truncated(), last + i) == 0
        };
        let open: Vec<usize> = (0..n).filter(goes_on).collect();
        let finals = &self.ends.ends;
        let at = |end: &EpisodeEnd<T, 0>| end.step * n + end.environment;
        let both = |a: Vec<u8>, b: u8| {
            Values::Bool(
                a.into_iter().chain(core::iter::repeat_n(b, open.len())).collect::<Vec<_>>().into(),
            )
        };
        let after = self.first + rollout.plan().horizon as u64;
        let steps = finals.iter().map(|end| self.first + end.step as u64 + 1);
        let steps = steps.chain(open.iter().map(|_| after)).collect::<Vec<_>>();
        let who = finals.iter().map(|end| end.environment).chain(open.iter().copied());
        let who = who.map(|i| (self.group.first + i) as u32).collect::<Vec<_>>();
        let mut columns = vec![
            column("step", "1", Values::U64(steps.into())),
            column("environment", "1", Values::U32(who.into())),
        ];
        let width = rollout.sizes()[0];
        for (k, (name, unit)) in dataset.environment.observed().into_iter().enumerate() {
            let seen = self.ends.observations.iter().skip(k).step_by(width).copied();
            let seen = seen.chain(open.iter().map(|&i| self.next[i * width + k])).collect();
            columns.push(column(name, unit, T::column(seen)));
        }
        let paid = finals.iter().map(|end| end.episode_return);
        let paid = paid.chain(open.iter().map(|_| f64::NAN)).collect::<Vec<_>>();
        let lengths = finals.iter().map(|end| end.length).chain(open.iter().map(|_| 0));
        columns.extend([
            column("return", "1", Values::F64(paid.into())),
            column("length", "1", Values::U64(lengths.collect::<Vec<_>>().into())),
            column(
                "terminated",
                "1",
                both(finals.iter().map(|end| flag(rollout.terminated(), at(end))).collect(), 0),
            ),
            column(
                "truncated",
                "1",
                both(finals.iter().map(|end| flag(rollout.truncated(), at(end))).collect(), 0),
            ),
            column("lost", "1", both(finals.iter().map(|end| end.lost.into()).collect(), 0)),
        ]);
        Table::new(columns)
    }
}

/// A column of a table.
pub(super) fn column<'a>(
    name: impl Into<Cow<'static, str>>,
    unit: impl Into<Cow<'static, str>>,
    values: Values<'a>,
) -> Column<'a> {
    Column { name: name.into(), unit: unit.into(), values }
}
