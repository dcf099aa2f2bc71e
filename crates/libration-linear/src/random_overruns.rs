//! Loops whose jobs overrun at random.

use crate::loop_timing::MOST_RANDOM;
use crate::{
    LinearLoop, LinearLoopError, LoopTiming, Matrix, OverrunStrategy, PeriodOutcome, RandomStages,
    Stage, Stationary,
};

/// Overruns at random: the job that has the processor at the end of a period or begins in it overruns its end with a probability,
/// independently of all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomOverruns {
    /// What happens to a job that overruns.
    pub strategy: OverrunStrategy,
    /// The probability, at least 0 and below 1.
    pub probability: f64,
}

/// An event of a period: its probability, and its outcome without and with a job that is unfinished at its beginning.
type Event = (f64, [PeriodOutcome; 2]);

impl RandomOverruns {
    fn events(self) -> Vec<Event> {
        use PeriodOutcome::{Late, Met, Missed};
        let p = self.probability;
        match self.strategy {
            OverrunStrategy::Kill | OverrunStrategy::Skip => {
                vec![(1.0 - p, [Met, Met]), (p, [Missed, Missed])]
            }
            // Behind the unfinished job the one that waits may overrun as well.
            OverrunStrategy::Queue => vec![
                ((1.0 - p) * (1.0 - p), [Met, Met]),
                ((1.0 - p) * p, [Met, Late]),
                (p, [Missed, Missed]),
            ],
        }
    }

    /// The stationary probability that a job is unfinished at the beginning of a period.
    fn running(self) -> f64 {
        let p = self.probability;
        match self.strategy {
            OverrunStrategy::Kill => 0.0,
            OverrunStrategy::Skip => p,
            OverrunStrategy::Queue => p / (p + (1.0 - p) * (1.0 - p)),
        }
    }
}

impl LinearLoop {
    /// The logarithm of the factor by which second moments grow in a period, with the jitter of `timing` and random overruns.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing, losses besides overruns, or a loop that is too large.
    pub fn overrun_growth(
        &self,
        timing: &LoopTiming,
        overruns: RandomOverruns,
    ) -> Result<f64, LinearLoopError> {
        Ok(RandomStages::new(&self.overrun_stages(timing, overruns, false)?).growth())
    }

    /// Whether second moments decay with random overruns.
    ///
    /// # Errors
    /// As for [`LinearLoop::overrun_growth`].
    pub fn decays_with_overruns(
        &self,
        timing: &LoopTiming,
        overruns: RandomOverruns,
    ) -> Result<bool, LinearLoopError> {
        Ok(RandomStages::new(&self.overrun_stages(timing, overruns, false)?).is_stable())
    }

    /// The stationary cost and moments with random overruns; none if second moments grow.
    ///
    /// # Errors
    /// As for [`LinearLoop::overrun_growth`].
    pub fn overrun_stationary(
        &self,
        timing: &LoopTiming,
        overruns: RandomOverruns,
    ) -> Result<Option<Stationary>, LinearLoopError> {
        let stages = self.overrun_stages(timing, overruns, true)?;
        let n = stages.first().map_or(0, |stage| stage.step.rows());
        let halves = if overruns.strategy.goes_on() { vec![0, n / 2] } else { vec![0] };
        let variance = |moments: &Matrix, i: usize| {
            halves.iter().map(|half| moments[(half + i, half + i)]).sum()
        };
        Ok(self.stationary_of(&[stages], &[0], variance))
    }

    /// The periods that the loop may have.
    ///
    /// Where jobs go on, a loop with an unfinished job and one without have coordinates of their own, of which one half is zero: the
    /// Markov jump system of both becomes independent draws (O. Costa, M. Fragoso, R. Marques, *Discrete-time Markov jump linear
    /// systems*, Springer 2005, has its second moments).
    fn overrun_stages(
        &self,
        timing: &LoopTiming,
        overruns: RandomOverruns,
        with_cost: bool,
    ) -> Result<Vec<Stage>, LinearLoopError> {
        let RandomOverruns { strategy, probability } = overruns;
        if !(0.0..1.0).contains(&probability) {
            return Err(LinearLoopError::Overruns(probability));
        }
        if timing.loss > 0.0 {
            return Err(LinearLoopError::LossAndOverruns);
        }
        let mut all = Vec::new();
        for (weight, outcomes) in overruns.events() {
            if weight == 0.0 {
                continue;
            }
            let mut parts = Vec::new();
            for (running, outcome) in [false, true].into_iter().zip(outcomes) {
                let activity = strategy.activity(running, outcome);
                let own = self.only_controller("missed deadlines")?;
                let controller = own.overrunning(strategy, timing.missing, activity);
                let stages = self.with_controller(controller)?.stages(timing, with_cost)?.remove(0);
                parts.push((activity.overruns(), stages));
            }
            let [(idle_next, idle), (running_next, running)] = &parts[..] else { continue };
            for (idle, running) in idle.iter().zip(running) {
                let weight = weight * idle.weight;
                all.push(match strategy.goes_on() {
                    false => Stage { weight, ..idle.clone() },
                    true => coupled(
                        weight,
                        overruns.running(),
                        [(*idle_next, idle), (*running_next, running)],
                    ),
                });
            }
        }
        let size = all.first().map_or(0, |stage| stage.step.rows());
        match size > MOST_RANDOM {
            true => Err(LinearLoopError::Size { size, most: MOST_RANDOM }),
            false => Ok(all),
        }
    }
}

/// A period on the coordinates of a loop without and with an unfinished job, of which the latter has the probability `running`. Each
/// part has whether a job is unfinished behind it.
fn coupled(weight: f64, running: f64, parts: [(bool, &Stage); 2]) -> Stage {
    let n = parts[0].1.step.rows();
    let zeros = || Matrix::zeros(2 * n, 2 * n);
    let mut all = Stage {
        weight,
        step: zeros(),
        noise: zeros(),
        cost: zeros(),
        constant: 0.0,
        length: parts[0].1.length,
    };
    for (from, (next, part)) in parts.into_iter().enumerate() {
        let probability = if from == 1 { running } else { 1.0 - running };
        let to = usize::from(next);
        all.step.set_block((to * n, from * n), &part.step);
        let before = all.noise.block((to * n, to * n), (n, n));
        all.noise.set_block((to * n, to * n), &before.plus(&part.noise.scaled(probability)));
        all.cost.set_block((from * n, from * n), &part.cost);
        all.constant += probability * part.constant;
    }
    all
}

#[cfg(test)]
mod tests;
