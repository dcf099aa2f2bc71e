//! A plant with its commands and measurements under way.

use crate::deviations::Deviations;
use crate::{
    DiscreteController, Layout, LinearLoop, LinearLoopError, LoopTiming, Matrix, RegulatorProblem,
    Stage,
};

/// A plant whose state `z` includes the commands and measurements under way, at the beginning of a period.
///
/// `z' = Az + Bu + w`, and the controller receives `y = Cz + v` before it makes the command `u`. `A`, `B` and the covariance of `w`
/// are drawn in each period. A measurement within a period is part of `z'`, so that its noise and that of the plant are both in `w`,
/// with their covariance; `v` is the noise of the measurements without latency.
pub(crate) struct AugmentedPlant {
    /// The mean `A`, states × states.
    pub(crate) a: Matrix,
    /// The mean `B`, states × commands.
    pub(crate) b: Matrix,
    /// `C`, measurements × states.
    pub(crate) c: Matrix,
    /// The deviations of `[A, B]`.
    pub(crate) off: Deviations,
    /// Whether the periods differ.
    pub(crate) is_random: bool,
    /// The mean covariance of `w`.
    pub(crate) process_noise: Matrix,
    /// The covariance of `v`.
    pub(crate) measurement_noise: Matrix,
    /// The mean cost of a period as a form of states and commands.
    pub(crate) cost: Matrix,
    /// Its part that neither depends on.
    pub(crate) constant: f64,
    /// The mean length by which the cost of a period is divided.
    pub(crate) length: f64,
    /// The states of the plant, the first of `z`.
    pub(crate) plant_states: usize,
    /// The states that the controller cannot know: with losses, the commands that act at the beginning of a period.
    pub(crate) unknown: Vec<usize>,
}

impl AugmentedPlant {
    /// The plant of a loop with its timing, under measurement noise of these variances.
    ///
    /// The controller in its place makes commands from its first memory and keeps the measurements in the rest: the rows and columns of
    /// this memory in the matrix of a period are `C` and `B`.
    pub(crate) fn new(
        linear: &LinearLoop,
        timing: &LoopTiming,
        output_noise: &[f64],
    ) -> Result<Self, LinearLoopError> {
        let plant = linear.plant();
        let (n, m, p) = (plant.states.len(), plant.inputs.len(), plant.outputs.len());
        let mut keep = Matrix::zeros(m + p, p);
        keep.set_block((m, 0), &Matrix::identity(p));
        let mut make = Matrix::zeros(m, m + p);
        make.set_block((0, 0), &Matrix::identity(m));
        let controller = DiscreteController {
            a: Matrix::zeros(m + p, m + p),
            b: keep,
            c: make,
            d: Matrix::zeros(m, p),
        };
        let cost = linear.cost_form().clone();
        let noise = output_noise.to_vec();
        let open = LinearLoop::new(plant.clone(), controller, linear.period(), cost, noise)?;
        let layout = open.layout(timing)?;
        let places = Places::new(&layout, m);
        let stages = open.stages(timing, true)?;
        let mut augmented = places.gathered(&stages[0], n);
        if timing.loss > 0.0 {
            let place = |i: usize| places.states.iter().position(|&at| at == layout.acting(i));
            augmented.unknown = (0..m).filter_map(place).collect();
        }
        Ok(augmented)
    }

    /// The regulator problem of the mean plant, with a cost that is higher by the form `more` of states and commands.
    pub(crate) fn regulator_problem(&self, more: Option<&Matrix>) -> RegulatorProblem {
        let (size, m) = (self.b.rows(), self.b.columns());
        let cost = more.map_or_else(|| self.cost.clone(), |more| self.cost.plus(more));
        RegulatorProblem {
            a: self.a.clone(),
            b: self.b.clone(),
            q: cost.block((0, 0), (size, size)),
            s: cost.block((0, size), (size, m)),
            r: cost.block((size, size), (m, m)),
        }
    }

    /// The filter problem of the mean plant, the dual of a regulator problem, with process noise that is higher by `more`. Its cost is
    /// the covariance of the predicted state.
    pub(crate) fn filter_problem(&self, more: Option<&Matrix>) -> RegulatorProblem {
        let noise = &self.process_noise;
        RegulatorProblem {
            a: self.a.transposed(),
            b: self.c.transposed(),
            q: more.map_or_else(|| noise.clone(), |more| noise.plus(more)),
            s: Matrix::zeros(self.a.rows(), self.c.rows()),
            r: self.measurement_noise.clone(),
        }
    }
}

/// The coordinates of an open loop.
struct Places {
    /// The states `z`.
    states: Vec<usize>,
    /// The commands that the controller makes.
    commands: Vec<usize>,
    /// The measurements that it keeps.
    measurements: Vec<usize>,
}

impl Places {
    fn new(layout: &Layout, inputs: usize) -> Self {
        let memory = layout.memory();
        Places {
            states: (0..memory.start).chain(memory.end..layout.size()).collect(),
            commands: (memory.start..memory.start + inputs).collect(),
            measurements: (memory.start + inputs..memory.end).collect(),
        }
    }

    fn gathered(&self, stages: &[Stage], plant_states: usize) -> AugmentedPlant {
        let Places { states, commands, measurements } = self;
        let block = |matrix: &Matrix, rows: &[usize], columns: &[usize]| {
            Matrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], columns[j])])
        };
        let driving: Vec<usize> = states.iter().chain(commands).copied().collect();
        let mean = |of: &dyn Fn(&Stage) -> Matrix| {
            let mut parts = stages.iter().map(|stage| of(stage).scaled(stage.weight));
            let first = parts.next().unwrap_or_else(|| Matrix::zeros(0, 0));
            parts.fold(first, |sum, part| sum.plus(&part))
        };
        let step = mean(&|stage| block(&stage.step, states, &driving));
        let off = |stage: &Stage| {
            let mut off = block(&stage.step, states, &driving);
            off.add_scaled(-1.0, &step);
            (stage.weight, off)
        };
        let is_random = stages.len() > 1;
        let deviations: Vec<(f64, Matrix)> = match is_random {
            true => stages.iter().map(off).collect(),
            false => Vec::new(),
        };
        let (size, m) = (states.len(), commands.len());
        let total = |of: &dyn Fn(&Stage) -> f64| -> f64 {
            stages.iter().map(|stage| stage.weight * of(stage)).sum()
        };
        AugmentedPlant {
            a: step.block((0, 0), (size, size)),
            b: step.block((0, size), (size, m)),
            c: mean(&|stage| block(&stage.step, measurements, states)),
            off: Deviations::new(&deviations),
            is_random,
            process_noise: mean(&|stage| block(&stage.noise, states, states)),
            measurement_noise: mean(&|stage| block(&stage.noise, measurements, measurements)),
            cost: mean(&|stage| block(&stage.cost, &driving, &driving)),
            constant: total(&|stage| stage.constant),
            length: total(&|stage| stage.length),
            plant_states,
            unknown: Vec::new(),
        }
    }
}
