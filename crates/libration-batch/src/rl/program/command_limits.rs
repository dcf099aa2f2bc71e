//! Limits and levels of commands.

use libration_core::Float;

use super::block_state::Row;
use crate::rl::{EpisodeNumber, ProgramEnvironment};

/// What makes actions commands.
pub(super) struct CommandLimits<T> {
    /// The largest commands, where they are constants.
    saturation: Option<Vec<T>>,
    levels: Vec<T>,
}

impl<T: Float> CommandLimits<T> {
    pub(super) fn new(definition: &ProgramEnvironment) -> Self {
        let saturation = definition.saturation.iter().map(EpisodeNumber::as_constant);
        CommandLimits {
            saturation: saturation.map(|most| most.map(T::from_f64)).collect(),
            levels: definition.levels.iter().map(|&level| T::from_f64(level)).collect(),
        }
    }

    /// The commands of actions after saturation, on their levels; `drawn` are the largest commands unless they are constants. NaN of an
    /// action is NaN or the lowest level.
    pub(super) fn apply(&self, actions: &[Row<T>], drawn: &[Row<T>], commands: &mut [Row<T>]) {
        let within = |x: T, most: T| {
            let low = if x < -most { -most } else { x };
            if low > most { most } else { low }
        };
        for (i, (to, from)) in commands.iter_mut().zip(actions).enumerate() {
            match &self.saturation {
                Some(all) => to.iter_mut().zip(from).for_each(|(to, &x)| *to = within(x, all[i])),
                None => {
                    let pairs = from.iter().zip(&drawn[i]);
                    to.iter_mut().zip(pairs).for_each(|(to, (&x, &most))| *to = within(x, most));
                }
            }
            if let Some((&lowest, others)) = self.levels.split_first() {
                for x in to.iter_mut() {
                    let nearer = |best: T, &level: &T| {
                        if level - *x <= *x - best { level } else { best }
                    };
                    *x = others.iter().fold(lowest, nearer);
                }
            }
        }
    }
}
