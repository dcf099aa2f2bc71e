//! Tables of settings files.

use libration_settings::duration::{self, Duration};
use libration_settings::{Count, Number, StartTable, SystemTables};
use serde::Deserialize;

use super::system_tables::{EquationSource, EquationsTable, Numbers, Weights};

/// A settings file. Tables of other commands are ignored.
#[derive(Deserialize)]
#[serde(default)]
pub(super) struct File {
    pub(super) seed: Count,
    pub(super) dtype: String,
    pub(super) num_envs: Count,
    pub(super) steps: Count,
    pub(super) integrator: String,
    #[serde(deserialize_with = "duration::number_of_period")]
    pub(super) dt: Number,
    pub(super) substeps: Count,
    pub(super) max_episode_steps: Count,
    pub(super) chunk: ChunkTable,
    pub(super) system: SystemTables<EquationsTable>,
    pub(super) task: Option<TaskTable>,
    pub(super) start: Option<StartTable>,
    pub(super) delays: DelaysTable,
    pub(super) noise: NoiseTable,
    pub(super) policy: Option<PolicyTable>,
}

/// The size of chunks.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ChunkTable {
    pub(super) num_envs: Count,
    pub(super) steps: Count,
}

/// The task.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TaskTable {
    Regulate(RegulateTable),
    SwingUp(SwingUpTable),
    Track(TrackTable),
    Expressions(toml::Table),
}

#[derive(Clone, Copy, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RegulateTable {
    pub(super) position: Number,
    pub(super) velocity: Number,
    pub(super) effort: Number,
    pub(super) bound: Number,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SwingUpTable {
    pub(super) velocity: Number,
    pub(super) effort: Number,
}

/// The task to track a sine.
#[derive(Clone, Copy, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct TrackTable {
    pub(super) amplitude: Number,
    pub(super) angular_frequency: Number,
    pub(super) phase: Number,
    pub(super) position: Number,
    pub(super) velocity: Number,
    pub(super) effort: Number,
    pub(super) bound: Number,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct DelaysTable {
    pub(super) observation: LatencyRange,
    pub(super) action: LatencyRange,
}

/// A latency in s, or the two ends of an interval.
#[derive(Clone, Copy, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number of seconds or a text with a unit such as \"2ms\", or a list with the two ends of an interval"
)]
pub(super) enum LatencyRange {
    One(Duration),
    Ends([Duration; 2]),
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct NoiseTable {
    pub(super) jitter: Number,
    pub(super) skew: Number,
    pub(super) observation: Number,
}

/// The policy.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum PolicyTable {
    Linear(LinearTable),
    Random(RandomTable),
    Constant(ConstantTable),
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct LinearTable {
    pub(super) weights: Weights,
    pub(super) bias: Numbers,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RandomTable {
    pub(super) low: Numbers,
    pub(super) high: Numbers,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ConstantTable {
    pub(super) action: Numbers,
}

impl File {
    /// Puts equations in place of the system and of what belongs to systems of the catalogue.
    pub(super) fn replace_system(
        &mut self,
        source: EquationSource<'_>,
        parameters: &[(String, f64)],
    ) {
        let own = self.system.equations.take();
        let parameters =
            parameters.iter().map(|(name, value)| (name.clone(), Number(*value))).collect();
        let max_action = own.and_then(|own| own.max_action);
        let equations = EquationsTable { parameters, max_action, ..EquationsTable::of(source) };
        self.system = SystemTables { equations: Some(equations), ..SystemTables::default() };
        self.start = None;
        self.task = self.task.take().filter(|task| matches!(task, TaskTable::Expressions(_)));
    }
}

impl Default for File {
    fn default() -> Self {
        File {
            seed: Count(0),
            dtype: "f32".into(),
            num_envs: Count(4096),
            steps: Count(1024),
            integrator: "symplectic-euler".into(),
            dt: Number(0.01),
            substeps: Count(1),
            max_episode_steps: Count(0),
            chunk: ChunkTable::default(),
            system: SystemTables::of("oscillator", &[("omega2", 10.0)]),
            task: None,
            start: None,
            delays: DelaysTable::default(),
            noise: NoiseTable::default(),
            policy: None,
        }
    }
}

impl Default for TaskTable {
    fn default() -> Self {
        TaskTable::Regulate(RegulateTable::default())
    }
}

impl Default for PolicyTable {
    fn default() -> Self {
        PolicyTable::Linear(LinearTable::default())
    }
}

impl Default for ChunkTable {
    fn default() -> Self {
        ChunkTable { num_envs: Count(4096), steps: Count(1024) }
    }
}

impl Default for RegulateTable {
    fn default() -> Self {
        let [position, velocity, effort, bound] = [1.0, 0.1, 0.0, 10.0].map(Number);
        RegulateTable { position, velocity, effort, bound }
    }
}

impl Default for SwingUpTable {
    fn default() -> Self {
        SwingUpTable { velocity: Number(0.1), effort: Number(0.001) }
    }
}

impl Default for TrackTable {
    fn default() -> Self {
        let RegulateTable { position, velocity, effort, bound } = RegulateTable::default();
        let [amplitude, angular_frequency, phase] = [1.0, 1.0, 0.0].map(Number);
        TrackTable { amplitude, angular_frequency, phase, position, velocity, effort, bound }
    }
}

impl Default for DelaysTable {
    fn default() -> Self {
        let none = LatencyRange::One(Duration(0.0));
        DelaysTable { observation: none, action: none }
    }
}

impl Default for NoiseTable {
    fn default() -> Self {
        let [jitter, skew, observation] = [0.0; 3].map(Number);
        NoiseTable { jitter, skew, observation }
    }
}

impl Default for LinearTable {
    fn default() -> Self {
        LinearTable {
            weights: Weights::Flat([-2.0, 0.0].map(Number).to_vec()),
            bias: Numbers::one(0.0),
        }
    }
}

impl Default for RandomTable {
    fn default() -> Self {
        RandomTable { low: Numbers::one(-1.0), high: Numbers::one(1.0) }
    }
}

impl Default for ConstantTable {
    fn default() -> Self {
        ConstantTable { action: Numbers::one(0.0) }
    }
}
