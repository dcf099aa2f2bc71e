//! The reference for environments: one environment in scalars that stores all its past.

use libration::control::{Clock, StartAddress};
use libration::random::{Address, EPOCH, Purpose, Streams};
use libration::rl::{
    Autoreset, Episode, ErrorScale, Parts, Policy, Sensor, Start, StepIndex, Task, Variation, World,
};
use libration::system::CommandedSystem;
use libration::{Integrator, State};

/// What an environment did in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Told {
    pub(crate) seen: [f32; 2],
    pub(crate) action: [f32; 1],
    pub(crate) log_probability: f32,
    pub(crate) reward: f32,
    pub(crate) over: u8,
    pub(crate) cut: u8,
    /// Whether it was a step at all.
    pub(crate) moved: bool,
    /// What was seen last, where an episode ended.
    pub(crate) last: Option<[f32; 2]>,
}

/// The words of one trajectory for one purpose, one after the other.
struct Words {
    address: (u64, u64, Purpose),
    stream: Streams<1>,
}

impl Words {
    fn new(seed: u64, n: u64, purpose: Purpose) -> Self {
        Words { address: (seed, n, purpose), stream: Streams::none() }
    }

    /// Before this one of the draws of an episode: the epochs of each are as far from those of the next as 2⁶⁴ divided by the golden ratio.
    fn before(&mut self, draw: u64, number: u64) {
        let (seed, trajectory, purpose) = self.address;
        if draw.is_multiple_of(EPOCH) {
            let step = (draw / EPOCH).wrapping_add(number.wrapping_mul(11_400_714_819_323_198_485));
            self.stream.begin_epoch(0, Address { seed, trajectory, step, purpose });
        }
    }
}

/// What environment `n` of `environments` does in so many steps.
pub(crate) fn alone<E: World<f32, 2, 1>, P: Policy<f32, 2, 1>>(
    world: &E,
    policy: P,
    (n, environments): (usize, usize),
    seed: u64,
    steps: u64,
) -> Vec<Told> {
    let parts: Parts<f32, E, 2, 1> = *world.parts();
    let substeps = u64::from(parts.substeps);
    let address = |number| Episode { seed, environment: n as u64, number };
    let words = |purpose| Words::new(seed, n as u64, purpose);
    let [mut times, mut looks, mut acts] =
        [Purpose::StepTime, Purpose::Observation, Purpose::Action].map(words);
    let mut told: Vec<Told> = Vec::new();
    let mut number = 0;
    let mut standing: Option<(u8, u8)> = None;
    // Of the episode: states at the beginning of each step of the integrator, and actions.
    let (mut states, mut actions, mut clock) = (Vec::new(), Vec::<[f32; 1]>::new(), None);
    // Its steps so far: what stands still grows no older.
    let mut age = 0;
    for step in 0..steps {
        if clock.is_none() {
            states = vec![parts.start.draw(address(number))];
            actions.clear();
            age = 0;
            clock = Some(parts.clock.start(StartAddress::new(seed, n as u64, number)));
        }
        let numbers = parts.variation.draw(address(number));
        let systems = libration::ensemble::Assign::of(parts.systems, n);
        let (system, task) = parts.variation.apply(&numbers, systems, parts.task);
        let error_scale = error_scale(&parts.error_scale, address(number));
        let [late, effect] = delays(&parts.delays, address(number));
        let see = |states: &[State<f32, 1>], looks: &mut Words, age: u64| {
            looks.before(age, number);
            let shown = states[states.len().saturating_sub(1 + late)];
            let seen = task.observe(0.0, &shown);
            let measured = parts.sensor.measure(seen, &mut || looks.stream.next(0));
            let noisy = |i: usize| measured[i] + (error_scale[1] - 1.0) * (measured[i] - seen[i]);
            if E::Sensor::DRAWS { [noisy(0), noisy(1)] } else { measured }
        };
        let words = [&times, &looks, &acts].map(|words| words.stream);
        let seen = see(&states, &mut looks, age);
        acts.before(age, number);
        let place = StepIndex { environment: n, environments, step, row: 0 };
        let act = policy.act(place, &seen, &mut || acts.stream.next(0));
        let before = *states.last().unwrap();
        let most = parts.saturation as f32;
        let command = act.action.map(|u| if u.abs() > most { most.copysign(u) } else { u });
        actions.push(command);
        let mut state = before;
        for substep in 0..substeps {
            let at = step * substeps + substep;
            times.before(age * substeps + substep, number);
            // The action whose look lies a latency or more behind.
            let passed = (states.len() as i64 - 1 - effect as i64).div_euclid(substeps as i64);
            let command = usize::try_from(passed).map_or([0.0], |passed| actions[passed]);
            let memory = clock.as_mut().unwrap();
            let ratio =
                parts.clock.ratio(memory, parts.clock.beat(at), &mut || times.stream.next(0));
            let ratio =
                if E::Clock::EVEN { ratio } else { ratio + (error_scale[0] - 1.0) * (ratio - 1.0) };
            let ratio = if ratio < 0.0 { 0.0 } else { ratio };
            let mobility = parts.mass.recip() as f32;
            let system = CommandedSystem { system, command: command.map(|u| u * mobility) };
            state = parts.method.step(&system, state, parts.dt as f32 * ratio);
            states.push(state);
        }
        let mut now = Told {
            seen,
            action: act.action,
            log_probability: act.log_probability,
            reward: task.reward(0.0, &before, &command, &state),
            over: u8::from(task.terminated(0.0, &state)),
            cut: u8::from(actions.len() as u32 >= parts.limit.unwrap_or(u32::MAX)),
            moved: true,
            last: None,
        };
        if let Some((over, cut)) = standing {
            // No step at all; sensors go on seeing what stands still.
            let passed = states.len() - substeps as usize;
            states[passed..].fill(before);
            [times.stream, looks.stream, acts.stream] = words;
            (now.reward, now.moved) = (0.0, false);
            if parts.autoreset == Autoreset::NextStep {
                (now.over, now.cut) = (0, 0);
                (number, clock, standing) = (number + 1, None, None);
            } else {
                (now.over, now.cut) = (over, cut);
            }
        } else if now.over + now.cut > 0 {
            let mut ahead = Words { stream: looks.stream, ..looks };
            now.last = Some(see(&states, &mut ahead, age + 1));
            match parts.autoreset {
                Autoreset::SameStep => (number, clock) = (number + 1, None),
                Autoreset::NextStep | Autoreset::Disabled => standing = Some((now.over, now.cut)),
            }
        }
        age += u64::from(now.moved);
        told.push(now);
    }
    told
}

/// How bad the clock and the sensor of an episode are.
fn error_scale(error_scale: &ErrorScale, episode: Episode) -> [f32; 2] {
    let one = |i: u64, [least, most]: [f64; 2]| {
        let place = Address {
            seed: episode.seed,
            trajectory: episode.environment,
            step: episode.number * 64 + 2 + i,
            purpose: Purpose::Delay,
        };
        (least + place.uniform()[0] * (most - least)) as f32
    };
    [one(0, error_scale.clock), one(1, error_scale.sensor)]
}

/// The latencies of an episode: as many shares of the interval as there are whole numbers in it.
fn delays(delays: &libration::rl::Delays, episode: Episode) -> [usize; 2] {
    let mut drawn = [0; 2];
    for (i, [least, most]) in [delays.observation, delays.action].into_iter().enumerate() {
        let place = Address {
            seed: episode.seed,
            trajectory: episode.environment,
            step: episode.number * 64 + i as u64,
            purpose: Purpose::Delay,
        };
        let whole = (place.uniform()[0] * f64::from(most - least + 1)).floor();
        drawn[i] = least as usize + whole as usize;
    }
    drawn
}
