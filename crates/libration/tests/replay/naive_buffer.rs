//! A naive replay buffer: a list of complete transitions.

use std::collections::VecDeque;

use libration::replay::Capacity;
use libration::rl::Rollout;

/// A transition with all that belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transition {
    pub(crate) seen: [f32; 2],
    pub(crate) done: [f32; 1],
    pub(crate) paid: f32,
    pub(crate) over: bool,
    pub(crate) cut: bool,
    /// Whether what was seen next is not where the next step begins.
    pub(crate) parted: bool,
    pub(crate) next: [f32; 2],
    pub(crate) weight: f64,
}

/// None where a step was no transition; what was seen in it all the same.
type Step = Vec<([f32; 2], Option<Transition>)>;

/// The list.
pub(crate) struct Naive {
    capacity: Capacity,
    /// The number of the first step.
    pub(crate) first: u64,
    steps: VecDeque<Step>,
    next: Vec<[f32; 2]>,
    pub(crate) largest: f64,
}

impl Naive {
    pub(crate) fn new(capacity: Capacity) -> Self {
        Naive { capacity, first: 0, steps: VecDeque::new(), next: Vec::new(), largest: 1.0 }
    }

    pub(crate) fn insert(&mut self, rollout: &Rollout<f32, 2, 1>, next: &[f32]) {
        let plan = rollout.plan();
        let n = plan.environments;
        let parted: Vec<usize> = match self.steps.back() {
            None => Vec::new(),
            Some(last) => (0..n)
                .filter(|&i| rollout.seen(0, i).map(f32::to_bits) != self.next[i].map(f32::to_bits))
                .filter(|&i| last[i].1.is_some_and(|transition| !transition.parted))
                .collect(),
        };
        let coming = rollout.finals().len() + parted.len();
        while !self.steps.is_empty()
            && (self.steps.len() + plan.horizon > self.capacity.steps
                || self.ends() + coming > self.capacity.ends)
        {
            self.steps.pop_front();
            self.first += 1;
        }
        if let Some(last) = self.steps.back_mut() {
            for i in parted {
                if let (_, Some(transition)) = &mut last[i] {
                    transition.parted = true;
                }
            }
        }
        for t in 0..plan.horizon {
            let step = (0..n).map(|i| {
                let at = t * n + i;
                let end = rollout.finals().iter().find(|f| (f.step, f.environment) == (t, i));
                let after = match end {
                    Some(end) => end.observation,
                    None if t + 1 < plan.horizon => rollout.seen(t + 1, i),
                    None => [next[2 * i], next[2 * i + 1]],
                };
                let transition = Transition {
                    seen: rollout.seen(t, i),
                    done: rollout.done(t, i),
                    paid: rollout.reward()[at],
                    over: rollout.terminated()[at] == 1,
                    cut: rollout.truncated()[at] == 1,
                    parted: end.is_some(),
                    next: after,
                    weight: self.largest,
                };
                let is = rollout.is_transition(t, i) && !end.is_some_and(|end| end.lost);
                (transition.seen, is.then_some(transition))
            });
            self.steps.push_back(step.collect());
        }
        self.next = next.chunks(2).map(|seen| [seen[0], seen[1]]).collect();
    }

    fn ends(&self) -> usize {
        let parted = |(_, transition): &&([f32; 2], Option<Transition>)| {
            transition.is_some_and(|transition| transition.parted)
        };
        self.steps.iter().flatten().filter(parted).count()
    }

    pub(crate) fn len(&self) -> u64 {
        self.all().count() as u64
    }

    pub(crate) fn steps(&self) -> u64 {
        self.steps.len() as u64
    }

    /// All transitions with their numbers.
    pub(crate) fn all(&self) -> impl Iterator<Item = (u64, Transition)> + '_ {
        let n = self.capacity.environments as u64;
        let first = self.first * n;
        let flat = self.steps.iter().flatten().enumerate();
        flat.filter_map(move |(i, (_, transition))| Some((first + i as u64, (*transition)?)))
    }

    pub(crate) fn get(&self, number: u64) -> Option<Transition> {
        let n = self.capacity.environments as u64;
        let step = (number / n).checked_sub(self.first)?;
        self.steps.get(step as usize)?[(number % n) as usize].1
    }

    /// What was seen in the step of this number, transition or not.
    pub(crate) fn seen(&self, number: u64) -> [f32; 2] {
        let n = self.capacity.environments as u64;
        self.steps[(number / n - self.first) as usize][(number % n) as usize].0
    }

    /// The transition, and the steps after it up to so many: what they pay, the last of them, and how many they are.
    pub(crate) fn ahead(&self, number: u64, most: usize, gamma: f32) -> (f32, Transition, usize) {
        let n = self.capacity.environments as u64;
        let mut last = self.get(number).unwrap();
        let (mut paid, mut factor, mut taken) = (last.paid, gamma, 1);
        while taken < most && !last.parted {
            let Some(next) = self.get(number + taken as u64 * n) else { break };
            paid += factor * next.paid;
            factor *= gamma;
            taken += 1;
            last = next;
        }
        (paid, last, taken)
    }

    pub(crate) fn weigh(&mut self, number: u64, weight: f64) {
        let n = self.capacity.environments as u64;
        let Some(step) = (number / n).checked_sub(self.first) else { return };
        if let Some(Some(transition)) =
            self.steps.get_mut(step as usize).map(|step| &mut step[(number % n) as usize].1)
        {
            transition.weight = weight;
            self.largest = self.largest.max(weight);
        }
    }
}
