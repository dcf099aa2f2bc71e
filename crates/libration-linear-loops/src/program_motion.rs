//! The motion of loops around a system by its program.

use libration_equations::StepProgram;
use libration_linear::{LinearLoop, Matrix};

use super::LinearLoopsError;
use super::plan::Plan;
use super::row::Row;

/// The motion of a system of which the plant of a loop is the linearisation.
#[derive(Clone, Debug)]
pub struct ProgramMotion {
    /// A step of an integrator on the system.
    pub step: StepProgram,
    /// Positions, velocities and inputs at the operating point.
    pub operating_point: Vec<f64>,
    /// The place of each state of the plant among positions and velocities.
    pub places: Vec<usize>,
    /// The longest step in s.
    pub longest_step: f64,
}

/// The parts of periods in steps of a program.
#[derive(Clone, Debug)]
pub(super) struct ProgramParts {
    motion: ProgramMotion,
    /// The form of states and inputs whose integral is the cost.
    cost: Matrix,
    /// The beginning and the end of each part, and its steps, an even number.
    parts: Vec<([f64; 2], u32)>,
}

/// Most steps in a period.
const MOST_STEPS: f64 = 1e7;

impl ProgramParts {
    /// The parts of a plan.
    ///
    /// # Errors
    /// [`LinearLoopsError`]: sizes that are not those of the plant, or steps that are too short.
    pub(super) fn new(
        plan: &Plan,
        linear: &LinearLoop,
        motion: ProgramMotion,
    ) -> Result<Self, LinearLoopsError> {
        let [n, m, _] = plan.sizes();
        let states = motion.step.program().outputs().len();
        let length = |of, given, count: usize, expected: &str| match given == count {
            true => Ok(()),
            false => {
                let expected = format!("{count}, {expected}");
                Err(LinearLoopsError::Length { of, given, expected })
            }
        };
        length("places of states", motion.places.len(), n, "one for each state of the plant")?;
        let point = motion.operating_point.len();
        length(
            "numbers of the operating point",
            point,
            states + m,
            "the states and inputs of the system",
        )?;
        let longest = plan.longest_period() / motion.longest_step;
        if !(motion.longest_step > 0.0 && longest <= MOST_STEPS) {
            let period = plan.longest_period();
            return Err(LinearLoopsError::Steps { longest: motion.longest_step, period });
        }
        let parts = plan.events.windows(2).map(|ends| {
            let phases = [ends[0].phase, ends[1].phase];
            // Simpson's rule takes two at once.
            let pairs = (0.5 * longest * (phases[1] - phases[0])).ceil().max(1.0);
            (phases, 2 * pairs as u32)
        });
        Ok(ProgramParts { parts: parts.collect(), cost: linear.cost_form().clone(), motion })
    }

    /// The number of parts.
    pub(super) fn count(&self) -> usize {
        self.parts.len()
    }

    /// The operations of a period of a loop.
    pub(super) fn work(&self) -> usize {
        let steps: u32 = self.parts.iter().map(|(_, steps)| steps).sum();
        steps as usize * self.motion.step.program().operations()
    }

    /// Moves the first `lanes` loops, whose rows are states and inputs, through a part of periods of these lengths in s. The cost is
    /// integrated by Simpson's rule.
    #[inline(never)]
    pub(super) fn move_on(
        &self,
        part: usize,
        lengths: &Row,
        lanes: usize,
        rows: &mut [Row],
        cost: &mut Row,
    ) {
        let ProgramMotion { step, operating_point, places, .. } = &self.motion;
        let ([from, to], steps) = self.parts[part];
        let mut step = step.program().on::<f64>();
        let mut inputs = operating_point.clone();
        inputs.push(0.0);
        let states = operating_point.len() - (rows.len() - places.len());
        let mut next = Vec::with_capacity(states);
        let mut deviation = vec![0.0; rows.len()];
        for l in 0..lanes {
            deviation.iter_mut().zip(&*rows).for_each(|(x, row)| *x = row[l]);
            let commands = (states..operating_point.len()).zip(&deviation[places.len()..]);
            let all = places.iter().copied().zip(&deviation).chain(commands);
            all.for_each(|(place, x)| inputs[place] = operating_point[place] + x);
            let h = lengths[l] * (to - from) / f64::from(steps);
            inputs[operating_point.len()] = h;
            let mut sum = self.rate(&deviation);
            for k in 1..=steps {
                next.clear();
                next.extend(step.run(&inputs));
                inputs[..states].copy_from_slice(&next);
                for (x, &place) in deviation.iter_mut().zip(places) {
                    *x = inputs[place] - operating_point[place];
                }
                let weight = if k == steps {
                    1.0
                } else if k % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                sum += weight * self.rate(&deviation);
            }
            cost[l] += h / 3.0 * sum;
            for (row, x) in rows.iter_mut().zip(&deviation).take(places.len()) {
                row[l] = *x;
            }
        }
    }

    /// The rate of the cost.
    fn rate(&self, deviation: &[f64]) -> f64 {
        let row = |i: usize| {
            let products = deviation.iter().zip(self.cost.row(i)).map(|(x, weight)| x * weight);
            deviation[i] * products.sum::<f64>()
        };
        (0..deviation.len()).map(row).sum()
    }
}
