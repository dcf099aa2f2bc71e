//! Growth, stationary cost and matrix of a loop.

use crate::{LinearLoop, LinearLoopError, LoopTiming, Matrix, RandomStages, Stage, Stationary};

impl LinearLoop {
    /// The matrix of a period of mean length without losses; of a schedule of controllers that of all its periods, one after the
    /// other.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn period_matrix(&self, timing: &LoopTiming) -> Result<Matrix, LinearLoopError> {
        Ok(product(&self.period_matrices(timing)?))
    }

    /// The matrix of each period of the schedule, of mean length without losses.
    pub(crate) fn period_matrices(
        &self,
        timing: &LoopTiming,
    ) -> Result<Vec<Matrix>, LinearLoopError> {
        let even = LoopTiming { jitter: timing.jitter.with_rms(0.0), loss: 0.0, ..timing.clone() };
        let kinds = self.stages(&even, false)?;
        Ok(self.controllers().order().iter().map(|&kind| kinds[kind][0].step.clone()).collect())
    }

    fn random_stages(&self, kinds: &[Vec<Stage>]) -> RandomStages {
        RandomStages::of_schedule(kinds, self.controllers().order())
    }

    /// The logarithm of the factor by which second moments grow in a period; below zero the loop is stable in the mean square. Of a
    /// schedule of controllers it is the mean over its periods.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing, or a loop that is too large.
    pub fn growth(&self, timing: &LoopTiming) -> Result<f64, LinearLoopError> {
        Ok(self.random_stages(&self.stages(timing, false)?).growth())
    }

    /// Whether second moments decay.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`].
    pub fn is_stable(&self, timing: &LoopTiming) -> Result<bool, LinearLoopError> {
        Ok(self.random_stages(&self.stages(timing, false)?).is_stable())
    }

    /// The stationary cost and moments; none if second moments grow.
    ///
    /// Second moments `P` of the loop solve `P = E[M P Mᵀ] + W` with the matrix `M` of a period and what noise adds in it, `W`. Noise
    /// and cost are integrals over continuous time (B. Lincoln, A. Cervin, *Jitterbug: a tool for analysis of real-time control
    /// performance*, IEEE Conference on Decision and Control 2002); of a sampled plant they are sums over its samples. Under a
    /// schedule of controllers `P` repeats with it; cost and variances are means over its periods.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`].
    pub fn stationary(&self, timing: &LoopTiming) -> Result<Option<Stationary>, LinearLoopError> {
        let variance = |moments: &Matrix, i: usize| moments[(i, i)];
        Ok(self.stationary_of(&self.stages(timing, true)?, self.controllers().order(), variance))
    }

    /// The stationary cost of kinds of periods in this order, with deviations from the variance of each state of the plant.
    pub(crate) fn stationary_of(
        &self,
        kinds: &[Vec<Stage>],
        order: &[usize],
        variance: impl Fn(&Matrix, usize) -> f64,
    ) -> Option<Stationary> {
        let random = RandomStages::of_schedule(kinds, order);
        if !random.is_stable() {
            return None;
        }
        let noises: Vec<Matrix> = kinds.iter().map(|stages| Stage::mean_noise(stages)).collect();
        let moments = random.moments_by_period(&noises);
        let (mut cost, mut length) = (0.0, 0.0);
        for (&kind, moments) in order.iter().zip(&moments) {
            for stage in &kinds[kind] {
                cost += stage.weight * stage.expected(moments);
                length += stage.weight * stage.length;
            }
        }
        let cost = cost / length;
        let sum = |i: usize| moments.iter().map(|moments| variance(moments, i)).sum::<f64>();
        let deviation = |i: usize| (sum(i) / moments.len() as f64).max(0.0).sqrt();
        let deviations = (0..self.plant().states.len()).map(deviation).collect();
        // Beyond the edge of stability, by less than the growth can show, a form turns negative.
        (cost >= 0.0).then_some(Stationary { cost, deviations })
    }
}

/// One step after the other.
pub(crate) fn product(steps: &[Matrix]) -> Matrix {
    let mut steps = steps.iter();
    let first = steps.next().map_or_else(|| Matrix::zeros(0, 0), Matrix::clone);
    steps.fold(first, |all, step| step * &all)
}
