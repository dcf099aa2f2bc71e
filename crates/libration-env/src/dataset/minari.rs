//! Episodes as the package Minari keeps them in its Parquet store: a folder for each, and one file about all.
//!
//! Farama Foundation, *Minari: a dataset API for offline reinforcement learning*, 0.5. A folder holds one record batch, of the
//! actions and one more row for what was seen last.

use std::borrow::Cow;
use std::path::PathBuf;

use libration_analyze::trajectory::FloatType;
use libration_data::{Chunk, Table, TableError, Values, run_on_threads, write_parquet};
use serde_json::{Value, json};

use super::DataFormat;
use super::chunk::{NamedFile, column};
use super::episodes::Episode;
use super::settings::Dataset;
use super::world::Number;
use crate::environments::Acting;

/// The version of the package whose store this is.
const VERSION: &str = "0.5.4";
/// Rows of an episode that pyarrow gives Minari at once; of longer ones it would see no more.
const BATCH: usize = 131_072;
/// Transitions of a group that are kept until their episodes end.
const KEPT: usize = 1 << 26;

impl Dataset {
    /// The most actions of an episode.
    pub(super) fn longest(&self) -> usize {
        (KEPT / self.chunk.environments).clamp(1, BATCH - 1)
    }
}

/// What the chunks before another one hold, from the first of the data set on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before {
    /// How many there are.
    pub(super) chunks: u64,
    /// Episodes.
    pub(super) episodes: u64,
    /// Actions in them.
    pub(super) actions: u64,
    /// Of all files.
    pub(super) bytes: u64,
}

impl Before {
    /// As a manifest tells.
    pub(super) fn of(chunks: &[Chunk]) -> Self {
        let told = |name: &str| {
            let held = chunks.last().and_then(|chunk| chunk.holds.get(name));
            held.and_then(|held| held.get(1)).and_then(Value::as_u64).unwrap_or(0)
        };
        Before {
            chunks: chunks.len() as u64,
            episodes: told("episodes"),
            actions: told("actions"),
            bytes: chunks.iter().flat_map(|chunk| &chunk.files).map(|file| file.bytes).sum(),
        }
    }

    /// And what a chunk of these episodes holds, in files of so many bytes.
    pub(super) fn and<T: Number, const O: usize>(
        self,
        episodes: &[Episode<T, O>],
        bytes: u64,
    ) -> Self {
        let actions: u64 = episodes.iter().map(|episode| episode.len() as u64).sum();
        Before {
            chunks: self.chunks + 1,
            episodes: self.episodes + episodes.len() as u64,
            actions: self.actions + actions,
            bytes: self.bytes + bytes,
        }
    }
}

/// The files of some episodes, the first of which has this number.
pub(super) fn files<T: Number, const O: usize>(
    episodes: &[Episode<T, O>],
    first: u64,
    threads: usize,
    dataset: &Dataset,
) -> Result<Vec<NamedFile<'static>>, TableError> {
    let each = run_on_threads(threads, episodes.len(), |i| {
        let (episode, id) = (&episodes[i], first + i as u64);
        let mut bytes = Vec::new();
        write_parquet(&rows(episode, dataset)?, &[], 1, &mut bytes)?;
        let about = json!({
            "id": id,
            "total_steps": episode.len(),
            "environment": episode.environment,
            "step": episode.first,
        });
        let path = |name: &str| PathBuf::from(format!("data/{id}/{name}"));
        let file = |name, bytes| (path(name), vec![Cow::Owned(bytes)]);
        Ok([file("part-0.parquet", bytes), file("metadata.json", about.to_string().into_bytes())])
    });
    let each: Vec<_> = each.into_iter().collect::<Result<_, TableError>>()?;
    Ok(each.into_iter().flatten().collect())
}

/// A row for each action, and one more.
fn rows<'a, T: Number, const O: usize>(
    episode: &'a Episode<T, O>,
    dataset: &Dataset,
) -> Result<Table<'a>, TableError> {
    let with_last = |numbers: &[T]| T::column([numbers, &[T::zero()]].concat());
    let end = |is: bool| {
        let mut flags = vec![0; episode.len() + 1];
        flags[episode.len() - 1] = u8::from(is);
        Values::Bool(flags.into())
    };
    let units: Vec<_> = dataset.recipe.seen().iter().map(|&(_, unit)| unit).collect();
    let list = |of| Values::Lists(1, Box::new(of));
    let mut seen =
        column("observations", "1", Values::Lists(O, Box::new(T::view(&episode.observation))));
    seen.unit = units.join(", ").into();
    Table::new(vec![
        seen,
        column("actions", dataset.recipe.units()[2], list(with_last(&episode.action))),
        column("rewards", "1", with_last(&episode.reward)),
        column("terminations", "1", end(episode.terminated)),
        column("truncations", "1", end(!episode.terminated)),
    ])
}

/// What Minari asks of a data set.
pub(super) fn about(dataset: &Dataset, all: Before) -> String {
    let (system, task) = (dataset.recipe.system.any().name(), dataset.recipe.task.name());
    let about = json!({
        "dataset_id": format!("libration/{system}-{task}-v0"),
        "minari_version": VERSION,
        "data_format": "parquet",
        "jpeg_encoding": false,
        "total_episodes": all.episodes,
        "total_steps": all.actions,
        // In MB, to a tenth.
        "dataset_size": (all.bytes as f64 / 1e5).round() / 10.0,
        "observation_space": space(dataset, &bounds(dataset)),
        "action_space": space(dataset, &[actions(&dataset.policy)]),
        "algorithm_name": dataset.policy.name(),
        "libration": dataset.settings(DataFormat::Minari),
    });
    about.to_string()
}

/// Between which numbers each that is seen lies: cosines and sines within one, unless a sensor adds noise.
fn bounds(dataset: &Dataset) -> Vec<[f64; 2]> {
    let exact = dataset.recipe.noise.observation.rms() == 0.0;
    let circle = |name: &str| exact && (name.starts_with("cos_") || name.starts_with("sin_"));
    let bound = |name| if circle(name) { 1.0 } else { f64::INFINITY };
    dataset.recipe.seen().iter().map(|&(name, _)| [-bound(name), bound(name)]).collect()
}

/// Between which numbers actions lie.
fn actions(policy: &Acting) -> [f64; 2] {
    match *policy {
        Acting::Random { low, high } => [low, high],
        Acting::Linear { .. } | Acting::Constant(_) => [-f64::INFINITY, f64::INFINITY],
    }
}

/// A box of Gymnasium as Minari writes it: JSON as Python has it, with infinite numbers.
fn space(dataset: &Dataset, bounds: &[[f64; 2]]) -> String {
    let number = |x: f64| match x {
        f64::INFINITY => "Infinity".to_owned(),
        f64::NEG_INFINITY => "-Infinity".to_owned(),
        x => json!(x).to_string(),
    };
    let kind = if dataset.float == FloatType::F64 { "float64" } else { "float32" };
    let side = |k: usize| bounds.iter().map(|b| number(b[k])).collect::<Vec<_>>().join(", ");
    format!(
        r#"{{"type": "Box", "dtype": "{kind}", "shape": [{}], "low": [{}], "high": [{}]}}"#,
        bounds.len(),
        side(0),
        side(1)
    )
}
