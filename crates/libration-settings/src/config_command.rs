//! Commands that share one schema of settings files.

/// A command with `--config`. One file has the tables of all of them; each reads its own and ignores the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigCommand {
    /// Name of the command.
    pub name: &'static str,
    /// Keys at the root of the file that the command reads.
    pub keys: &'static [&'static str],
}

impl ConfigCommand {
    /// `libration lab`: a table for each study that has settings.
    pub const LAB: ConfigCommand = ConfigCommand {
        name: "lab",
        keys: &[
            "studies",
            "effort",
            "simd",
            "integrators",
            "system",
            "start",
            "spectrum",
            "error",
            "drift",
            "nonlinear",
            "precision",
            "convergence",
            "efficiency",
            "adaptive",
            "stability",
            "jitter",
            "throughput",
            "rollout",
            "storage",
        ],
    };
    /// `libration advise` on a system of the catalogue.
    pub const ADVISE: ConfigCommand = ConfigCommand {
        name: "advise",
        keys: &["tolerance", "request", "system", "start", "controller", "loop"],
    };
    /// `libration rollout`.
    pub const ROLLOUT: ConfigCommand = ConfigCommand {
        name: "rollout",
        keys: &[
            "seed",
            "dtype",
            "num_envs",
            "steps",
            "integrator",
            "dt",
            "substeps",
            "max_episode_steps",
            "chunk",
            "system",
            "task",
            "start",
            "delays",
            "noise",
            "policy",
        ],
    };
    const ALL: [ConfigCommand; 3] = [Self::LAB, Self::ADVISE, Self::ROLLOUT];

    /// The keys at the root of a file that this command ignores and another reads, each with the name of that command.
    pub fn ignored_keys(self, text: &str) -> Vec<(String, &'static str)> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let table: toml::Table = text.parse().unwrap_or_default();
        let own = |key: &String| self.keys.contains(&key.as_str());
        let ignored = table.into_iter().map(|(key, _)| key).filter(|key| !own(key));
        ignored.filter_map(|key| Self::reader_of(&key).map(|reader| (key, reader.name))).collect()
    }

    /// The first command that reads a key, if any.
    pub fn reader_of(key: &str) -> Option<ConfigCommand> {
        Self::ALL.into_iter().find(|command| command.keys.contains(&key))
    }

    /// The keys of all commands; those that several read occur as often.
    pub fn all_keys() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().flat_map(|command| command.keys.iter().copied())
    }
}
