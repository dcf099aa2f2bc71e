//! Numbers of the source about rollouts: chapter 6 and §9.5.

/// A rollout with numbers in the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SourceRollout {
    pub(super) environments: usize,
    pub(super) horizon: usize,
    pub(super) transitions: u64,
    /// Size in the MB of the source.
    pub(super) megabytes: f64,
}

/// A row of table 9.11.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) of: SourceRollout,
    pub(super) seconds: f64,
    /// Transitions a second, in millions.
    pub(super) millions: f64,
}

/// Table 9.11.
pub(super) const TABLE: [Row; 4] = [
    row(reported(256, 512, 131_072, 2.12), 0.0058, 22.46),
    row(reported(1024, 512, 524_288, 8.50), 0.0160, 32.68),
    row(reported(2048, 1024, 2_097_152, 34.00), 0.0330, 63.60),
    row(reported(4096, 1024, 4_194_304, 68.00), 0.0464, 90.44),
];

/// The two examples of §6.5.
pub(super) const EXAMPLES: [SourceRollout; 2] =
    [reported(4096, 1024, 4_194_304, 67.0), reported(16_384, 2048, 33_554_432, 544.0)];

/// Bytes of a transition, as §6.5 has them.
pub(super) const BYTES: f64 = 16.0;

/// The fields that §6.5 lists. Those that a rollout writes have the action, too, which §6.3 names.
pub(super) const LISTED: [&str; 3] = ["observation", "reward", "terminated"];

/// Time of 4096 × 1024 transitions in §6.7, in s, and what it makes of it, in 10⁶ a second.
pub(super) const EXAMPLE_SECONDS: f64 = 0.09;
pub(super) const EXAMPLE_MILLIONS: f64 = 44.0;

/// The peak of §9.5, in 10⁶ a second.
pub(super) const PEAK_MILLIONS: f64 = 70.0;

/// The bandwidth at which §9.4 has the memory saturated, in GB/s.
pub(super) const SATURATED: f64 = 24.0;

const fn reported(
    environments: usize,
    horizon: usize,
    transitions: u64,
    megabytes: f64,
) -> SourceRollout {
    SourceRollout { environments, horizon, transitions, megabytes }
}

const fn row(of: SourceRollout, seconds: f64, millions: f64) -> Row {
    Row { of, seconds, millions }
}

impl SourceRollout {
    /// As identifiers name it.
    pub(super) fn name(&self) -> String {
        format!("{}x{}", self.environments, self.horizon)
    }

    /// As the page does.
    pub(super) fn title(&self) -> String {
        format!("{} × {}", self.environments, self.horizon)
    }
}

impl Row {
    /// Time of a step of all environments, in s.
    pub(super) fn step(&self) -> f64 {
        self.seconds / self.of.horizon as f64
    }

    /// Time of a transition, in s.
    pub(super) fn each(&self) -> f64 {
        self.seconds / self.of.transitions as f64
    }
}
