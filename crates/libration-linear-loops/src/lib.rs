//! Many loops around a linear plant, stepped together.
//!
//! A period is exact: its parts between events are matrix exponentials, white noise has its exact covariance in each part, and the cost
//! is integrated over continuous time. Sixteen neighbouring loops form a tile, whose numbers are rows.

mod blocks;
mod error;
mod kernel;
mod length_part;
mod length_polynomials;
mod map;
mod motion;
mod plan;
mod program_motion;
mod row;

use libration_linear::{LinearLoop, LoopTiming};

pub use error::LinearLoopsError;
use kernel::{Action, Commands, Common, Scratch, Tile};
use libration_batch::ensemble::{Execution, InsufficientMemory};
use plan::{Lengths, Parts, Plan};
pub use program_motion::ProgramMotion;
use program_motion::ProgramParts;
use row::{LANES, Row};

/// Many loops around a linear plant. Loop `n` has the same bits for any number of loops and threads and for each instruction set.
///
/// Loops rest at the beginning of a period, after the controller has run and the commands without latency have taken over.
#[derive(Debug)]
pub struct LinearLoops {
    plan: Plan,
    tiles: Vec<Row>,
    scratch: Vec<Scratch>,
    count: usize,
    seed: u64,
    step: u64,
    disturbance: Vec<f64>,
    reference: Vec<f64>,
    /// Whether the caller gives the commands.
    is_open: bool,
    execution: Execution,
}

impl LinearLoops {
    /// `count` loops with a timing. They start at rest with the seed 0; [`LinearLoops::reset`] changes both. The lengths of a `record`,
    /// relative to the period, replace the jitter: loop `n` begins with length `n` of it.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: an invalid timing, no loops, or not enough memory.
    pub fn new(
        linear: &LinearLoop,
        timing: &LoopTiming,
        record: Option<&[f64]>,
        count: usize,
        execution: Execution,
    ) -> Result<Self, LinearLoopsError> {
        let plan = Plan::new(linear, timing, record)?;
        if count == 0 {
            return Err(LinearLoopsError::NoLoops);
        }
        let rows = count.div_ceil(LANES) as u128 * plan.rows.count as u128;
        InsufficientMemory::check(rows * size_of::<Row>() as u128)?;
        let [_, m, p] = plan.sizes();
        let mut all = LinearLoops {
            tiles: vec![[0.0; LANES]; rows as usize],
            scratch: vec![Scratch::new(&plan); execution.thread_count()],
            count,
            seed: 0,
            step: 0,
            disturbance: vec![0.0; m],
            reference: vec![0.0; p],
            is_open: false,
            execution,
            plan,
        };
        all.reset(0, |_, _| 0.0);
        Ok(all)
    }

    /// The loops around a system by its program in place of the plant, which is its linearisation: states, inputs and measurements are
    /// deviations from the operating point. There is no noise of the plant. They begin anew.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: sizes that are not those of the plant, or steps that are too short.
    pub fn with_motion(
        mut self,
        linear: &LinearLoop,
        motion: ProgramMotion,
    ) -> Result<Self, LinearLoopsError> {
        self.plan.parts = Parts::ByProgram(ProgramParts::new(&self.plan, linear, motion)?);
        (self.plan.noises, self.plan.holds) = (0, false);
        self.reset(self.seed, |_, _| 0.0);
        Ok(self)
    }

    /// The loops without their controller: [`LinearLoops::advance_by`] gives the commands. They rest before commands are computed.
    #[must_use]
    pub fn without_controller(mut self) -> Self {
        self.is_open = true;
        self.reset(self.seed, |_, _| 0.0);
        self
    }

    /// Sets the threads and the instruction set. No bit of a loop depends on them.
    pub fn execute(&mut self, execution: Execution) {
        self.scratch = vec![Scratch::new(&self.plan); execution.thread_count()];
        self.execution = execution;
    }

    /// Begins anew: state `i` of loop `n` is `start(n, i)`. Memory, commands and measurements in transit are zero.
    pub fn reset(&mut self, seed: u64, start: impl Fn(usize, usize) -> f64) {
        (self.seed, self.step) = (seed, 0);
        let rows = &self.plan.rows;
        for (t, tile) in self.tiles.chunks_mut(rows.count).enumerate() {
            tile.fill([0.0; LANES]);
            let lanes = LANES.min(self.count - t * LANES);
            for (i, row) in tile[rows.states.clone()].iter_mut().enumerate() {
                for (l, x) in row[..lanes].iter_mut().enumerate() {
                    *x = start(t * LANES + l, i);
                }
            }
            for (row, disturbance) in tile[rows.inputs.clone()].iter_mut().zip(&self.disturbance) {
                *row = [*disturbance; LANES];
            }
        }
        self.pass(Action::Begin, None);
    }

    /// Adds constants to the commands at the inputs of the plant from now on.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: a wrong number of values, or one that is not finite.
    pub fn set_disturbance(&mut self, disturbance: &[f64]) -> Result<(), LinearLoopsError> {
        check("disturbances", disturbance, self.disturbance.len(), "one for each input")?;
        let rows = &self.plan.rows;
        for tile in self.tiles.chunks_mut(rows.count) {
            let inputs = tile[rows.inputs.clone()].iter_mut();
            for ((row, new), old) in inputs.zip(disturbance).zip(&self.disturbance) {
                row.iter_mut().for_each(|x| *x += new - old);
            }
        }
        self.disturbance.copy_from_slice(disturbance);
        Ok(())
    }

    /// Subtracts constants from the measurements that the controller reads, from the next period on.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: a wrong number of values, or one that is not finite.
    pub fn set_reference(&mut self, reference: &[f64]) -> Result<(), LinearLoopsError> {
        check("references", reference, self.reference.len(), "one for each output")?;
        self.reference.copy_from_slice(reference);
        Ok(())
    }

    /// Goes on by so many periods. Loops without a controller keep zero commands.
    pub fn advance(&mut self, periods: u64) {
        match self.is_open {
            false => self.pass(Action::Advance(periods), None),
            true => {
                let zeros = vec![0.0; self.count * self.plan.rows.inputs.len()];
                self.pass(Action::Advance(periods), Some(&zeros));
            }
        }
    }

    /// Goes on by a period with these commands, loops × inputs, for loops without a controller.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: a wrong number of commands, or one that is not finite.
    pub fn advance_by(&mut self, commands: &[f64]) -> Result<(), LinearLoopsError> {
        let count = self.count * self.plan.rows.inputs.len();
        check("commands", commands, count, "one for each loop and input")?;
        self.pass(Action::Advance(1), Some(commands));
        Ok(())
    }

    fn pass(&mut self, action: Action, commands: Option<&[f64]>) {
        let LinearLoops { plan, tiles, scratch, seed, disturbance, reference, execution, .. } =
            self;
        let commands = match (commands, self.is_open) {
            (Some(commands), _) => Commands::Given(commands),
            // The first period begins without commands.
            (None, true) => Commands::Given(&[]),
            (None, false) => Commands::Controller,
        };
        let plan = &*plan;
        let common = Common { plan, seed: *seed, disturbance, reference, commands };
        let periods = if let Action::Advance(periods) = action { periods } else { 1 };
        let work = (self.count as u64).saturating_mul(plan.work()).saturating_mul(periods);
        let count = tiles.len() / plan.rows.count;
        let each = count.div_ceil(execution.threads_for(work));
        let parts: Vec<_> = tiles.chunks_mut(each * plan.rows.count).zip(scratch).collect();
        let parts = parts.into_iter().enumerate().collect();
        let (step, loops, set) = (self.step, self.count, execution.instruction_set());
        execution.each(parts, |(part, (tiles, scratch))| {
            for (k, rows) in tiles.chunks_mut(plan.rows.count).enumerate() {
                let first = (part * each + k) * LANES;
                let lanes = LANES.min(loops - first);
                set.vectorize(Tile { common, rows, scratch, first, lanes, step, action });
            }
        });
        if let Action::Advance(periods) = action {
            self.step += periods;
        }
    }

    /// The number of loops.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The numbers of states, inputs and outputs.
    pub fn sizes(&self) -> [usize; 3] {
        self.plan.sizes()
    }

    /// The number of periods since the start.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Number `row` of loop `n`.
    fn at(&self, n: usize, row: usize) -> f64 {
        self.tiles[n / LANES * self.plan.rows.count + row][n % LANES]
    }

    /// State `i` of loop `n`.
    pub fn state(&self, n: usize, i: usize) -> f64 {
        self.at(n, self.plan.rows.states.start + i)
    }

    /// The command at input `i` of the plant of loop `n`, with its disturbance.
    pub fn input(&self, n: usize, i: usize) -> f64 {
        self.at(n, self.plan.rows.inputs.start + i)
    }

    /// The measurement of output `j` that the controller of loop `n` reads in this period.
    pub fn measurement(&self, n: usize, j: usize) -> f64 {
        self.at(n, self.plan.rows.seen.start + j)
    }

    /// Whether all states and the cost of loop `n` are finite.
    pub fn is_finite(&self, n: usize) -> bool {
        let rows = &self.plan.rows;
        let mut counted = rows.states.clone().chain([rows.cost]);
        counted.all(|row| self.at(n, row).is_finite())
    }

    /// The cost of loop `n` since the start: its rate in seconds; of a sampled plant, and with held noise, its sum over periods.
    pub fn cost(&self, n: usize) -> f64 {
        self.at(n, self.plan.rows.cost)
    }

    /// The time of loop `n` in s.
    pub fn time(&self, n: usize) -> f64 {
        match self.plan.lengths {
            Lengths::Even => self.step as f64 * self.plan.seconds,
            Lengths::Drawn(_) | Lengths::Recorded(_) => self.at(n, self.plan.rows.time),
        }
    }
}

fn check(
    of: &'static str,
    values: &[f64],
    count: usize,
    expected: &str,
) -> Result<(), LinearLoopsError> {
    if values.len() != count {
        let expected = format!("{count}, {expected}");
        return Err(LinearLoopsError::Length { of, given: values.len(), expected });
    }
    match values.iter().find(|x| !x.is_finite()) {
        Some(&value) => Err(LinearLoopsError::Entry { of, value }),
        None => Ok(()),
    }
}
