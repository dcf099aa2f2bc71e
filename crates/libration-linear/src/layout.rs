//! The state of a loop: plant, controller, and commands and measurements in transit.

use libration_core::control::Latency;

/// The coordinates of a loop at the beginning of a period, and those that a period uses besides.
///
/// In order: the states of the plant, the memory of the controller, for each input its commands in transit (latest first), for each
/// output its measurements in transit (latest first), the commands that act across the beginning of a period; then those that act
/// only within one, for each input the command that arrives, and the noise of a step.
#[derive(Clone, Debug)]
pub struct Layout {
    states: usize,
    memory: usize,
    inputs: Vec<Input>,
    outputs: Vec<Output>,
    size: usize,
    working: usize,
    noise: usize,
    ends_with_control: bool,
}

#[derive(Clone, Copy, Debug)]
struct Input {
    /// The first command in transit.
    first: usize,
    commands: usize,
    acting: usize,
    arriving: usize,
}

#[derive(Clone, Copy, Debug)]
struct Output {
    /// The first measurement in transit.
    first: usize,
    measurements: usize,
}

/// The room that a channel needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transit {
    /// The numbers in transit.
    pub count: usize,
    /// Whether the command that acts at the end of a period still acts at the beginning of the next.
    pub acts_on: bool,
}

impl Transit {
    /// The commands of an input with this latency. With losses, the command that acts may act on.
    pub fn of_commands(latency: Latency, losses: bool) -> Self {
        Transit { count: latency.whole() as usize, acts_on: latency.part() > 0.0 || losses }
    }

    /// The measurements of an output with this latency. Those within a period are taken before its end.
    pub fn of_measurements(latency: Latency) -> Self {
        let count = latency.whole() as usize + usize::from(latency.part() > 0.0);
        Transit { count, acts_on: false }
    }
}

impl Layout {
    /// The layout of a loop; `noise` is the number of held noises of a step.
    pub fn new(
        [states, memory, noise]: [usize; 3],
        inputs: &[Transit],
        outputs: &[Transit],
    ) -> Self {
        let mut next = states + memory;
        let mut take = |count: usize| {
            next += count;
            next - count
        };
        let first: Vec<usize> = inputs.iter().map(|input| take(input.count)).collect();
        let outputs: Vec<Output> = outputs
            .iter()
            .map(|output| Output { first: take(output.count), measurements: output.count })
            .collect();
        let mut acting = vec![0; inputs.len()];
        let mut acts = |on: bool| {
            for (place, input) in acting.iter_mut().zip(inputs) {
                if input.acts_on == on {
                    *place = take(1);
                }
            }
        };
        acts(true);
        acts(false);
        let first_arriving = take(inputs.len());
        let first_noise = take(noise);
        let size = first_arriving - inputs.iter().filter(|input| !input.acts_on).count();
        let inputs = first
            .into_iter()
            .zip(inputs)
            .zip(acting.into_iter().zip(first_arriving..))
            .map(|((first, input), (acting, arriving))| Input {
                first,
                commands: input.count,
                acting,
                arriving,
            })
            .collect();
        let (working, noise) = (next, first_noise);
        Layout { states, memory, inputs, outputs, size, working, noise, ends_with_control: false }
    }

    /// The layout of periods at whose end the controller of the next one runs. Their state holds the commands that it has computed.
    pub(crate) fn ending_with_control(self) -> Self {
        Layout { size: self.noise, ends_with_control: true, ..self }
    }

    /// Whether the controller runs at the end of a period instead of its beginning.
    pub(crate) fn ends_with_control(&self) -> bool {
        self.ends_with_control
    }

    /// The number of coordinates at the beginning of a period.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The number of coordinates within a period.
    pub(crate) fn working(&self) -> usize {
        self.working
    }

    pub(crate) fn states(&self) -> usize {
        self.states
    }

    /// The coordinates of the noise of a step.
    pub(crate) fn noises(&self) -> core::ops::Range<usize> {
        self.noise..self.working
    }

    /// The coordinates of the memory.
    pub(crate) fn memory(&self) -> core::ops::Range<usize> {
        self.states..self.states + self.memory
    }

    /// The coordinate of the command that acts on input `i`.
    pub(crate) fn acting(&self, i: usize) -> usize {
        self.inputs[i].acting
    }

    /// The coordinate of the command that arrives within this period at input `i`.
    pub(crate) fn arriving(&self, i: usize) -> usize {
        self.inputs[i].arriving
    }

    /// The coordinates of the commands in transit to input `i`.
    pub(crate) fn commands(&self, i: usize) -> core::ops::Range<usize> {
        let Input { first, commands, .. } = self.inputs[i];
        first..first + commands
    }

    /// The coordinates of the measurements in transit from output `j`.
    pub(crate) fn measurements(&self, j: usize) -> core::ops::Range<usize> {
        let Output { first, measurements } = self.outputs[j];
        first..first + measurements
    }

    pub(crate) fn inputs(&self) -> usize {
        self.inputs.len()
    }

    pub(crate) fn outputs(&self) -> usize {
        self.outputs.len()
    }
}
