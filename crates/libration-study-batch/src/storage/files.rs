//! Changes that preserve every byte of a data set and every bit of a checkpoint.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use libration::State;
use libration::checkpoint::Checkpoint;
use libration::ensemble::{All, Ensemble, Execution};
use libration::integrator::VelocityVerlet;
use libration::system::Pendulum;
use libration_data::{DataError, Durability, Manifest, load_state, save_state};
use libration_env::dataset;
use libration_env::dataset::{DataFormat, Dataset, DatasetError, Monitor, WriteJob};
use libration_report::record::{Finding, Record, Tolerance};
use libration_study::{Lab, StudyError};
use serde_json::Value;
use tempfile::TempDir;

use super::folder;
use crate::bit_comparison;
use crate::bit_comparison::add_row;
use crate::dataset_error::failed;

/// Environments in four groups, each of three chunks, with all that can be wrong.
const SETTINGS: &str = "\
seed = 5
num_envs = 200
steps = 130
max_episode_steps = 40
[chunk]
num_envs = 64
steps = 50
[task.regulate]
bound = 1.5
[start]
q = [-1.0, 1.0]
v = [-1.0, 1.0]
[delays]
observation = [0.0, 0.02]
action = [0.01, 0.04]
[noise]
jitter = 0.05
skew = 0.01
observation = 0.02
[policy.random]
low = -3.0
high = 3.0
";

/// Stops when so many transitions are done.
struct After {
    most: u64,
    done: AtomicU64,
}

impl Monitor for After {
    fn on_written(&self, transitions: u64, _: u64) {
        self.done.fetch_add(transitions, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.most
    }
}

/// Checksums of a data set, by file.
type Sums = BTreeMap<std::path::PathBuf, String>;

/// Writes the same in several ways, and compares.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let outer = folder(lab);
    let outer = TempDir::new_in(&outer).map_err(DataError::io("write", &outer)).map_err(failed)?;
    let sets = Sets { lab, folder: outer.path(), dataset: settings() };
    bit_comparison::begin(record);
    for format in DataFormat::ALL {
        let name = format.name();
        let whole = sets.written(format, "whole", 1, &[[1, 1]])?;
        let mut ways = vec![
            ("threads", "three threads", sets.written(format, "threads", 3, &[[1, 1]])?),
            ("resumed", "stopped twice, and gone on with", sets.stopped(format)?),
        ];
        if format != DataFormat::Minari {
            let shards: Vec<_> = (1..=3).map(|shard| [shard, 3]).collect();
            ways.push(("shards", "three shards", sets.written(format, "shards", 2, &shards)?));
        }
        for (id, how, sums) in ways {
            let differ = whole.iter().filter(|(path, sum)| sums.get(*path) != Some(sum)).count()
                + sums.keys().filter(|path| !whole.contains_key(*path)).count();
            add_row(
                record,
                &format!("data set, {name}: {how}"),
                whole.len(),
                Finding::predicted(
                    format!("storage.kept.{name}.{id}"),
                    format!("files of a data set ({name}) that are others with {how}"),
                    "1",
                    0.0,
                    differ as f64,
                    Tolerance::exact("all of it follows from the settings"),
                ),
            );
        }
    }
    checkpoint(lab, outer.path(), record)
}

fn settings() -> Dataset {
    // A test says that it can be read.
    dataset::parse(SETTINGS, "settings").unwrap_or_default()
}

struct Sets<'a> {
    lab: &'a Lab<'a>,
    folder: &'a Path,
    dataset: Dataset,
}

impl Sets<'_> {
    /// One run; gives the checksums of the files that are there then.
    fn run(
        &self,
        format: DataFormat,
        out: &str,
        threads: usize,
        shard: [usize; 2],
        watch: &After,
    ) -> Result<Sums, DatasetError> {
        let job = WriteJob {
            dataset: &self.dataset,
            format,
            shard,
            out: &self.folder.join(format!("{}-{out}", format.name())),
            resume: true,
            execution: self.lab.alone()?.threads(threads)?,
        };
        dataset::write(&job, watch).map(|manifest| sums(&manifest))
    }

    /// The checksums of shards together.
    fn written(
        &self,
        format: DataFormat,
        out: &str,
        threads: usize,
        shards: &[[usize; 2]],
    ) -> Result<Sums, StudyError> {
        let mut all = Sums::new();
        for &shard in shards {
            let never = After { most: u64::MAX, done: AtomicU64::new(0) };
            all.extend(
                self.run(format, &format!("{out}-{}", shard[0]), threads, shard, &never)
                    .map_err(failed)?,
            );
        }
        Ok(all)
    }

    /// The checksums of a data set whose writer was stopped after a third and after two thirds.
    fn stopped(&self, format: DataFormat) -> Result<Sums, StudyError> {
        let all = self.dataset.len() as u64;
        for third in 1..=2 {
            let after = After { most: all * third / 3, done: AtomicU64::new(0) };
            match self.run(format, "stopped-1", 2, [1, 1], &after) {
                Ok(_) | Err(DatasetError::Interrupted) => {}
                Err(error) => return Err(failed(error)),
            }
        }
        self.written(format, "stopped", 1, &[[1, 1]])
    }
}

fn sums(manifest: &Manifest) -> Sums {
    let files = manifest.chunks.iter().flat_map(|chunk| &chunk.files);
    files.map(|file| (file.path.clone(), file.blake3.clone())).collect()
}

/// Trajectories that are kept in a file half-way, and gone on with by others.
fn checkpoint(lab: &Lab<'_>, folder: &Path, record: &mut Record) -> Result<(), StudyError> {
    const COUNT: usize = 1000;
    const STEPS: u64 = 500;
    let make = |execution: Execution, far: f64| {
        Ensemble::<f64, 1>::from_fn(COUNT, execution, |i| State {
            q: [far * i as f64 / COUNT as f64],
            v: [0.0],
        })
    };
    let go = |ensemble: &mut Ensemble<f64, 1>| {
        ensemble.advance(VelocityVerlet, All(Pendulum { omega2: 10.0 }), All(0.01), STEPS)
    };
    let alone = lab.alone()?;
    let mut first = make(alone.clone(), 3.0)?;
    go(&mut first)?;
    let path = folder.join("state");
    save_state(&path, &first, &Value::Null, Durability::System).map_err(failed)?;
    go(&mut first)?;
    let mut second = make(alone.threads(3)?, 0.0)?;
    load_state(&path, &mut second).map_err(failed)?;
    go(&mut second)?;
    let [one, two] = [first.to_bytes(), second.to_bytes()];
    let differ =
        one.iter().zip(&two).filter(|(a, b)| a != b).count() + one.len().abs_diff(two.len());
    let text = "bytes that differ after a checkpoint half-way, taken up by three threads";
    let reason = "a lane is the lone trajectory";
    let finding = Finding::predicted(
        "storage.kept.checkpoint",
        text,
        "1",
        0.0,
        differ as f64,
        Tolerance::exact(reason),
    );
    add_row(record, "checkpoint: half-way, and on three threads", one.len(), finding);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_settings_are_read_and_divided() {
        let dataset = dataset::parse(SETTINGS, "settings").expect("they can be read");
        assert_eq!(dataset, settings());
        assert_eq!(dataset.len(), 26_000);
    }
}
