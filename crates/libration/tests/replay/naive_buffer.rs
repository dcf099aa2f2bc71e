//! A naive replay buffer: a list of complete transitions.

use std::collections::VecDeque;

use libration::replay::Capacity;
use libration::rl::{Layout, RolloutTensors};

/// A transition with all that belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Transition {
    pub(crate) seen: Vec<f32>,
    pub(crate) done: Vec<f32>,
    pub(crate) paid: f32,
    pub(crate) over: bool,
    pub(crate) cut: bool,
    /// Whether what was seen next is not where the next step begins.
    pub(crate) parted: bool,
    pub(crate) next: Vec<f32>,
    pub(crate) weight: f64,
}

/// None where a step was no transition; what was seen in it all the same.
type Step = Vec<(Vec<f32>, Option<Transition>)>;

/// The `width` numbers of environment `i` in step `t`.
fn row(
    rollout: &dyn RolloutTensors<f32>,
    numbers: &[f32],
    width: usize,
    [t, i]: [usize; 2],
) -> Vec<f32> {
    let plan = rollout.plan();
    let (cell, cells) = (t * plan.environments + i, plan.horizon * plan.environments);
    let at = |k| match plan.layout {
        Layout::Interleaved => cell * width + k,
        Layout::Planes => k * cells + cell,
    };
    (0..width).map(|k| numbers[at(k)]).collect()
}

/// The list.
pub(crate) struct Naive {
    capacity: Capacity,
    /// The number of the first step.
    pub(crate) first: u64,
    steps: VecDeque<Step>,
    next: Vec<Vec<f32>>,
    pub(crate) largest: f64,
}

impl Naive {
    pub(crate) fn new(capacity: Capacity) -> Self {
        Naive { capacity, first: 0, steps: VecDeque::new(), next: Vec::new(), largest: 1.0 }
    }

    pub(crate) fn insert(&mut self, rollout: &dyn RolloutTensors<f32>, next: &[f32]) {
        let plan = rollout.plan();
        let n = plan.environments;
        let ([observations, actions], ended) = (rollout.sizes(), rollout.ended());
        let seen = |t, i| row(rollout, rollout.observation(), observations, [t, i]);
        let next: Vec<Vec<f32>> = next.chunks(observations).map(<[f32]>::to_vec).collect();
        let bits = |row: &[f32]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let parted: Vec<usize> = match self.steps.back() {
            None => Vec::new(),
            Some(last) => (0..n)
                .filter(|&i| bits(&seen(0, i)) != bits(&self.next[i]))
                .filter(|&i| last[i].1.as_ref().is_some_and(|transition| !transition.parted))
                .collect(),
        };
        let coming = ended + parted.len();
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
            let mut idle = vec![0; n];
            rollout.write_idle(t, 0, &mut idle);
            let step = (0..n).map(|i| {
                let at = t * n + i;
                let mut ends = (0..ended).map(|k| rollout.end(k));
                let end = ends.find(|(end, _)| (end.step, end.environment) == (t, i));
                let after = match end {
                    Some((_, last)) => last.to_vec(),
                    None if t + 1 < plan.horizon => seen(t + 1, i),
                    None => next[i].clone(),
                };
                let transition = Transition {
                    seen: seen(t, i),
                    done: row(rollout, rollout.action(), actions, [t, i]),
                    paid: rollout.reward()[at],
                    over: rollout.terminated()[at] == 1,
                    cut: rollout.truncated()[at] == 1,
                    parted: end.is_some(),
                    next: after,
                    weight: self.largest,
                };
                let is = idle[i] == 0 && !end.is_some_and(|(end, _)| end.lost);
                (transition.seen.clone(), is.then_some(transition))
            });
            self.steps.push_back(step.collect());
        }
        self.next = next;
    }

    fn ends(&self) -> usize {
        let parted = |(_, transition): &&(Vec<f32>, Option<Transition>)| {
            transition.as_ref().is_some_and(|transition| transition.parted)
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
    pub(crate) fn all(&self) -> impl Iterator<Item = (u64, &Transition)> {
        let n = self.capacity.environments as u64;
        let first = self.first * n;
        let flat = self.steps.iter().flatten().enumerate();
        flat.filter_map(move |(i, (_, transition))| Some((first + i as u64, transition.as_ref()?)))
    }

    pub(crate) fn get(&self, number: u64) -> Option<&Transition> {
        let n = self.capacity.environments as u64;
        let step = (number / n).checked_sub(self.first)?;
        self.steps.get(step as usize)?[(number % n) as usize].1.as_ref()
    }

    /// What was seen in the step of this number, transition or not.
    pub(crate) fn seen(&self, number: u64) -> &[f32] {
        let n = self.capacity.environments as u64;
        &self.steps[(number / n - self.first) as usize][(number % n) as usize].0
    }

    /// The transition, and the steps after it up to so many: what they pay, the last of them, and how many they are.
    pub(crate) fn ahead(&self, number: u64, most: usize, gamma: f32) -> (f32, &Transition, usize) {
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
