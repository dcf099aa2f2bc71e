//! Limits and levels of commands.

use libration_core::Float;

use super::block_state::Row;
use crate::ensemble::{InstructionSet, Loop};
use crate::rl::block_size::LANES;
use crate::rl::{EpisodeNumber, ProgramEnvironment};

/// What makes actions commands.
#[derive(Debug)]
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
    pub(super) fn apply(
        &self,
        actions: &[Row<T>],
        drawn: &[Row<T>],
        commands: &mut [Row<T>],
        instructions: InstructionSet,
    ) {
        for (i, (command, action)) in commands.iter_mut().zip(actions).enumerate() {
            let most = match &self.saturation {
                Some(all) => Most::Same(all[i]),
                None => Most::Each(&drawn[i]),
            };
            instructions.vectorize(Limiting { command, action, most, levels: &self.levels });
        }
    }
}

/// The largest commands of a row.
enum Most<'a, T> {
    Same(T),
    Each(&'a Row<T>),
}

/// The commands of a row of actions.
struct Limiting<'a, T> {
    command: &'a mut Row<T>,
    action: &'a Row<T>,
    most: Most<'a, T>,
    levels: &'a [T],
}

impl<T: Float> Loop for Limiting<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Limiting { command, action, most, levels } = self;
        let within = |x: T, most: T| {
            let low = if x < -most { -most } else { x };
            if low > most { most } else { low }
        };
        match most {
            Most::Same(most) => {
                command.iter_mut().zip(action).for_each(|(to, &x)| *to = within(x, most));
            }
            Most::Each(most) => {
                let pairs = action.iter().zip(most);
                command.iter_mut().zip(pairs).for_each(|(to, (&x, &most))| *to = within(x, most));
            }
        }
        let Some((&lowest, others)) = levels.split_first() else { return };
        let mut nearest = [lowest; LANES];
        for &level in others {
            for (best, &x) in nearest.iter_mut().zip(&*command) {
                *best = if level - x <= x - *best { level } else { *best };
            }
        }
        *command = nearest;
    }
}
