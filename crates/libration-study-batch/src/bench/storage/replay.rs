//! Replay buffers, alternating with copies.

use std::cell::RefCell;
use std::hint::black_box;

use libration::ensemble::{Buffer, Execution, Pages};
use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer, ReplayError};
use libration::rl::policy::{Constant, Random};
use libration::rl::{Environments, Plan, Policy, Rollout, World};
use libration_study::{Lab, StudyError};

use super::{StorageRate, Stored};
use crate::bench::{Contestant, Turns, race, regulating, regulating_from};

/// Transitions that a buffer holds.
const KEPT: usize = 1_000_000;
/// Transitions of a batch.
const BATCH: usize = 256;
/// Environments and steps of what is inserted.
const INSERTED: [usize; 2] = [4096, 16];
/// Environments of the buffers that are drawn from.
const DRAWN: usize = 64;

/// The source's transitions.
type Store = ReplayBuffer<f32>;
const SIZES: [usize; 2] = [2, 1];

/// Times them on one core: none of it is worth a second.
pub(super) fn measure(lab: &Lab<'_>) -> Result<Vec<StorageRate>, StudyError> {
    let serial = lab.alone()?;
    let (rounds, seconds) = lab.effort.choose((5, 5e-3), (15, 20e-3), (31, 40e-3));
    let turns = Turns { rounds, seconds };
    let fault = RefCell::new(Ok(()));
    let mut rates = draws(lab, turns, &serial, &fault)?;
    rates.push(insertion(lab, turns, &serial, &fault)?);
    fault.into_inner()?;
    Ok(rates)
}

/// A buffer and rollouts for it, of so many environments.
struct Filled {
    store: Store,
    rollout: Rollout<f32, 2, 1>,
    next: Vec<f32>,
}

fn filled(
    world: impl World<f32, 2, 1>,
    policy: impl Policy<f32, 2, 1>,
    capacity: Capacity,
    execution: &Execution,
) -> Result<Filled, ReplayError> {
    let environments = capacity.environments;
    let mut all = Environments::new(world, environments, 7, execution.clone())?;
    let mut rollout = Rollout::new(Plan::new(INSERTED[1], environments).truncated())?;
    let mut next = vec![0.0; environments * 2];
    let mut store = Store::new(SIZES, capacity)?;
    while store.inserted() * (environments as u64) < 2 * KEPT as u64 {
        all.rollout(policy, &mut rollout)?;
        all.observe(&mut next)?;
        store.insert(&rollout, &next, execution)?;
    }
    Ok(Filled { store, rollout, next })
}

type Fault = RefCell<Result<(), ReplayError>>;

/// Keeps the first that goes wrong.
fn note(fault: &Fault, outcome: Result<(), ReplayError>) {
    if outcome.is_err() && fault.borrow().is_ok() {
        *fault.borrow_mut() = outcome;
    }
}

/// Batches a second.
fn draws(
    lab: &Lab<'_>,
    turns: Turns,
    serial: &Execution,
    fault: &Fault,
) -> Result<Vec<StorageRate>, StudyError> {
    let capacity = Capacity::new(KEPT / DRAWN, DRAWN);
    let acting = Random::between([-1.0], [1.0]);
    let plain = filled(regulating(), acting, capacity, serial)?.store;
    let mut weighed = filled(regulating(), acting, capacity.priorities(), serial)?.store;
    let ahead = Lookahead::default();
    let [mut one, mut two] = [(); 2].map(|()| Batch::<f32>::new(BATCH, SIZES));
    let [mut first, mut second] = [0, 0];
    let mut priorities = vec![0.0_f32; BATCH];
    let uniform = Contestant::new(1.0, |times| {
        for _ in 0..times {
            first += 1;
            let draw = Draw { seed: 1, number: first };
            note(fault, plain.sample(draw, ahead, &mut one.columns(), serial));
        }
        black_box(&one.reward);
    });
    let prioritised = Contestant::new(1.0, |times| {
        for _ in 0..times {
            second += 1;
            let draw = Draw { seed: 1, number: second };
            let columns = &mut two.columns();
            note(fault, weighed.sample_prioritised(draw, ahead, 0.4, columns, serial));
            // As large as an error might be.
            for (priority, reward) in priorities.iter_mut().zip(&two.reward) {
                *priority = reward.abs() + 1e-3;
            }
            note(fault, weighed.update(&two.number, &priorities, 0.6).map(|_| ()));
        }
        black_box(&two.reward);
    });
    let rates = race(lab, turns, &mut [uniform, prioritised])?;
    let each = [Stored::Sample, Stored::Prioritised].into_iter().zip(&rates);
    Ok(each.map(|(stored, rates)| StorageRate::new(stored, 1, rates, None)).collect())
}

/// Transitions a second that are inserted, beside copies of the numbers and the flag of each into as much memory.
fn insertion(
    lab: &Lab<'_>,
    turns: Turns,
    execution: &Execution,
    fault: &Fault,
) -> Result<StorageRate, StudyError> {
    let [environments, steps] = INSERTED;
    let places = KEPT / environments / steps;
    let capacity = Capacity::new(places * steps, environments);
    // At rest every rollout goes on where the one before ended, also if it is the same again.
    let still = filled(regulating_from(0.0), Constant([0.0]), capacity, execution)?;
    let Filled { mut store, rollout, next } = still;
    let transitions = environments * steps;
    let inserted = Contestant::new(transitions as f64, |times| {
        for _ in 0..times {
            note(fault, store.insert(&rollout, &next, execution));
        }
    });
    // Two numbers that are seen, one that is done, one that is paid, and a flag.
    let bytes = transitions * (4 * size_of::<f32>() + 1);
    let mut from = Buffer::<u8>::new(bytes, Pages::Huge)?;
    let mut to = Buffer::<u8>::new(bytes * places, Pages::Huge)?;
    from.fill(1);
    to.fill(2);
    let mut place = 0;
    let copied = Contestant::new(transitions as f64, |times| {
        for _ in 0..times {
            place = (place + 1) % places;
            to[place * bytes..][..bytes].copy_from_slice(black_box(&from));
        }
        black_box(&*from);
    });
    let rates = race(lab, turns, &mut [inserted, copied])?;
    Ok(StorageRate::new(Stored::Insert, 1, &rates[0], Some(&rates[1])))
}
