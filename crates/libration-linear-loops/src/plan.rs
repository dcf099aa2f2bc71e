//! A loop with a timing, prepared for its simulation.

use core::ops::Range;

use libration_core::control::{Jitter, Latency};
use libration_linear::{
    DiscreteController, LinearLoop, LinearLoopError, LoopTiming, Matrix, MissingCommand,
    PartMotion, PeriodEvents, cholesky,
};

use super::LinearLoopsError;
use super::blocks::{above, beside, folded};
use super::length_part::LengthPart;
use super::map::Map;
use super::program_motion::ProgramParts;

/// A loop with a timing, as maps on the rows of a tile.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// The length of a period in s, with its skew.
    pub(super) seconds: f64,
    pub(super) lengths: Lengths,
    pub(super) loss: f64,
    pub(super) missing: MissingCommand,
    /// Outputs of states and inputs.
    pub(super) outputs: Map,
    /// Commands and the next memory, of memory and measurements.
    /// Of each period of the schedule.
    pub(super) controllers: Vec<Map>,
    /// The standard deviations of the noise of the outputs.
    pub(super) deviations: Vec<f64>,
    pub(super) events: Vec<PeriodEvents>,
    pub(super) parts: Parts,
    /// Whether noise is held through a period, and the cost is that of the states at its beginning.
    pub(super) holds: bool,
    /// Whether held noise is white, with a variance of `1/h` in a period of `h` seconds.
    pub(super) is_white: bool,
    /// Normal numbers of a period.
    pub(super) noises: usize,
    pub(super) rows: Rows,
}

/// The lengths of periods, relative to their mean.
#[derive(Clone, Debug)]
pub(super) enum Lengths {
    Even,
    Drawn(Jitter),
    /// Of loop `n` from the `n`-th on, over and over.
    Recorded(Vec<f64>),
}

/// The parts of a period.
#[derive(Clone, Debug)]
pub(super) enum Parts {
    /// Of periods of equal lengths.
    Even(Vec<Part>),
    /// Of periods of any length in a range.
    Uneven { parts: Vec<LengthPart>, middle: f64, half: f64 },
    /// Of periods of any length, in steps of a program.
    ByProgram(ProgramParts),
}

/// A part of a period.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// The next states, of states and inputs.
    pub(super) step: Map,
    /// What noise adds to them, of normal numbers.
    pub(super) noise: Map,
    /// The number of its normal numbers, unless noise is held.
    pub(super) white: usize,
    /// The columns of the states of the upper half of a form of states and inputs.
    pub(super) state_cost: Map,
    /// The columns of the inputs.
    pub(super) input_cost: Map,
    pub(super) constant: f64,
}

/// The places of rows in a tile.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    pub(super) states: Range<usize>,
    /// Behind the states: one map reads both.
    pub(super) inputs: Range<usize>,
    pub(super) memory: Range<usize>,
    /// Behind the memory.
    pub(super) seen: Range<usize>,
    /// The noise of the measurements of this period.
    pub(super) noise: Range<usize>,
    pub(super) commands: Vec<Queue>,
    pub(super) measurements: Vec<Queue>,
    pub(super) cost: usize,
    pub(super) time: usize,
    pub(super) count: usize,
}

/// The rows of what a channel has in transit, overwritten in turn: a row per period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Queue {
    first: usize,
    len: usize,
    /// Whether an output is measured within a period.
    pub(super) within: bool,
}

impl Queue {
    /// The row of period `step`.
    #[inline(always)]
    pub(super) fn latest(&self, step: u64) -> usize {
        match self.len {
            1 => self.first,
            len => self.first + (step % len as u64) as usize,
        }
    }

    /// The row of the earliest period that is kept, seen from period `step`.
    #[inline(always)]
    pub(super) fn earliest(&self, step: u64) -> usize {
        self.latest(step + 1)
    }
}

impl Plan {
    /// Prepares a loop.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: an invalid timing, or a plant that moves too fast.
    pub(super) fn new(
        linear: &LinearLoop,
        timing: &LoopTiming,
        record: Option<&[f64]>,
    ) -> Result<Self, LinearLoopsError> {
        if linear.measures_time() && (timing.jitter.rms() > 0.0 || record.is_some()) {
            return Err(LinearLoopsError::MeasuredClock);
        }
        let events = linear.period_events(timing)?;
        let seconds = linear.period() * (1.0 + timing.skew);
        let holds = linear.holds_noise_and_cost();
        let lengths = match record {
            Some(record) => Lengths::Recorded(checked(record)?.to_vec()),
            None if timing.jitter.rms() > 0.0 => Lengths::Drawn(timing.jitter),
            None => Lengths::Even,
        };
        let phases = events.windows(2).map(|ends| [ends[0].phase, ends[1].phase]);
        let held = if holds { linear.plant().g.columns() } else { 0 };
        let (parts, noises) = match lengths.range() {
            None => {
                let of = |phases| Part::new(linear, &linear.part_motion(seconds, phases));
                let parts: Vec<Part> = phases.map(of).collect();
                let noises: usize = parts.iter().map(|part| part.white).sum();
                (Parts::Even(parts), noises)
            }
            Some(range) => {
                let [low, high] = range.map(|relative| relative * seconds);
                let parts = phases.map(|phases| LengthPart::new(linear, phases, [low, high]));
                let parts = parts.collect::<Result<Vec<_>, _>>()?;
                let noises: usize = parts.iter().map(LengthPart::normals).sum();
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                // A record of equal lengths has one.
                let half = half.max(f64::MIN_POSITIVE);
                (Parts::Uneven { parts, middle, half }, noises)
            }
        };
        let plant = linear.plant();
        let schedule = linear.controllers();
        let controllers = (0..schedule.periods()).map(|k| {
            let DiscreteController { a, b, c, d } = schedule.at(k);
            Map::new(&above(&beside(c, d), &beside(a, b)))
        });
        Ok(Plan {
            seconds,
            lengths,
            loss: timing.loss,
            missing: timing.missing,
            outputs: Map::new(&beside(&plant.c, &plant.d)),
            controllers: controllers.collect(),
            deviations: linear.output_noise().iter().map(|variance| variance.sqrt()).collect(),
            events,
            parts,
            holds,
            is_white: plant.sampling_period.is_none(),
            noises: held + noises,
            rows: Rows::new(linear, timing),
        })
    }

    /// The numbers of states, inputs and outputs.
    pub(super) fn sizes(&self) -> [usize; 3] {
        [self.rows.states.len(), self.rows.inputs.len(), self.rows.seen.len()]
    }

    /// The length of the longest period in s.
    pub(super) fn longest_period(&self) -> f64 {
        self.seconds * self.lengths.range().map_or(1.0, |[_, longest]| longest)
    }

    /// The work of a period of a loop, in multiples of the shortest step of an integrator.
    pub(super) fn work(&self) -> u64 {
        // A draw costs as much as a hundred operations.
        let draws = self.noises + self.rows.seen.len();
        let operations =
            self.outputs.len() + self.controllers.iter().map(Map::len).max().unwrap_or(0);
        let parts: usize = match &self.parts {
            Parts::Even(parts) => parts.iter().map(Part::work).sum(),
            Parts::Uneven { parts, .. } => parts.iter().map(LengthPart::work).sum(),
            Parts::ByProgram(parts) => parts.work(),
        };
        (operations + parts + 50 * draws).div_ceil(4) as u64
    }
}

impl Lengths {
    /// The shortest and the longest; none if all are equal.
    fn range(&self) -> Option<[f64; 2]> {
        match self {
            Lengths::Even => None,
            Lengths::Drawn(jitter) => {
                let reach = match jitter {
                    // The largest normal number of `Address::gaussian` is √(106 ln 2) = 8.572.
                    Jitter::Gaussian(rms) => 8.58 * rms,
                    Jitter::Uniform(_) => jitter.largest(),
                };
                Some([(1.0 - reach).max(0.0), 1.0 + reach])
            }
            Lengths::Recorded(record) => {
                let shortest = record.iter().copied().fold(f64::INFINITY, f64::min);
                Some([shortest, record.iter().copied().fold(0.0, f64::max)])
            }
        }
    }
}

impl Part {
    fn new(linear: &LinearLoop, motion: &PartMotion) -> Self {
        let m = linear.plant().inputs.len();
        let PartMotion { step, covariance, cost, constant } = motion;
        let n = step.phi.rows();
        let noise = match covariance {
            Some(covariance) => {
                let factor = cholesky(covariance);
                let drawn: Vec<usize> = (0..n).filter(|&j| factor[(j, j)] > 0.0).collect();
                Matrix::from_fn(n, drawn.len(), |i, k| factor[(i, drawn[k])])
            }
            None => step.gamma.block((0, m), (n, step.gamma.columns() - m)),
        };
        let form = folded(cost);
        Part {
            step: Map::new(&beside(&step.phi, &step.gamma.block((0, 0), (n, m)))),
            white: if covariance.is_some() { noise.columns() } else { 0 },
            noise: Map::new(&noise),
            state_cost: Map::new(&form.block((0, 0), (n + m, n))),
            input_cost: Map::new(&form.block((0, n), (n + m, m))),
            constant: *constant,
        }
    }
}

impl Part {
    fn work(&self) -> usize {
        let [a, b] = [&self.state_cost, &self.input_cost].map(Map::len);
        self.step.len() + self.noise.len() + a + b
    }
}

impl Rows {
    fn new(linear: &LinearLoop, timing: &LoopTiming) -> Self {
        let (plant, controller) = (linear.plant(), linear.controller());
        let mut next = 0;
        let mut take = |count: usize| {
            next += count;
            next - count..next
        };
        let states = take(plant.states.len());
        let inputs = take(plant.inputs.len());
        let memory = take(controller.memory());
        let seen = take(plant.outputs.len());
        let noise = take(plant.outputs.len());
        let mut queue = |latency: &Latency, within: bool| {
            let rows = take(latency.whole() as usize + 1);
            Queue { first: rows.start, len: rows.len(), within }
        };
        let commands = timing.input_latency.iter().map(|late| queue(late, false)).collect();
        let within = |late: &Latency| late.part() > 0.0;
        let measurements =
            timing.output_latency.iter().map(|late| queue(late, within(late))).collect();
        let (cost, time) = (take(1).start, take(1).start);
        let count = time + 1;
        Rows { states, inputs, memory, seen, noise, commands, measurements, cost, time, count }
    }
}

/// A record of lengths that are all possible.
fn checked(record: &[f64]) -> Result<&[f64], LinearLoopError> {
    let wrong = |x: &&f64| !(x.is_finite() && **x >= 0.0);
    match record.iter().find(wrong) {
        Some(&length) => Err(LinearLoopError::Record(length)),
        None if record.iter().any(|length| *length > 0.0) => Ok(record),
        None => Err(LinearLoopError::Record(0.0)),
    }
}
