//! Stretches of steps that are drawn, for learners that remember.

use bytemuck::Pod;
use libration_core::Float;

use super::replay_buffer::{CUT, END, NONE, OVER};
use super::{Draw, Replay, ReplayError};
use crate::ensemble::Execution;

/// Stretches of equally many steps, allocated once, to be filled again and again: each field is `[i, t]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequences<T, const O: usize, const D: usize> {
    /// Steps of each.
    pub steps: usize,
    /// The number of the first transition of each: `[i]`.
    pub number: Vec<u64>,
    /// The observations.
    pub observation: Vec<[T; O]>,
    /// The actions.
    pub action: Vec<[T; D]>,
    /// The rewards.
    pub reward: Vec<T>,
    /// 1 where the episode was over, otherwise 0.
    pub terminated: Vec<u8>,
    /// 1 where it was cut off, otherwise 0.
    pub truncated: Vec<u8>,
    /// 1 as long as the episode goes on in which the stretch began, 0 for what comes after: another episode, or steps that were
    /// no transitions.
    pub mask: Vec<u8>,
    /// The observation after the last step of the mask: `[i]`.
    pub next_observation: Vec<[T; O]>,
}

impl<T: Float, const O: usize, const D: usize> Sequences<T, O, D> {
    /// Allocates `len` sequences of `steps` steps.
    pub fn new(len: usize, steps: usize) -> Self {
        let all = len * steps;
        Sequences {
            steps,
            number: vec![0; len],
            observation: vec![[T::zero(); O]; all],
            action: vec![[T::zero(); D]; all],
            reward: vec![T::zero(); all],
            terminated: vec![0; all],
            truncated: vec![0; all],
            mask: vec![0; all],
            next_observation: vec![[T::zero(); O]; len],
        }
    }
}

/// A stretch and where it is written.
struct Stretch<'a, T, const O: usize, const D: usize> {
    number: u64,
    observation: &'a mut [[T; O]],
    action: &'a mut [[T; D]],
    reward: &'a mut [T],
    terminated: &'a mut [u8],
    truncated: &'a mut [u8],
    mask: &'a mut [u8],
    next_observation: &'a mut [T; O],
}

/// Steps that are worth a thread.
const PIECE: usize = 1 << 14;

impl<T: Float + Pod, const O: usize, const D: usize> Replay<T, O, D> {
    /// Fills stretches that are drawn with replacement: each that lies wholly in the buffer and begins with a transition is as likely.
    ///
    /// # Errors
    /// [`ReplayError::Empty`] if there is none; [`ReplayError::Nothing`] if they are of no steps;
    /// [`ReplayError::Environment`] if the fields do not fit each other.
    pub fn sample_sequences(
        &self,
        draw: Draw,
        to: &mut Sequences<T, O, D>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        let (len, steps) = (to.number.len(), to.steps);
        if steps == 0 {
            return Err(ReplayError::Nothing { name: "steps of a stretch" });
        }
        let all = len.saturating_mul(steps);
        for (name, found, wanted) in [
            ("observations of the stretches", to.observation.len(), all),
            ("actions of the stretches", to.action.len(), all),
            ("rewards of the stretches", to.reward.len(), all),
            ("terminations of the stretches", to.terminated.len(), all),
            ("truncations of the stretches", to.truncated.len(), all),
            ("masks of the stretches", to.mask.len(), all),
            ("next observations of the stretches", to.next_observation.len(), len),
        ] {
            ReplayError::shape(name, found, wanted)?;
        }
        let last = self.marks.head.checked_sub(steps as u64);
        let starts =
            last.filter(|&last| last >= self.marks.tail).map(|last| self.marks.tail..last + 1);
        let starts = starts.and_then(|steps| self.drawable(steps));
        let starts = starts.ok_or(ReplayError::Empty("stretches of so many steps"))?;
        for (i, number) in to.number.iter_mut().enumerate() {
            *number = self.any(&starts, draw, i);
        }
        let fields = to.number.iter().zip(to.observation.chunks_mut(steps));
        let fields = fields.zip(to.action.chunks_mut(steps)).zip(to.reward.chunks_mut(steps));
        let fields =
            fields.zip(to.terminated.chunks_mut(steps)).zip(to.truncated.chunks_mut(steps));
        let fields = fields.zip(to.mask.chunks_mut(steps)).zip(&mut to.next_observation);
        let stretches =
            fields.map(|(((((((&number, seen), done), paid), over), cut), mask), next)| Stretch {
                number,
                observation: seen,
                action: done,
                reward: paid,
                terminated: over,
                truncated: cut,
                mask,
                next_observation: next,
            });
        if execution.thread_count() == 1 || all < 2 * PIECE {
            stretches.for_each(|stretch| self.fill(stretch));
        } else {
            execution.each(stretches.collect(), |stretch| self.fill(stretch));
        }
        Ok(())
    }

    fn fill(&self, to: Stretch<'_, T, O, D>) {
        let (step, l) = self.width.divide(to.number);
        let l = l as usize;
        let mut goes_on = true;
        for t in 0..to.mask.len() {
            let cell = self.cell(step + t as u64, l);
            let flags = self.flags()[cell];
            goes_on &= flags & NONE == 0;
            (to.observation[t], to.action[t]) = (self.observation()[cell], self.action()[cell]);
            to.reward[t] = self.reward()[cell];
            (to.terminated[t], to.truncated[t]) = (flags & OVER, (flags & CUT) / CUT);
            to.mask[t] = u8::from(goes_on);
            if goes_on {
                *to.next_observation = self.next(step + t as u64, l, flags);
            }
            goes_on &= flags & END == 0;
        }
    }
}
