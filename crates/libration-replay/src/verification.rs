//! Verification of a replay buffer that an earlier process wrote.

use bytemuck::Pod;
use libration_core::Float;

use super::memory::Marks;
use super::replay_buffer::{END, NONE};
use super::{ReplayBuffer, ReplayError};

impl<T: Float + Pod> ReplayBuffer<T> {
    /// Marks transitions before a reset: the process may have died between the end and its mark.
    pub(super) fn mark_parted(&mut self) {
        let parted = |i: u64| {
            let (place, n) = self.width.divide(self.place(i));
            // Ends of resets stand at odd places; see `place_of`.
            (place % 2 == 1).then(|| self.cell(place / 2, n as usize))
        };
        let Marks { ends, .. } = self.marks;
        let cells: Vec<usize> = (ends.first..ends.end).filter_map(parted).collect();
        let flags = self.memory.fields.flags.clone();
        let flags = self.memory.field_mut::<u8>(flags);
        cells.into_iter().for_each(|cell| flags[cell] |= END);
    }

    /// Verifies the counters, ends and weights in memory.
    pub(super) fn verify(&self) -> Result<(), ReplayError> {
        let damaged = |what: String| Err(ReplayError::Damaged(what));
        let Marks { head, tail, ends, live, largest } = self.marks;
        let n = self.capacity.environments as u64;
        let fits = tail <= head
            && head - tail <= self.capacity.steps as u64
            && head.checked_mul(2 * n).is_some()
            && ends.first <= ends.end
            && ends.end - ends.first <= self.capacity.ends as u64
            && largest.is_finite()
            && largest > 0.0;
        if !fits {
            return damaged(format!("its counters are inconsistent: {:?}", self.marks));
        }
        let mut before = None;
        for i in ends.first..ends.end {
            let place = self.place(i);
            if before.is_some_and(|before| before >= place)
                || !(2 * tail * n..2 * head * n).contains(&place)
            {
                return damaged(format!("end {i} is in an invalid place"));
            }
            before = Some(place);
        }
        let mut count = 0;
        for step in tail..head {
            for n in 0..self.capacity.environments {
                let flags = self.flags()[self.cell(step, n)];
                count += u64::from(flags & NONE == 0);
                if flags & END != 0 && self.end_of(step, n, flags).is_none() {
                    let what = "ends, but its last observation is missing";
                    return damaged(format!("step {step} of environment {n} {what}"));
                }
            }
        }
        if count != live {
            return damaged(format!("there are {count} transitions, and it counts {live}"));
        }
        let wrong = self.weights().iter().find(|w| !(w.is_finite() && **w >= 0.0));
        wrong.map_or(Ok(()), |w| damaged(format!("the weight of a transition is {w}")))
    }
}
