//! Episodes in the Parquet format of the package Minari: a folder per episode and one metadata file.
//!
//! Farama Foundation, *Minari: a dataset API for offline reinforcement learning*, 0.5. A folder holds one record batch, of the
//! actions and one more row for what was seen last.

use std::borrow::Cow;
use std::path::PathBuf;

use libration_analyze::trajectory::FloatType;
use libration_data::{Chunk, Table, TableError, Values, run_on_threads, write_parquet};
use serde_json::{Value, json};

use super::DataFormat;
use super::chunk_files::{NamedFile, column};
use super::episodes::Episode;
use super::group::Number;
use super::settings::Dataset;
use crate::environments::PolicySettings;

/// The version of the package with this format.
const VERSION: &str = "0.5.4";
/// Rows of an episode that pyarrow returns to Minari at once; Minari ignores further rows.
const BATCH: usize = 131_072;
/// Largest number of transitions of a group in open episodes.
const KEPT: usize = 1 << 26;

impl Dataset {
    /// The largest number of actions of an episode.
    pub(super) fn longest(&self) -> usize {
        (KEPT / self.chunk.environments).clamp(1, BATCH - 1)
    }
}

/// Totals over the chunks before another one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    /// Number of chunks.
    pub(super) chunks: u64,
    /// Number of episodes.
    pub(super) episodes: u64,
    /// Number of actions.
    pub(super) actions: u64,
    /// Bytes of all files.
    pub(super) bytes: u64,
}

impl Totals {
    /// The totals of the chunks of a manifest.
    pub(super) fn of_chunks(chunks: &[Chunk]) -> Self {
        let total = |name: &str| {
            let entry = chunks.last().and_then(|chunk| chunk.holds.get(name));
            entry.and_then(|entry| entry.get(1)).and_then(Value::as_u64).unwrap_or(0)
        };
        Totals {
            chunks: chunks.len() as u64,
            episodes: total("episodes"),
            actions: total("actions"),
            bytes: chunks.iter().flat_map(|chunk| &chunk.files).map(|file| file.bytes).sum(),
        }
    }

    /// The totals with one more chunk of these episodes and bytes.
    pub(super) fn and<T: Number>(self, episodes: &[Episode<T>], bytes: u64) -> Self {
        let actions: u64 = episodes.iter().map(|episode| episode.len() as u64).sum();
        Totals {
            chunks: self.chunks + 1,
            episodes: self.episodes + episodes.len() as u64,
            actions: self.actions + actions,
            bytes: self.bytes + bytes,
        }
    }
}

/// The files of some episodes; the first has the number `first`.
pub(super) fn files<T: Number>(
    episodes: &[Episode<T>],
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

/// A table with a row per action and a final row.
fn rows<'a, T: Number>(
    episode: &'a Episode<T>,
    dataset: &Dataset,
) -> Result<Table<'a>, TableError> {
    let with_last =
        |numbers: &[T], width: usize| T::column([numbers, &vec![T::zero(); width]].concat());
    let end = |is: bool| {
        let mut flags = vec![0; episode.len() + 1];
        flags[episode.len() - 1] = u8::from(is);
        Values::Bool(flags.into())
    };
    let (observed, actions) = (dataset.environment.observed(), dataset.environment.actions());
    let units = |all: &[(String, String)]| {
        all.iter().map(|(_, unit)| unit.as_str()).collect::<Vec<_>>().join(", ")
    };
    let lists = |width: usize, of| Values::Lists(width, Box::new(of));
    let seen = lists(observed.len(), T::view(&episode.observation));
    let acted = lists(actions.len(), with_last(&episode.action, actions.len()));
    Table::new(vec![
        column("observations", units(&observed), seen),
        column("actions", units(&actions), acted),
        column("rewards", "1", with_last(&episode.reward, 1)),
        column("terminations", "1", end(episode.terminated)),
        column("truncations", "1", end(!episode.terminated)),
    ])
}

/// The metadata file of a data set.
pub(super) fn metadata(dataset: &Dataset, all: Totals) -> String {
    let about = json!({
        "dataset_id": format!("libration/{}-v0", dataset.environment.name()),
        "minari_version": VERSION,
        "data_format": "parquet",
        "jpeg_encoding": false,
        "total_episodes": all.episodes,
        "total_steps": all.actions,
        // In MB, to a tenth.
        "dataset_size": (all.bytes as f64 / 1e5).round() / 10.0,
        "observation_space": space(dataset, &bounds(dataset)),
        "action_space": space(dataset, &actions(dataset)),
        "algorithm_name": dataset.policy.name(),
        "env_spec": environment_spec(dataset),
        "libration": dataset.settings(DataFormat::Minari),
    });
    about.to_string()
}

/// The environment in the JSON of Gymnasium's `EnvSpec`, from which Minari recovers it: `libration.datasets.environment_spec` in Python.
fn environment_spec(dataset: &Dataset) -> String {
    let settings = dataset.data();
    let limit = settings["max_episode_steps"].as_u64().filter(|&limit| limit > 0);
    let spec = json!({
        "id": "libration/Dataset-v0",
        "entry_point": "libration.envs:DatasetEnv",
        "max_episode_steps": limit,
        "kwargs": { "settings": settings },
        "additional_wrappers": [],
    });
    spec.to_string()
}

/// The bounds of the observations.
fn bounds(dataset: &Dataset) -> Vec<[f64; 2]> {
    dataset.environment.bounds().into_iter().map(|bound| [-bound, bound]).collect()
}

/// The bounds of the actions.
fn actions(dataset: &Dataset) -> Vec<[f64; 2]> {
    match &dataset.policy {
        PolicySettings::Random { low, high } => {
            low.iter().zip(high).map(|(&low, &high)| [low, high]).collect()
        }
        PolicySettings::Linear { .. } | PolicySettings::Constant(_) => {
            vec![[-f64::INFINITY, f64::INFINITY]; dataset.environment.actions().len()]
        }
    }
}

/// A box space of Gymnasium in the JSON of Minari, which allows infinite numbers.
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
