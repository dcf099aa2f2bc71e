//! The periods of a tile of loops.

use libration_core::random::{Address, Purpose, gaussian_lanes};
use libration_linear::MissingCommand;

use super::length_part::LengthPart;
use super::map::Map;
use super::plan::{Parts, Plan};
use super::row::{LANES, Row};
use libration_batch::ensemble::Loop;

/// Where commands come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Commands<'a> {
    /// The controller of the loop.
    Controller,
    /// The caller: loops × inputs.
    Given(&'a [f64]),
}

/// What the loops of a pass have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Common<'a> {
    pub(super) plan: &'a Plan,
    pub(super) seed: u64,
    /// What is added to the commands at the inputs of the plant.
    pub(super) disturbance: &'a [f64],
    /// What the controller subtracts from its measurements.
    pub(super) reference: &'a [f64],
    pub(super) commands: Commands<'a>,
}

/// Memory for numbers within a period.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    pub(super) next: Vec<Row>,
    /// The states at the beginning of the period.
    pub(super) start: Vec<Row>,
    pub(super) normals: Vec<Row>,
    /// Chebyshev's polynomials of the lengths of the period.
    pub(super) basis: Vec<Row>,
    /// The factors of a part.
    pub(super) factors: Vec<Row>,
}

impl Scratch {
    pub(super) fn new(plan: &Plan) -> Self {
        let [n, m, p] = plan.sizes();
        let rows = |count| vec![[0.0; LANES]; count];
        let largest = |of: fn(&LengthPart) -> usize| match &plan.parts {
            Parts::Even(_) | Parts::ByProgram(_) => 0,
            Parts::Uneven { parts, .. } => parts.iter().map(of).max().unwrap_or(0),
        };
        let normals = (plan.noises + 1).max(p + 1);
        Scratch {
            next: rows(n.max(m + plan.rows.memory.len())),
            start: rows(n),
            normals: rows(normals),
            basis: rows(largest(LengthPart::order)),
            factors: rows(largest(LengthPart::len)),
        }
    }
}

/// What a pass does with a tile.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    /// Begins the first period.
    Begin,
    /// Goes from one period to a later one.
    Advance(u64),
}

/// Neighbouring loops from `first` on, of which `lanes` are in use.
pub(super) struct Tile<'a> {
    pub(super) common: Common<'a>,
    pub(super) rows: &'a mut [Row],
    pub(super) scratch: &'a mut Scratch,
    pub(super) first: usize,
    pub(super) lanes: usize,
    pub(super) step: u64,
    pub(super) action: Action,
}

impl Loop for Tile<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let closed = matches!(self.common.commands, Commands::Controller);
        match self.action {
            Action::Begin => {
                self.measure();
                if closed {
                    self.control();
                }
            }
            Action::Advance(periods) => {
                for _ in 0..periods {
                    if !closed {
                        self.control();
                    }
                    self.move_on();
                    self.step += 1;
                    self.measure();
                    if closed {
                        self.control();
                    }
                }
            }
        }
    }
}

impl Tile<'_> {
    #[inline(always)]
    pub(super) fn address(&self, purpose: Purpose, lane: usize, step: u64) -> Address {
        let trajectory = (self.first + lane) as u64;
        Address { seed: self.common.seed, trajectory, step, purpose }
    }

    /// Draws `count` normal numbers of each loop.
    #[inline(always)]
    pub(super) fn draw(&mut self, purpose: Purpose, count: usize) {
        let pairs = count.div_ceil(2);
        for pair in 0..pairs {
            let step = self.step * pairs as u64 + pair as u64;
            let [a, b] = gaussian_lanes::<LANES>(self.address(purpose, 0, step));
            (self.scratch.normals[2 * pair], self.scratch.normals[2 * pair + 1]) = (a, b);
        }
    }

    /// The output `j` with its noise.
    #[inline(always)]
    fn output(&self, j: usize) -> Row {
        let rows = &self.common.plan.rows;
        let mut value = self.common.plan.outputs.row(j, self.rows);
        let noise = &self.rows[rows.noise.start + j];
        for l in 0..LANES {
            value[l] += noise[l];
        }
        value
    }

    /// The measurements at the beginning of a period, and those that arrive then.
    #[inline(always)]
    fn measure(&mut self) {
        let plan = self.common.plan;
        let rows = &plan.rows;
        let noisy = plan.deviations.iter().any(|deviation| *deviation > 0.0);
        if noisy {
            self.draw(Purpose::Observation, plan.deviations.len());
            for (j, deviation) in plan.deviations.iter().enumerate() {
                let normal = self.scratch.normals[j];
                let noise = &mut self.rows[rows.noise.start + j];
                for l in 0..LANES {
                    noise[l] = deviation * normal[l];
                }
            }
        }
        for (j, queue) in rows.measurements.iter().enumerate() {
            let seen = match queue.within {
                // The latest is of the period before.
                true => queue.latest(self.step),
                false => {
                    self.rows[queue.latest(self.step)] = self.output(j);
                    queue.earliest(self.step)
                }
            };
            self.rows[rows.seen.start + j] = self.rows[seen];
        }
    }

    /// New commands, and those that take over at the beginning of the period.
    #[inline(always)]
    fn control(&mut self) {
        let plan = self.common.plan;
        let rows = &plan.rows;
        match self.common.commands {
            Commands::Controller => {
                for (j, reference) in self.common.reference.iter().enumerate() {
                    for x in &mut self.rows[rows.seen.start + j] {
                        *x -= reference;
                    }
                }
                let known = &self.rows[rows.memory.start..rows.seen.end];
                let (m, memory) = (rows.inputs.len(), rows.memory.len());
                let next = &mut self.scratch.next[..m + memory];
                let period = (self.step % plan.controllers.len() as u64) as usize;
                apply(&plan.controllers[period], known, next);
                self.rows[rows.memory.clone()].copy_from_slice(&next[m..]);
                for (queue, command) in rows.commands.iter().zip(&next[..m]) {
                    self.rows[queue.latest(self.step)] = *command;
                }
                for (j, reference) in self.common.reference.iter().enumerate() {
                    for x in &mut self.rows[rows.seen.start + j] {
                        *x += reference;
                    }
                }
            }
            Commands::Given(commands) => {
                let m = rows.inputs.len();
                for (i, queue) in rows.commands.iter().enumerate() {
                    let row = &mut self.rows[queue.latest(self.step)];
                    for l in 0..self.lanes {
                        row[l] = commands[(self.first + l) * m + i];
                    }
                }
            }
        }
        self.pass_events(0);
    }

    /// The outputs that are measured and the commands that take over at a phase.
    #[inline(always)]
    pub(super) fn pass_events(&mut self, phase: usize) {
        let plan = self.common.plan;
        let rows = &plan.rows;
        let events = &plan.events[phase];
        for &j in &events.measured {
            self.rows[rows.measurements[j].latest(self.step)] = self.output(j);
        }
        if events.arriving.is_empty() {
            return;
        }
        let mut lost = [false; LANES];
        if plan.loss > 0.0 {
            for (l, lost) in lost.iter_mut().enumerate().take(self.lanes) {
                *lost = self.address(Purpose::Latency, l, self.step).uniform()[0] < plan.loss;
            }
        }
        for &i in &events.arriving {
            let disturbance = self.common.disturbance[i];
            let command = self.rows[rows.commands[i].earliest(self.step)];
            let input = &mut self.rows[rows.inputs.start + i];
            for l in 0..LANES {
                let missing = match plan.missing {
                    MissingCommand::Hold => input[l],
                    MissingCommand::Zero => disturbance,
                };
                input[l] = if lost[l] { missing } else { command[l] + disturbance };
            }
        }
    }
}

/// All rows of a map.
#[inline(always)]
fn apply(map: &Map, z: &[Row], result: &mut [Row]) {
    for (i, row) in result.iter_mut().enumerate() {
        *row = map.row(i, z);
    }
}
