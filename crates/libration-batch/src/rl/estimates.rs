//! Advantages and returns of a rollout.

use bytemuck::Pod;
use libration_core::Float;
use libration_core::control::error::ensure_probability;
use ndarray::ArrayViewMut2;

use super::rollout_slice::{first_columns, row, rows_of};
use super::{EnvironmentError, Plan, Rollout};
use crate::ensemble::{Buffer, EnsembleError, Execution, Loop, Pages};

/// Generalised advantage estimation: J. Schulman, P. Moritz, S. Levine, M. Jordan, P. Abbeel, *High-dimensional continuous
/// control using generalized advantage estimation*, ICLR 2016, equation 16.
///
/// `A = δ + γλ·A'` with `δ = r + γ·V' − V`, where primes denote the next step. After a terminated episode `V'` is 0, after a
/// truncated one it is the value of the final observation; in both `A'` is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discounts {
    /// `γ`, from 0 to 1.
    pub rewards: f64,
    /// `λ`, from 0 to 1: with 1, returns are sums of discounted rewards.
    pub errors: f64,
}

/// Advantages and returns of a rollout: allocated once, filled many times.
#[derive(Debug)]
pub struct Estimates<T> {
    plan: Plan,
    advantage: Buffer<T>,
    returned: Buffer<T>,
}

impl<T: Float + Pod> Estimates<T> {
    /// Allocates the estimates of a rollout of this plan.
    ///
    /// # Errors
    /// [`EnvironmentError::Ensemble`] if there is not so much.
    pub fn new(plan: Plan) -> Result<Self, EnvironmentError> {
        let needed = plan.transitions().saturating_mul(2 * size_of::<T>() as u128);
        crate::ensemble::InsufficientMemory::check(needed)?;
        let refused = crate::ensemble::InsufficientMemory { needed, available: None };
        let all = plan.horizon.checked_mul(plan.environments);
        let all = all.filter(|_| plan.horizon <= isize::MAX as usize).ok_or(refused)?;
        let buffer = || -> Result<Buffer<T>, EnsembleError> { Buffer::new(all, Pages::Huge) };
        Ok(Estimates { plan, advantage: buffer()?, returned: buffer()? })
    }

    /// The advantages: `[t, n]`; 0 where there was no transition.
    pub fn advantage(&self) -> &[T] {
        &self.advantage
    }

    /// The returns, which are the advantages and the values: `[t, n]`; 0 where there was no transition.
    pub fn returns(&self) -> &[T] {
        &self.returned
    }

    /// Computes advantages and returns from the rewards and values of a rollout: `next` are the values of the observations after its
    /// last step, `last` those of the final observations of its [finals](Rollout::finals).
    ///
    /// # Errors
    /// [`EnvironmentError::Number`] if a discount is not from 0 to 1; [`EnvironmentError::Field`] if the rollout has no values;
    /// [`EnvironmentError::Shape`] if a length is wrong.
    pub fn fill<const O: usize, const D: usize>(
        &mut self,
        discounts: Discounts,
        rollout: &Rollout<T, O, D>,
        next: &[T],
        last: &[T],
        execution: &Execution,
    ) -> Result<(), EnvironmentError> {
        let Plan { horizon, environments: n, .. } = rollout.plan();
        ensure_probability("discount of rewards", discounts.rewards)?;
        ensure_probability("discount of errors", discounts.errors)?;
        if !rollout.plan().value {
            let (why, field) = ("advantages need values", "value");
            return Err(EnvironmentError::Field { why, field });
        }
        EnvironmentError::shape("steps of the rollout", horizon, self.plan.horizon)?;
        EnvironmentError::shape("environments of the rollout", n, self.plan.environments)?;
        EnvironmentError::shape("values after the last step", next.len(), n)?;
        let finals = rollout.finals().len();
        EnvironmentError::shape("values of the final observations", last.len(), finals)?;

        // A thread reads three numbers and two flags and writes two numbers: as much as in a rollout.
        let work = (n as u64).saturating_mul(horizon as u64).saturating_mul(4);
        let threads = execution.threads_for(work);
        let counts: Vec<usize> =
            (0..threads).map(|i| n * (i + 1) / threads - n * i / threads).collect();
        let mut advantages = rows_of(&mut self.advantage, horizon);
        let mut returns = rows_of(&mut self.returned, horizon);
        let mut first = 0;
        let mut parts = Vec::with_capacity(threads);
        for len in counts {
            let advantages = first_columns(&mut advantages, len);
            let returns = first_columns(&mut returns, len);
            parts.push(EstimateSlice {
                discounts,
                rollout,
                next,
                last,
                first,
                len,
                advantages,
                returns,
            });
            first += len;
        }
        let instructions = execution.instruction_set();
        execution.each(parts, |slice| instructions.vectorize(slice));
        Ok(())
    }
}

/// Neighbouring environments, from the last step to the first.
struct EstimateSlice<'a, T, const O: usize, const D: usize> {
    discounts: Discounts,
    rollout: &'a Rollout<T, O, D>,
    next: &'a [T],
    last: &'a [T],
    first: usize,
    len: usize,
    advantages: ArrayViewMut2<'a, T>,
    returns: ArrayViewMut2<'a, T>,
}

impl<T: Float + Pod, const O: usize, const D: usize> Loop for EstimateSlice<'_, T, O, D> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let EstimateSlice {
            discounts,
            rollout,
            next,
            last,
            first,
            len,
            mut advantages,
            mut returns,
        } = self;
        let n = rollout.plan().environments;
        let (gamma, both) =
            (T::from_f64(discounts.rewards), T::from_f64(discounts.rewards * discounts.errors));
        let own = first..first + len;
        let none = vec![0_u8; len];
        let mut worth = next[own.clone()].to_vec();
        let mut carried = vec![T::zero(); len];
        let mut idle = vec![0_u8; len];
        let mut ends = rollout.finals().iter().zip(last).rev();
        let mut end = ends.next();
        for t in (0..advantages.nrows()).rev() {
            while let Some((last, &value)) = end.filter(|(end, _)| end.step == t) {
                if own.contains(&last.environment) {
                    let over = rollout.terminated()[t * n + last.environment] != 0;
                    worth[last.environment - first] = if over { T::zero() } else { value };
                }
                end = ends.next();
            }
            rollout.write_idle(t, first, &mut idle);
            let advantages = &mut row(&mut advantages, t)[..len];
            let returns = &mut row(&mut returns, t)[..len];
            let rewards = &rollout.reward()[t * n + first..][..len];
            let values = &rollout.value()[t * n + first..][..len];
            let row = t * n + first..t * n + first + len;
            let overs = rollout.terminated().get(row.clone()).unwrap_or(&none);
            let cuts = rollout.truncated().get(row).unwrap_or(&none);
            let (worth, carried) = (&mut worth[..len], &mut carried[..len]);
            let (idle, overs, cuts) = (&idle[..len], &overs[..len], &cuts[..len]);
            for j in 0..len {
                let error = rewards[j] + gamma * worth[j] - values[j];
                let later = if overs[j] | cuts[j] != 0 { T::zero() } else { both * carried[j] };
                let stood = idle[j] != 0;
                let advantage = if stood { T::zero() } else { error + later };
                advantages[j] = advantage;
                returns[j] = if stood { T::zero() } else { advantage + values[j] };
                carried[j] = advantage;
                worth[j] = values[j];
            }
        }
    }
}
