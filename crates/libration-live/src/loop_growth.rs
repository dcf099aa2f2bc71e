//! The growth of deviations of loops, measured.

use libration_equations::StepProgram;

use crate::control_loop::{ControlLoop, LoopState};
use crate::growth::Growth;
use crate::motion::WORK;
use crate::subject::Stepper;

/// Groups of loops, each with a mean square of its own, where periods or losses are random.
const GROUPS: u64 = 8;

/// Loops in a group.
const LOOPS: u64 = 16;

impl ControlLoop<'_> {
    /// The rate in 1/s at which the root of the mean square of small deviations grows, measured, and the standard error of this number.
    pub(crate) fn measured_growth(&self, step: &StepProgram, least: usize) -> Option<[f64; 2]> {
        if self.control.jitter == 0.0 && self.control.loss == 0.0 {
            return Some([self.growth_of_loops(step, 0..1, least)?, 0.0]);
        }
        let group = |k| self.growth_of_loops(step, k * LOOPS..(k + 1) * LOOPS, 2);
        let rates: Vec<f64> = (0..GROUPS).map(group).collect::<Option<_>>()?;
        let count = GROUPS as f64;
        let mean = rates.iter().sum::<f64>() / count;
        let squares: f64 = rates.iter().map(|rate| (rate - mean).powi(2)).sum();
        Some([mean, (squares / (count * (count - 1.0))).sqrt()])
    }

    /// That of the loops with these numbers.
    fn growth_of_loops(
        &self,
        step: &StepProgram,
        numbers: core::ops::Range<u64>,
        least: usize,
    ) -> Option<f64> {
        let random = numbers.end - numbers.start > 1;
        let loops = if random { LOOPS * GROUPS } else { 1 };
        let periods = (WORK / loops as f64 / self.work(step)).clamp(40.0, 2000.0) as u64;
        let scale = self.subject.scale(&self.point);
        let mut growth = if random { Growth::of_one_range(scale) } else { Growth::new(scale) };
        let mut start = self.point.state.clone();
        self.subject.places.iter().for_each(|&place| start[place] += growth.small);
        let mut stepper = Stepper::<f64>::new(step, 2 * self.subject.degrees());
        let mut all: Vec<(u64, LoopState<f64>)> =
            numbers.map(|number| (number, self.begin(&start))).collect();
        for k in 0..periods {
            let mut sum = 0.0;
            for (number, own) in &mut all {
                self.advance(&mut stepper, own, self.period(*number, k), |_, _| {});
                let off = |&i: &usize| (own.state[i] - self.point.state[i]).powi(2);
                sum += self.subject.places.iter().map(off).sum::<f64>();
            }
            let Some(factor) = growth.push(sum / all.len() as f64) else { break };
            if factor != 1.0 {
                // Over long times the mean square of few loops is that of one of them.
                if random {
                    break;
                }
                all.iter_mut().for_each(|(_, own)| self.scale(own, factor));
            }
        }
        growth.rate(least).map(|rate| rate / self.mean_period())
    }

    /// Multiplies all deviations from the equilibrium and the commands that hold it.
    fn scale(&self, own: &mut LoopState<f64>, factor: f64) {
        let scale = |x: &mut f64, rest: f64| *x = rest + factor * (*x - rest);
        for &place in &self.subject.places {
            scale(&mut own.state[place], self.point.state[place]);
        }
        for command in own.commands.iter_mut().chain([&mut own.acting]) {
            command.iter_mut().zip(&self.point.inputs).for_each(|(u, rest)| scale(u, *rest));
        }
    }
}
