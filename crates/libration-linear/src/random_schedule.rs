//! Second moments that pass through a schedule of random periods.

use crate::random_period::RandomPeriod;
use crate::{Matrix, solve_stein};

/// Periods of several kinds, which follow each other over and over. The step of each is drawn for itself.
pub(crate) struct RandomSchedule {
    pub(crate) kinds: Vec<RandomPeriod>,
    /// The kind of each period of the schedule.
    pub(crate) order: Vec<usize>,
}

impl RandomSchedule {
    pub(crate) fn periods(&self) -> impl Iterator<Item = &RandomPeriod> {
        self.order.iter().map(|&kind| &self.kinds[kind])
    }

    /// The means of all kinds, times `factor`.
    pub(crate) fn means(&self, factor: f64) -> Vec<Matrix> {
        self.kinds.iter().map(|period| period.mean.scaled(factor)).collect()
    }

    /// The product of the means of all periods of the schedule, divided by a factor whose logarithm comes with it.
    pub(crate) fn product(&self, means: &[Matrix]) -> (Matrix, f64) {
        let mut all = means[self.order[0]].clone();
        let mut logarithm = 0.0;
        for &kind in &self.order[1..] {
            all = &means[kind] * &all;
            let norm = all.largest();
            if norm > 0.0 {
                all.normalise(norm);
                logarithm += norm.ln();
            }
        }
        (all, logarithm)
    }

    /// The product of the means of all periods of the schedule.
    pub(crate) fn round(&self, means: &[Matrix]) -> Matrix {
        match self.product(means) {
            (all, 0.0) => all,
            (all, logarithm) => all.scaled(logarithm.exp()),
        }
    }

    /// The numbers of `S`.
    pub(crate) fn numbers(&self) -> usize {
        self.periods().map(|period| period.pairs().count()).sum()
    }

    /// The second moments at the beginning of each period, of what comes in during each, for each of several such inflows. They
    /// repeat with the schedule.
    pub(crate) fn carried(
        &self,
        means: &[Matrix],
        inflows: &[Vec<Option<Matrix>>],
    ) -> Vec<Vec<Matrix>> {
        let next = |kind: usize, moments: Option<&Matrix>, inflow: &Option<Matrix>| {
            let moved = moments.map(|moments| means[kind].congruence(moments));
            match (moved, inflow) {
                (Some(mut moved), Some(inflow)) => {
                    moved.add_scaled(1.0, inflow);
                    Some(moved)
                }
                (moved, inflow) => moved.or_else(|| inflow.clone()),
            }
        };
        let steps = |inflow: &[Option<Matrix>], first: Option<Matrix>| -> Vec<Option<Matrix>> {
            let mut all = vec![first];
            for (&kind, inflow) in self.order.iter().zip(inflow) {
                all.push(next(kind, all.last().and_then(Option::as_ref), inflow));
            }
            all
        };
        let n = self.kinds[0].mean.rows();
        let once = inflows.iter().map(|inflow| {
            steps(inflow, None).pop().flatten().unwrap_or_else(|| Matrix::zeros(n, n))
        });
        let firsts = solve_stein(&self.round(means), once.collect());
        let moments = |(inflow, first): (&Vec<Option<Matrix>>, Matrix)| {
            let mut all = steps(&inflow[..inflow.len() - 1], Some(first));
            all.drain(..).flatten().collect()
        };
        inflows.iter().zip(firsts).map(moments).collect()
    }

    /// What the covariances `S` of what is drawn in each period come back as.
    pub(crate) fn returned_spread(&self, means: &[Matrix], spreads: &[Matrix]) -> Vec<Matrix> {
        let inflow = self.periods().zip(spreads).map(|(period, s)| Some(period.placed(s)));
        let moments = self.carried(means, &[inflow.collect()]).remove(0);
        self.periods().zip(&moments).map(|(period, moments)| period.spread(moments)).collect()
    }

    /// The second moments of a unit of each number of `S`.
    pub(crate) fn added(&self, means: &[Matrix]) -> Vec<Vec<Matrix>> {
        let units = self.periods().enumerate().flat_map(|(k, period)| {
            period.pairs().map(move |pair| {
                let mut inflow = vec![None; self.order.len()];
                inflow[k] = Some(period.unit(pair));
                inflow
            })
        });
        self.carried(means, &units.collect::<Vec<_>>())
    }

    /// The map of the numbers of `S`, row by row.
    pub(crate) fn feedback(&self, means: &[Matrix]) -> Matrix {
        let columns: Vec<Vec<f64>> = self.added(means).iter().map(|p| self.seen(p)).collect();
        Matrix::from_fn(columns.len(), columns.len(), |i, j| columns[j][i])
    }

    /// `E[Δ P Δᵀ]` of each period, pair by pair.
    pub(crate) fn seen(&self, moments: &[Matrix]) -> Vec<f64> {
        self.periods().zip(moments).flat_map(|(period, moments)| period.seen(moments)).collect()
    }
}
