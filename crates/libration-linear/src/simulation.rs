//! Simulation of loops, event by event.

mod movement;

use std::collections::VecDeque;

use libration_core::control::{Jitter, Latency};
use libration_core::random::{Address, Purpose};

use self::movement::{Movement, flow};
use crate::phases::{merged, same};
use crate::{LinearLoop, LoopTiming, Matrix, MissingCommand};

/// A simulation of a loop with a timing, under noise that is held through each period.
///
/// It knows nothing of period matrices: states move by Taylor's series of the equations of motion (those of a stiff plant by the
/// exponential of its matrix), of unit vectors where all periods have the same length, and commands and measurements wait in queues.
#[derive(Clone, Copy, Debug)]
pub struct Simulation<'a> {
    /// The loop.
    pub linear: &'a LinearLoop,
    /// Its timing.
    pub timing: &'a LoopTiming,
    /// Lengths of periods relative to their mean, over and over, in place of the jitter.
    pub record: Option<&'a [f64]>,
    /// The seed of all random numbers.
    pub seed: u64,
}

/// A loop at the beginning of a period.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodStart {
    /// The states of the plant.
    pub x: Vec<f64>,
    /// The cost of this period and all before it.
    pub cost: f64,
}

/// One loop.
struct Trajectory<'a> {
    simulation: Simulation<'a>,
    number: u64,
    step: u64,
    /// The length of the last period, in s.
    passed: f64,
    x: Vec<f64>,
    memory: Vec<f64>,
    /// The latest command first.
    commands: VecDeque<Vec<f64>>,
    acting: Vec<f64>,
    /// Of each output its measurements, the latest first.
    measured: Vec<VecDeque<f64>>,
    counted: u64,
    cost: f64,
    /// The movements between the events of a period, where all periods have the same length.
    movements: Vec<Movement>,
}

impl Simulation<'_> {
    /// The mean cost rate of loop `number` over `periods` periods, after `before` periods from rest, with the states at the beginning
    /// of each period: that of [`LinearLoop::with_held_noise`]. A record and a schedule of controllers begin with their period
    /// `number`, so that each has its place beside the other; a multiple of the periods of a schedule counts all of them alike.
    pub fn mean_cost(&self, number: u64, before: u64, periods: u64) -> f64 {
        let mut one = self.trajectory(number);
        (0..before).for_each(|_| one.advance());
        (one.counted, one.cost) = (0, 0.0);
        (0..periods).for_each(|_| one.advance());
        one.cost / one.counted as f64
    }

    /// Loop `number` at the beginnings of its first periods, from the state `start`.
    pub fn period_starts(&self, number: u64, start: &[f64], periods: u64) -> Vec<PeriodStart> {
        let mut one = self.trajectory(number);
        one.x.copy_from_slice(start);
        let advance = |_| {
            let x = one.x.clone();
            one.advance();
            PeriodStart { x, cost: one.cost }
        };
        (0..periods).map(advance).collect()
    }

    fn trajectory(&self, number: u64) -> Trajectory<'_> {
        let plant = self.linear.plant();
        let longest = |latencies: &[Latency]| {
            latencies.iter().map(|latency| latency.whole() as usize + 1).max().unwrap_or(1)
        };
        let (n, m) = (plant.states.len(), plant.inputs.len());
        let waiting = |latency: &Latency| VecDeque::from(vec![0.0; latency.whole() as usize + 2]);
        Trajectory {
            simulation: *self,
            number,
            step: 0,
            passed: self.linear.period() * (1.0 + self.timing.skew),
            x: vec![0.0; n],
            memory: vec![0.0; self.linear.controller().memory()],
            commands: vec![vec![0.0; m]; longest(&self.timing.input_latency)].into(),
            acting: vec![0.0; m],
            measured: self.timing.output_latency.iter().map(waiting).collect(),
            counted: 0,
            cost: 0.0,
            movements: Vec::new(),
        }
    }

    /// Whether all periods have the same length.
    fn is_even(&self) -> bool {
        self.record.is_none() && self.timing.jitter.rms() == 0.0
    }
}

impl Trajectory<'_> {
    fn address(&self, purpose: Purpose, step: u64) -> Address {
        Address { seed: self.simulation.seed, trajectory: self.number, step, purpose }
    }

    /// `count` normal deviates.
    fn deviates(&self, purpose: Purpose, count: usize) -> Vec<f64> {
        let pairs = count.div_ceil(2) as u64;
        let draw = |k| self.address(purpose, self.step * pairs + k).gaussian();
        let mut all: Vec<f64> = (0..pairs).flat_map(draw).collect();
        all.truncate(count);
        all
    }

    /// The length of this period in s.
    fn length(&self) -> f64 {
        let Simulation { linear, timing, record, .. } = self.simulation;
        let relative = match (record, timing.jitter) {
            (Some(record), _) => record[((self.step + self.number) % record.len() as u64) as usize],
            (None, Jitter::Gaussian(rms)) => {
                1.0 + rms * self.address(Purpose::StepTime, self.step).gaussian()[0]
            }
            (None, Jitter::Uniform(rms)) => {
                let [u, _] = self.address(Purpose::StepTime, self.step).uniform();
                1.0 + rms * 3.0_f64.sqrt() * (2.0 * u - 1.0)
            }
        };
        linear.period() * (1.0 + timing.skew) * relative.max(0.0)
    }

    fn output(&self, j: usize, noise: f64) -> f64 {
        let plant = self.simulation.linear.plant();
        dot(plant.c.row(j), &self.x) + dot(plant.d.row(j), &self.acting) + noise
    }

    fn measure(&mut self, j: usize, noise: f64) {
        let value = self.output(j, noise);
        self.measured[j].push_front(value);
        self.measured[j].pop_back();
    }

    /// Moves the states through so many seconds.
    fn move_plant(&mut self, push: &[f64], seconds: f64) {
        let a = &self.simulation.linear.plant().a;
        if !self.simulation.is_even() {
            return flow(a, &mut self.x, push, seconds);
        }
        let known = self.movements.iter().position(|known| known.seconds == seconds);
        let place = known.unwrap_or_else(|| {
            self.movements.push(Movement::new(a, seconds));
            self.movements.len() - 1
        });
        let Movement { phi, gamma, .. } = &self.movements[place];
        let pairs = phi.apply(&self.x).into_iter().zip(gamma.apply(push));
        self.x = pairs.map(|(x, push)| x + push).collect();
    }

    fn advance(&mut self) {
        let Simulation { linear, timing, .. } = self.simulation;
        let LoopTiming { input_latency, output_latency, loss, missing, .. } = timing;
        let plant = linear.plant();
        let schedule = linear.controllers().order();
        let kind = schedule[((self.step + self.number) % schedule.len() as u64) as usize];
        let controller = linear.controller_after(kind, self.passed);
        let seconds = self.length();
        let lost = *loss > 0.0 && self.address(Purpose::Latency, self.step).uniform()[0] < *loss;
        let noise = self.deviates(Purpose::Observation, output_latency.len());
        let noise: Vec<f64> = noise
            .iter()
            .zip(linear.output_noise())
            .map(|(x, variance)| x * variance.sqrt())
            .collect();
        // Those of this moment come in at once.
        let mut seen = Vec::with_capacity(output_latency.len());
        for (j, latency) in output_latency.iter().enumerate() {
            if latency.part() == 0.0 {
                self.measure(j, noise[j]);
            }
            seen.push(self.measured[j][latency.whole() as usize]);
        }
        let add = |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a + b).collect();
        let command = add(controller.c.apply(&self.memory), controller.d.apply(&seen));
        self.memory = add(controller.a.apply(&self.memory), controller.b.apply(&seen));
        self.commands.push_front(command);
        self.commands.pop_back();
        let held: Vec<f64> = {
            let sampled = plant.sampling_period.is_some();
            let size = if sampled || seconds == 0.0 { 1.0 } else { seconds.sqrt().recip() };
            let draws = self.deviates(Purpose::Disturbance, plant.g.columns());
            plant.g.apply(&draws.iter().map(|x| size * x).collect::<Vec<_>>())
        };
        let sampled_at = |latency: &Latency| (latency.part() > 0.0).then(|| 1.0 - latency.part());
        let mut phases: Vec<f64> = input_latency.iter().map(|latency| latency.part()).collect();
        phases.extend(output_latency.iter().filter_map(sampled_at));
        phases.extend([0.0, 1.0]);
        let phases = merged(phases);
        let start = self.x.clone();
        for (k, &phase) in phases.iter().enumerate() {
            for (j, latency) in output_latency.iter().enumerate() {
                if sampled_at(latency).is_some_and(|at| same(at, phase)) {
                    self.measure(j, noise[j]);
                }
            }
            for (i, latency) in input_latency.iter().enumerate() {
                if same(latency.part(), phase) {
                    self.acting[i] = match (lost, missing) {
                        (false, _) => self.commands[latency.whole() as usize][i],
                        (true, MissingCommand::Hold) => self.acting[i],
                        (true, MissingCommand::Zero) => 0.0,
                    };
                }
            }
            let Some(&next) = phases.get(k + 1) else { break };
            let counted: Vec<f64> = start.iter().chain(&self.acting).copied().collect();
            self.cost += (next - phase) * form(linear.cost_form(), &counted);
            match plant.sampling_period {
                Some(_) => {
                    let moved: Vec<f64> = add(plant.a.apply(&self.x), plant.b.apply(&self.acting));
                    self.x = add(moved, held.clone());
                }
                None => {
                    let push: Vec<f64> = add(plant.b.apply(&self.acting), held.clone());
                    self.move_plant(&push, (next - phase) * seconds);
                }
            }
        }
        self.counted += 1;
        self.step += 1;
        self.passed = seconds;
    }
}

fn form(form: &Matrix, x: &[f64]) -> f64 {
    form.apply(x).iter().zip(x).map(|(a, b)| a * b).sum()
}

/// Four sums beside each other, which do not wait for each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (fours, others) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, b) in fours.0.iter().zip(others.0) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    // Plain loops: iterators that add up remain calls in tests, and take longer than the sum of a few numbers.
    let mut rest = 0.0;
    for (a, b) in fours.1.iter().zip(others.1) {
        rest += a * b;
    }
    sums[0] + sums[1] + sums[2] + sums[3] + rest
}

#[cfg(test)]
mod tests;
